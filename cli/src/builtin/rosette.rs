//! A texture of tints: a rose of petals around a bright eye, with lead between them.

use std::{f64::consts::TAU, sync::Arc};

use umbra4_core::{
    glam::{DVec2, Vec3},
    texture::{TextureSize, Wrap},
};

use super::stained_glass::{AMBER, COBALT, PALE, RUBY, TURQUOISE, VIOLET};
use crate::model::{Surface, Texture};

/// Texels each way.
const SIZE: u32 = 160;
const PETALS: f64 = 8.0;
/// Half the width of lead, where 1 is half the picture's.
const LEAD: f64 = 0.022;

/// The surface of the pane.
pub(super) fn surface() -> Surface {
    let at = |texel: u32| (f64::from(texel) + 0.5) / f64::from(SIZE) * 2.0 - 1.0;
    let texels = (0..SIZE * SIZE).map(|i| tint(DVec2::new(at(i % SIZE), at(i / SIZE))).to_array()).collect();
    let size = TextureSize { width: SIZE, height: SIZE, wrap: [Wrap::Clamp; 2] };
    Surface::Stained(Arc::new(Texture { size, texels }))
}

/// The tint at a point of −1..=1 each way; lead lets nothing through.
fn tint(point: DVec2) -> Vec3 {
    let (radius, turn) = (point.length(), point.y.atan2(point.x) / TAU * PETALS);
    // From the middle of the nearest petal, and from the middle between two, along the circle.
    let petal = (turn - turn.round()) * TAU / PETALS * radius;
    let between = (turn - turn.floor() - 0.5) * TAU / PETALS * radius;
    let width = 0.30 * ((radius - 0.22) / 0.66 * TAU * 0.5).sin();
    let on_circle = |of: f64| (radius - of).abs() < LEAD;
    let lead = on_circle(0.22)
        || on_circle(0.96)
        || (0.22..0.88).contains(&radius) && (petal.abs() - width).abs() < LEAD
        || (0.22..0.96).contains(&radius) && between.abs() < LEAD && petal.abs() > width;
    match radius {
        _ if lead => Vec3::ZERO,
        ..0.22 => AMBER,
        ..0.88 if petal.abs() < width => {
            if turn.round().rem_euclid(2.0) == 0.0 {
                RUBY
            } else {
                VIOLET
            }
        }
        ..0.96 => {
            if radius > 0.62 {
                COBALT
            } else {
                TURQUOISE
            }
        }
        _ => PALE,
    }
}
