//! Which way shadows are computed.

use crate::{microquad::MicroquadOptions, stochastic::StochasticOptions};

/// A way to compute the shadows of an area light, for the same occluders, lights and receivers.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Technique {
    /// By 4D rasterisation: every bit of the masks is the one true answer (`umbra4-core`).
    #[default]
    Exact,
    /// From one shadow map, drawn from the light's centre: [`crate::microquad`].
    Microquads(MicroquadOptions),
    /// From a shadow map whose texels look from random places of the light: [`crate::stochastic`]. It has no masks.
    Stochastic(StochasticOptions),
}
