//! Plots as SVG: lines over two logarithmic axes, on a light background, with text as text.

mod axis;
mod chart;
mod element;

pub use chart::{Chart, Line, Tick};
