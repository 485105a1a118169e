//! Approximate soft shadows from shadow maps, see [`umbra4_maps`].

pub mod stochastic;
