//! FLIP: how different two pictures look to someone who flips between them. For displays of low dynamic range.
//!
//! Andersson, Nilsson, Akenine-Möller, Oskarsson, Åström and Fairchild, *FLIP: A Difference Evaluator for Alternating
//! Images* (2020). Numbers in comments are its sections. The values are those of the authors' own program to within the
//! rounding of f32 (a test holds some).

mod color;
mod filter;

use std::f32::consts::PI;

use image::RgbImage;
use rayon::prelude::*;
use umbra4_core::glam::Vec3;

use color::{Spaces, hyab};
use filter::{Plane, balanced, of_sum_one, sampled};

/// Pixels a degree of visual angle: the authors' 4K display, 0.7 m wide, seen from 0.7 m.
pub const PIXELS_PER_DEGREE: f32 = 3840.0 / 0.7 * 0.7 * PI / 180.0;

/// 4.1.1: contrast sensitivity of luminance, red-green and blue-yellow, each one or two Gaussians (height a, width b).
const SENSITIVITY: [&[(f32, f32)]; 3] = [&[(1.0, 0.0047)], &[(1.0, 0.0053)], &[(34.1, 0.04), (13.5, 0.025)]];
/// The widest of them: all are cut off at three of its standard deviations.
const WIDEST: f32 = 0.04;
/// 4.1.3: exponent of colour differences.
const QC: f32 = 0.7;
/// 4.1.3: the share `PC` of the largest colour difference is mapped to `PT`.
const PC: f32 = 0.4;
const PT: f32 = 0.95;
/// 4.2: width of edges and points, degrees.
const FEATURE: f32 = 0.082;
/// 4.2: exponent of feature differences.
const QF: f32 = 0.5;

/// Beyond this many pixels, a pixel does not reach into another's value.
pub const REACH: u32 = 10;

/// A picture prepared for comparison.
#[derive(Clone, Debug)]
pub struct Seen {
    size: (u32, u32),
    /// Filtered as the eye does, in Hunt-adjusted L*a*b*.
    colors: Vec<Vec3>,
    /// Strength of the edge and of the point at every pixel.
    features: Vec<[f32; 2]>,
}

impl Seen {
    /// Filters a picture: what two comparisons of it have in common.
    pub fn new(picture: &RgbImage) -> Self {
        let spaces = Spaces::new();
        let opponent: Vec<Vec3> = picture
            .as_raw()
            .par_chunks_exact(3)
            .map(|rgb| spaces.ycxcz(Vec3::new(rgb[0].into(), rgb[1].into(), rgb[2].into()) / 255.0))
            .collect();
        let width = picture.width() as usize;
        let plane = |value: fn(&Vec3) -> f32| Plane { width, values: opponent.par_iter().map(value).collect() };
        let planes = [plane(|c| c.x), plane(|c| c.y), plane(|c| c.z)];
        let [y, cx, cz] = [0, 1, 2].map(|channel| as_the_eye_does(&planes[channel], SENSITIVITY[channel]));
        let colors = (y.values.par_iter().zip(&cx.values).zip(&cz.values))
            .map(|((&y, &cx), &cz)| spaces.hunt_lab(Vec3::new(y, cx, cz)))
            .collect();
        Self { size: picture.dimensions(), colors, features: features(&plane(|c| (c.x + 16.0) / 116.0)) }
    }

    /// FLIP of every pixel, in 0..=1, row by row; `None` where the pictures differ in size.
    pub fn against(&self, other: &Self) -> Option<Vec<f32>> {
        let spaces = Spaces::new();
        let [green, blue] = [Vec3::Y, Vec3::Z].map(|c| spaces.hunt_lab_of_linear(c));
        let largest = hyab(green, blue).powf(QC);
        let pixel = |i: usize| {
            let color = redistributed(hyab(self.colors[i], other.colors[i]).powf(QC), largest);
            let [edge, point] = [0, 1].map(|k| (self.features[i][k] - other.features[i][k]).abs());
            let feature = (edge.max(point) * std::f32::consts::FRAC_1_SQRT_2).powf(QF);
            color.powf(1.0 - feature.min(1.0))
        };
        (self.size == other.size).then(|| (0..self.colors.len()).into_par_iter().map(pixel).collect())
    }
}

/// A plane of an opponent space, filtered with a contrast sensitivity.
fn as_the_eye_does(plane: &Plane, gaussians: &[(f32, f32)]) -> Plane {
    let radius = (3.0 * (WIDEST / (2.0 * PI * PI)).sqrt() * PIXELS_PER_DEGREE).ceil() as u32;
    let terms: Vec<(f32, Vec<f32>)> = gaussians
        .iter()
        .map(|&(a, b)| {
            let weights = sampled(radius, |x| (-PI * PI * (x / PIXELS_PER_DEGREE).powi(2) / b).exp());
            let sum: f32 = weights.iter().sum();
            (a * (PI / b).sqrt() * sum * sum, of_sum_one(weights))
        })
        .collect();
    let all: f32 = terms.iter().map(|(share, _)| share).sum();
    let empty = Plane { width: plane.width, values: vec![0.0; plane.values.len()] };
    terms.iter().fold(empty, |sum, (share, weights)| {
        let down: Vec<f32> = weights.iter().map(|w| w * share / all).collect();
        sum.plus(&plane.filtered(weights, &down))
    })
}

