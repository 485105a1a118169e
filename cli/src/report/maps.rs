//! Pictures of differences, and of methods that ran on a part of the picture.

use image::{Rgb, RgbImage};
use umbra4_core::glam::Vec3;

use crate::{
    primary::GBuffer,
    report::{
        methods::{Method, Run, UNIT},
        tiles::Choice,
    },
};

/// Brighter than the reference, and darker.
const TOO_BRIGHT: Vec3 = Vec3::new(0.70, 0.09, 0.17);
const TOO_DARK: Vec3 = Vec3::new(0.13, 0.40, 0.67);
/// What sees nothing, or was not measured.
const NOTHING: Rgb<u8> = Rgb([232, 232, 232]);
/// Of a method that ran elsewhere, so much of the picture is left.
const FAINT: f32 = 0.25;
/// This share of the receivers is within the scale of the map.
const WITHIN: f64 = 0.99;

/// By how much differences are amplified, the same for all methods: 1, 2 or 5 times a power of ten, so that most of those of
/// the method that is the unit of time are within the scale.
pub fn gain<'a>(mut runs: impl Iterator<Item = (&'a dyn Method, &'a Run)>, reference: &[f32]) -> f64 {
    let unit = runs.find(|(method, _)| (method.family(), method.side()) == UNIT);
    let Some((method, run)) = unit else { return 1.0 };
    let expected = method.choice().of(reference);
    let mut differences: Vec<f32> = run.visibility.iter().zip(&expected).map(|(v, e)| (v - e).abs()).collect();
    differences.sort_by(f32::total_cmp);
    let at = (differences.len() as f64 * WITHIN) as usize;
    round_down(1.0 / differences.get(at).copied().map_or(1.0, f64::from))
}

/// The largest of 1, 2, 5, 10, … up to `most`; 1 where there is none.
fn round_down(most: f64) -> f64 {
    let series = (0..6).flat_map(|power| [1.0, 2.0, 5.0].map(|n| n * 10_f64.powi(power)));
    if most.is_finite() { series.take_while(|n| *n <= most).last().unwrap_or(1.0) } else { 1.0 }
}

/// Where and which way the chosen receivers differ from the reference: white for not at all.
pub fn signed(seen: &GBuffer, choice: &Choice, values: &[f32], reference: &[f32], gain: f64) -> RgbImage {
    let mut difference = vec![None; reference.len()];
    for (&receiver, &value) in choice.receivers.iter().zip(values) {
        difference[receiver as usize] = Some(value - reference[receiver as usize]);
    }
    by_pixel(seen, |receiver| {
        let Some(difference) = difference[receiver] else { return NOTHING };
        let strength = (f64::from(difference.abs()) * gain).min(1.0) as f32;
        bytes(Vec3::ONE.lerp(if difference > 0.0 { TOO_BRIGHT } else { TOO_DARK }, strength))
    })
}

/// The picture, faint where the method did not run.
pub fn faded(picture: &RgbImage, seen: &GBuffer, choice: &Choice, receivers: usize) -> RgbImage {
    let mut ran = vec![false; receivers];
    choice.receivers.iter().for_each(|&receiver| ran[receiver as usize] = true);
    let mut out = picture.clone();
    let full = by_pixel(seen, |receiver| Rgb([u8::from(ran[receiver]); 3]));
    for (pixel, ran) in out.pixels_mut().zip(full.pixels()) {
        if ran.0[0] != 1 && choice.one_in > 1 {
            pixel.0 = pixel.0.map(|v| (255.0 - (255.0 - f32::from(v)) * FAINT) as u8);
        }
    }
    out
}

/// `color(receiver)` of every pixel that sees something.
fn by_pixel(seen: &GBuffer, color: impl Fn(usize) -> Rgb<u8>) -> RgbImage {
    let mut image = RgbImage::from_pixel(seen.width, seen.height, NOTHING);
    let pixels = image.pixels_mut().zip(&seen.hits).filter(|(_, hit)| hit.is_some());
    for (receiver, (out, _)) in pixels.enumerate() {
        *out = color(receiver);
    }
    image
}

fn bytes(color: Vec3) -> Rgb<u8> {
    Rgb(color.to_array().map(|v| (v.clamp(0.0, 1.0) * 255.0).round() as u8))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::primary::Hit;

    fn seen() -> GBuffer {
        let hit = Hit { position: Vec3::ZERO, normal: Vec3::Y, triangle: 0 };
        GBuffer { width: 2, height: 2, hits: vec![Some(hit), None, Some(hit), Some(hit)], tints: Vec::new() }
    }

    #[test]
    fn equal_is_white_and_brighter_is_red() {
        let map = signed(&seen(), &Choice::everyone(3), &[0.5, 0.6, 0.4], &[0.5; 3], 5.0);
        assert_eq!(map.get_pixel(0, 0), &Rgb([255, 255, 255]));
        assert_eq!(map.get_pixel(1, 0), &NOTHING);
        let [red, blue] = [map.get_pixel(0, 1), map.get_pixel(1, 1)];
        assert!(red.0[0] > red.0[2] && blue.0[2] > blue.0[0]);
    }

    #[test]
    fn the_gain_is_a_round_number() {
        assert_eq!([0.3, 1.0, 4.9, 5.0, 77.0, f64::INFINITY].map(round_down), [1.0, 1.0, 2.0, 5.0, 50.0, 1.0]);
    }
}
