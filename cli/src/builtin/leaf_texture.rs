//! A texture of alphas with two sprigs side by side: leaflets along a stem, and a broad lobed leaf.

use std::{f64::consts::TAU, sync::Arc};

use umbra4_core::{
    glam::DVec2,
    texture::{TextureSize, Wrap},
};

use crate::model::{Surface, Texture};

/// Texels each way of one sprig.
const SIZE: u32 = 128;
/// Points each way in a texel, of which alpha is the share that is covered.
const POINTS: u32 = 4;
/// Alphas from here on block light.
const THRESHOLD: u8 = 128;
/// Pairs of leaflets along a stem.
const PAIRS: u32 = 5;

/// How many sprigs there are, side by side along u.
pub(super) const SPRIGS: u32 = 2;

/// The surface of a card. Stems stand upright, with their feet at v = 1.
pub(super) fn surface() -> Surface {
    let texels = (0..SIZE * SIZE * SPRIGS).map(|i| alpha(i % (SIZE * SPRIGS), i / (SIZE * SPRIGS))).collect();
    let size = TextureSize { width: SIZE * SPRIGS, height: SIZE, wrap: [Wrap::Clamp; 2] };
    Surface::Cutout { alphas: Arc::new(Texture { size, texels }), threshold: THRESHOLD }
}

fn alpha(column: u32, row: u32) -> u8 {
    let covered = |i: u32| {
        let at = |texel: u32, point: u32| {
            (f64::from(texel) + (f64::from(point) + 0.5) / f64::from(POINTS)) / f64::from(SIZE)
        };
        // From the foot of the stem, upwards.
        let point = DVec2::new(at(column % SIZE, i % POINTS) - 0.5, 1.0 - at(row, i / POINTS));
        if column < SIZE { leaflets(point) } else { lobed(point) }
    };
    let points = POINTS * POINTS;
    ((0..points).filter(|i| covered(*i)).count() as u32 * 255 / points) as u8
}

/// A stem with pairs of leaflets and one at its end.
fn leaflets(point: DVec2) -> bool {
    let stem = point.x.abs() < 0.011 && point.y < 0.8;
    let mut pairs = (0..PAIRS).flat_map(|pair| {
        let along = f64::from(pair) / f64::from(PAIRS);
        let foot = DVec2::new(0.0, 0.1 + 0.6 * along);
        let length = 0.36 * (1.0 - 0.35 * along);
        [-1.0, 1.0].map(|side| blade(point - foot, DVec2::from_angle(TAU * (0.25 - side * 0.165)), length))
    });
    stem || pairs.any(|inside| inside) || blade(point - DVec2::new(0.0, 0.66), DVec2::Y, 0.31)
}

/// Whether a point lies in a pointed blade from the origin along `axis`.
fn blade(point: DVec2, axis: DVec2, length: f64) -> bool {
    let (along, across) = (point.dot(axis) / length, point.perp_dot(axis).abs() / length);
    (0.0..=1.0).contains(&along) && across < 0.23 * (along.powf(0.8) * TAU * 0.5).sin()
}

/// A leaf of five lobes on a stalk.
fn lobed(point: DVec2) -> bool {
    let stalk = point.x.abs() < 0.013 && point.y < 0.4;
    let from_heart = point - DVec2::new(0.0, 0.42);
    // Up is where the largest lobe is.
    let angle = from_heart.x.atan2(from_heart.y);
    let notch = 1.0 + 0.34 * (angle * 5.0).cos() + 0.035 * (angle * 31.0).cos();
    let reach = 0.34 * (0.86 + 0.20 * angle.cos()) * notch;
    stalk || from_heart.length() < reach
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sprigs_cover_a_part_of_their_cards_and_end_before_the_edges() {
        let Surface::Cutout { alphas, threshold } = surface() else { panic!("no cutout") };
        let opaque = |column: u32, row: u32| alphas.texels[(row * alphas.size.width + column) as usize] >= threshold;
        for sprig in 0..SPRIGS {
            let columns = sprig * SIZE..(sprig + 1) * SIZE;
            let covered = columns.clone().flat_map(|x| (0..SIZE).map(move |y| (x, y))).filter(|&(x, y)| opaque(x, y));
            let share = covered.count() as f64 / f64::from(SIZE * SIZE);
            assert!((0.2..0.6).contains(&share), "sprig {sprig}: {share}");
            let rim = columns
                .clone()
                .map(|x| (x, 0))
                .chain((0..SIZE).flat_map(|y| [(columns.start, y), (columns.end - 1, y)]));
            assert_eq!(rim.filter(|&(x, y)| opaque(x, y)).count(), 0, "sprig {sprig}");
        }
        // Edges are smooth: neither all nor nothing.
        assert!(alphas.texels.iter().any(|alpha| (1..threshold).contains(alpha)));
    }
}
