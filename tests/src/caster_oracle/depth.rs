//! Optical depths, in 2^-11 of a stop: from tints, and to what they let through. No table and no logarithm decides a rounding here:
//! powers of integers do.
//!
//! Nothing is ever half-way: `2^(−k/4096)` and `2^(−k/2048)` are no rational numbers where k is no multiple of 4096, or 2048.

use std::sync::OnceLock;

use dashu_int::UBig;

/// Depths of a stop: a factor of 2.
const STOP: u32 = 2048;

/// The depth that lets nothing through.
pub const OPAQUE: u16 = u16::MAX;

/// `t < 2^(−k/4096)`, of `t = mantissa · 2^exponent`: both sides to the power 4096.
fn is_below(mantissa: u32, exponent: i32, k: u32) -> bool {
    let power = UBig::from(mantissa).pow(4096);
    // mantissa^4096 < 2^shift
    let shift = -i64::from(k) - 4096 * i64::from(exponent);
    usize::try_from(shift).is_ok_and(|shift| power < UBig::ONE << shift)
}

/// The depth of a tint in 0..=1: the nearest to `−2048 · log2 t`.
pub fn of_tint(tint: f32) -> u16 {
    assert!((0.0..=1.0).contains(&tint), "{tint} is no tint");
    if tint == 0.0 {
        return OPAQUE;
    }
    let bits = tint.to_bits();
    let (mantissa, exponent) = match bits >> 23 {
        0 => (bits, -149),
        biased => (bits & 0x7f_ffff | 0x80_0000, biased as i32 - 150),
    };
    // A guess, and then the one depth d with 2^(−(2d+1)/4096) < t < 2^(−(2d−1)/4096).
    let mut depth = (-f64::from(STOP) * f64::from(tint).log2()).round() as u32;
    while is_below(mantissa, exponent, 2 * depth + 1) {
        depth += 1;
    }
    while depth > 0 && !is_below(mantissa, exponent, 2 * depth - 1) {
        depth -= 1;
    }
    depth.min(u32::from(OPAQUE) - 1) as u16
}

/// `2^(16 − r/2048)`, rounded, for r in 0..2048.
fn within_a_stop(r: u32) -> u32 {
    // (2k − 1)^2048 < 2^(17·2048 − r) < (2k + 1)^2048
    let power = UBig::ONE << (17 * STOP - r) as usize;
    let mut k = (65536.0 * (-f64::from(r) / f64::from(STOP)).exp2()).round() as u32;
    while UBig::from(2 * k + 1).pow(STOP as usize) < power {
        k += 1;
    }
    while UBig::from(2 * k - 1).pow(STOP as usize) > power {
        k -= 1;
    }
    k
}

/// What a depth lets through, in 2^-16.
pub fn transmittance(depth: u16) -> u32 {
    static STOPS: OnceLock<Vec<u32>> = OnceLock::new();
    if depth == OPAQUE {
        return 0;
    }
    let (stops, rest) = (u32::from(depth) / STOP, u32::from(depth) % STOP);
    let of_rest = STOPS.get_or_init(|| (0..STOP).map(within_a_stop).collect())[rest as usize];
    // Halves up: of_rest / 2^stops + 1/2, without what is left.
    ((2 * u64::from(of_rest) + (1 << stops)) / (2 << stops)) as u32
}

/// What is left of a weight behind a depth: nearest, halves up.
pub fn transmitted(weight: u16, depth: u16) -> u32 {
    ((2 * u64::from(weight) * u64::from(transmittance(depth)) + 65536) / 131_072) as u32
}

/// Depths behind one another.
pub fn sum(one: [u16; 3], other: [u16; 3]) -> [u16; 3] {
    [0, 1, 2].map(|channel| {
        let sum = u32::from(one[channel]) + u32::from(other[channel]);
        u16::try_from(sum).unwrap_or(OPAQUE)
    })
}
