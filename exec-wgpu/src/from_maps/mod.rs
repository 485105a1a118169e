//! Approximate shadows, from shadow maps: memory and passes for `umbra4-maps`. And the switch between them and the exact system.

mod microquads;
mod stochastic;
mod technique;

pub use microquads::ShadowMap;
pub use stochastic::StochasticShadows;