/// Edges are found by the first derivative of a Gaussian, points by the second.
fn features(luminance: &Plane) -> Vec<[f32; 2]> {
    let deviation = 0.5 * FEATURE * PIXELS_PER_DEGREE;
    let radius = (3.0 * deviation).ceil() as u32;
    let gaussian = |x: f32| (-x * x / (2.0 * deviation * deviation)).exp();
    let smooth = of_sum_one(sampled(radius, gaussian));
    let first = balanced(sampled(radius, |x| -x * gaussian(x)));
    let second = balanced(sampled(radius, |x| (x * x / (deviation * deviation) - 1.0) * gaussian(x)));
    let strength = |derivative: &[f32]| {
        let (x, y) = (luminance.filtered(derivative, &smooth), luminance.filtered(&smooth, derivative));
        x.values.into_iter().zip(y.values).map(|(x, y)| x.hypot(y)).collect::<Vec<f32>>()
    };
    strength(&first).into_iter().zip(strength(&second)).map(|(edge, point)| [edge, point]).collect()
}

/// 4.1.3: the upper part of the scale is compressed.
fn redistributed(difference: f32, largest: f32) -> f32 {
    let limit = PC * largest;
    if difference < limit {
        PT / limit * difference
    } else {
        PT + (difference - limit) / (largest - limit) * (1.0 - PT)
    }
}

#[cfg(test)]
mod tests {
    use image::Rgb;

    use super::*;

    /// A picture made of numbers that a test in any language can make too.
    fn pattern(width: u32, height: u32, seed: u32) -> RgbImage {
        RgbImage::from_fn(width, height, |x, y| {
            Rgb([(x * 7 + y * 3 + seed) % 256, (x * y + 5 * seed) % 256, (x * x + 11 * y) % 256].map(|v| v as u8))
        })
    }

    fn flat(color: [u8; 3]) -> RgbImage {
        RgbImage::from_pixel(24, 24, Rgb(color))
    }

    fn mean(a: &RgbImage, b: &RgbImage) -> f32 {
        let map = Seen::new(a).against(&Seen::new(b)).unwrap();
        assert!(map.iter().all(|v| (0.0..=1.0).contains(v)));
        map.iter().sum::<f32>() / map.len() as f32
    }

    /// Means of the authors' program (in C++, version 1.2), at as many pixels a degree, to within the rounding of f32.
    #[test]
    fn the_values_are_those_of_the_authors_program() {
        let gray = (flat([100, 100, 100]), flat([110, 105, 100]));
        let black_and_white = (flat([0, 0, 0]), flat([255, 255, 255]));
        for ((a, b), expected) in [
            ((pattern(40, 30, 1), pattern(40, 30, 60)), 0.654_852),
            ((pattern(40, 30, 1), pattern(40, 30, 3)), 0.219_468),
            ((pattern(64, 64, 0), pattern(64, 64, 200)), 0.606_854),
            (gray, 0.150_981),
            (black_and_white, 0.967_388),
        ] {
            assert!((mean(&a, &b) - expected).abs() < 2e-5, "{} instead of {expected}", mean(&a, &b));
        }
    }

    #[test]
    fn equal_pictures_do_not_differ() {
        assert_eq!(mean(&pattern(40, 30, 1), &pattern(40, 30, 1)), 0.0);
    }

    #[test]
    fn the_order_does_not_matter() {
        let (a, b) = (pattern(40, 30, 1), pattern(40, 30, 60));
        assert!(mean(&a, &b) > 0.05);
        assert!((mean(&a, &b) - mean(&b, &a)).abs() < 1e-6);
    }

    #[test]
    fn it_grows_with_the_difference_and_reaches_one() {
        let steps = [1, 2, 5, 20, 80, 200].map(|v| mean(&flat([0, 0, 0]), &flat([v, v, v])));
        assert!(steps.windows(2).all(|pair| pair[0] < pair[1]), "{steps:?}");
        // The largest colour difference there is.
        assert!((mean(&flat([0, 255, 0]), &flat([0, 0, 255])) - 1.0).abs() < 1e-3);
    }

    #[test]
    fn pictures_of_different_sizes_are_refused() {
        assert!(Seen::new(&pattern(4, 3, 0)).against(&Seen::new(&pattern(3, 4, 0))).is_none());
    }

    #[test]
    fn no_pixel_reaches_farther_than_stated() {
        let (a, mut b) = (flat([120, 120, 120]), flat([120, 120, 120]));
        b.put_pixel(0, 0, Rgb([255, 0, 0]));
        let map = Seen::new(&a).against(&Seen::new(&b)).unwrap();
        let beyond = |i: usize| i % 24 > REACH as usize || i / 24 > REACH as usize;
        assert!(map[0] > 0.0 && map.iter().enumerate().all(|(i, v)| !beyond(i) || *v < 1e-4));
    }
}
