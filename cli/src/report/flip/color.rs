//! Colour spaces of FLIP: sRGB, linear RGB, XYZ, YCxCz and Hunt-adjusted L*a*b*, all under D65.

use umbra4_core::glam::{Mat3, Vec3};

use crate::srgb;

/// Linear RGB (Rec. 709 primaries) to XYZ, row by row.
const TO_XYZ: [[f32; 3]; 3] = [
    [10_135_552.0 / 24_577_794.0, 8_788_810.0 / 24_577_794.0, 4_435_075.0 / 24_577_794.0],
    [2_613_072.0 / 12_288_897.0, 8_788_810.0 / 12_288_897.0, 887_015.0 / 12_288_897.0],
    [1_425_312.0 / 73_733_382.0, 8_788_810.0 / 73_733_382.0, 70_074_185.0 / 73_733_382.0],
];

/// Conversions between the spaces.
#[derive(Clone, Copy, Debug)]
pub struct Spaces {
    to_xyz: Mat3,
    from_xyz: Mat3,
    /// XYZ of white, (1, 1, 1) in linear RGB.
    white: Vec3,
}

impl Spaces {
    /// D65 and the primaries of sRGB.
    pub fn new() -> Self {
        let to_xyz = Mat3::from_cols_array_2d(&TO_XYZ).transpose();
        Self { to_xyz, from_xyz: to_xyz.inverse(), white: to_xyz * Vec3::ONE }
    }

    /// sRGB in 0..=1 to YCxCz, an opponent space that is linear: Y is −16..=100.
    pub fn ycxcz(&self, srgb: Vec3) -> Vec3 {
        let xyz = self.to_xyz * Vec3::from(srgb.to_array().map(srgb::linear)) / self.white;
        Vec3::new(116.0 * xyz.y - 16.0, 500.0 * (xyz.x - xyz.y), 200.0 * (xyz.y - xyz.z))
    }

    /// YCxCz to L*a*b*, by way of linear RGB in 0..=1; chroma shrinks with the luminance (Hunt's effect).
    pub fn hunt_lab(&self, ycxcz: Vec3) -> Vec3 {
        let y = (ycxcz.x + 16.0) / 116.0;
        let xyz = Vec3::new(y + ycxcz.y / 500.0, y, y - ycxcz.z / 200.0) * self.white;
        self.hunt_lab_of_linear((self.from_xyz * xyz).clamp(Vec3::ZERO, Vec3::ONE))
    }

    /// As [`Spaces::hunt_lab`], from linear RGB.
    pub fn hunt_lab_of_linear(&self, rgb: Vec3) -> Vec3 {
        let [x, y, z] = (self.to_xyz * rgb / self.white).to_array().map(compressed);
        let lightness = 116.0 * y - 16.0;
        Vec3::new(lightness, 0.01 * lightness * 500.0 * (x - y), 0.01 * lightness * 200.0 * (y - z))
    }
}

/// The HyAB distance of two colours in L*a*b*: city-block between lightness and chroma, Euclidean within chroma.
pub fn hyab(a: Vec3, b: Vec3) -> f32 {
    let d = a - b;
    d.x.abs() + d.y.hypot(d.z)
}

/// The cube root of L*a*b*, with its linear part near black.
fn compressed(t: f32) -> f32 {
    const DELTA: f32 = 6.0 / 29.0;
    if t > DELTA * DELTA * DELTA { t.cbrt() } else { t / (3.0 * DELTA * DELTA) + 4.0 / 29.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn black_and_white_are_where_they_should_be() {
        let spaces = Spaces::new();
        assert!((spaces.ycxcz(Vec3::ZERO) - Vec3::new(-16.0, 0.0, 0.0)).length() < 1e-4);
        assert!((spaces.ycxcz(Vec3::ONE) - Vec3::new(100.0, 0.0, 0.0)).length() < 1e-3);
        assert!((spaces.hunt_lab(spaces.ycxcz(Vec3::ONE)) - Vec3::new(100.0, 0.0, 0.0)).length() < 1e-2);
        assert!(spaces.hunt_lab(spaces.ycxcz(Vec3::ZERO)).length() < 1e-2);
    }

    #[test]
    fn white_is_d65() {
        assert!((Spaces::new().white - Vec3::new(0.950_428_5, 1.0, 1.088_900_4)).length() < 1e-6);
    }

    #[test]
    fn green_and_blue_are_as_far_apart_as_the_paper_says() {
        let spaces = Spaces::new();
        let [green, blue] = [Vec3::Y, Vec3::Z].map(|c| spaces.hunt_lab_of_linear(c));
        // Largest distance within sRGB, raised to 0.7: section 4.1.3.
        assert!((hyab(green, blue).powf(0.7) - 41.276).abs() < 0.1, "{}", hyab(green, blue).powf(0.7));
    }
}
