//! Approximate shadows, from shadow maps: memory and dispatches for `umbra4-maps`.

mod stochastic;

pub use stochastic::StochasticShadows;
