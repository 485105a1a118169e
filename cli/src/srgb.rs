//! The transfer curve of sRGB.

/// A value of sRGB, `0.0..=1.0`, as linear light.
pub fn linear(encoded: f32) -> f32 {
    if encoded <= 0.040_45 { encoded / 12.92 } else { ((encoded + 0.055) / 1.055).powf(2.4) }
}

/// Linear light as a value of sRGB.
pub fn encoded(linear: f32) -> f32 {
    if linear <= 0.003_130_8 { 12.92 * linear } else { 1.055 * linear.powf(1.0 / 2.4) - 0.055 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn there_and_back() {
        for step in 0..=255_u8 {
            let value = f32::from(step) / 255.0;
            assert!((encoded(linear(value)) - value).abs() < 1e-5);
        }
        // By hand: ((0.5 + 0.055) / 1.055)^2.4.
        assert!((linear(0.5) - 0.214_041).abs() < 1e-5);
    }
}
