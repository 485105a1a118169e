//! A grey picture of the lit share of every receiver, to see that a setting is what it should be.

use std::path::Path;

use crate::{primary::Hit, row_word::RowWord};

/// Writes a binary .pgm; pixels without a receiver are mid-grey.
pub fn write<W: RowWord>(path: &Path, size: u32, hits: &[Hit], masks: &[W], samples: u32) -> std::io::Result<()> {
    let mut pixels = vec![128_u8; (size * size) as usize];
    let rows = masks.len() / hits.len().max(1);
    for (hit, mask) in hits.iter().zip(masks.chunks_exact(rows.max(1))) {
        let blocked: u32 = mask.iter().map(|word| word.count()).sum();
        let facing = 0.25 + 0.75 * f64::from(hit.normal.y.abs());
        let lit = 1.0 - f64::from(blocked) / f64::from(samples);
        pixels[(hit.y * size + hit.x) as usize] = (255.0 * (0.15 + 0.85 * lit) * facing) as u8;
    }
    let mut file = format!("P5 {size} {size} 255\n").into_bytes();
    file.extend(pixels);
    std::fs::write(path, file)
}
