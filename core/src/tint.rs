//! Tints: what panes let through, as optical depths. Depths add up where transmittances multiply, and sums of integers are the same
//! in any order, on every processor: so light through panes is exact once a tint has been rounded to a depth.
//!
//! A depth counts in 2^-11 stops: depth d lets `2^(−d/2048)` through. Rounding a tint to a depth changes it by at most 0.017 %, the
//! table of [`transmittance`] by 2^-17 of full light. From [`OPAQUE`] on nothing comes through.
//!
//! Sintorn, Eisemann and Assarsson 2008 name transparency by coverage of samples; depths leave every sample its colour.

#[cfg(not(target_arch = "spirv"))]
use crate::emission::Weight;

/// The depth of what lets nothing through. Sums stay there.
pub const OPAQUE: u32 = 0xffff;

/// Depths in which light is halved once.
pub const STOP: u32 = 1 << STOP_BITS;
const STOP_BITS: u32 = 11;

/// Binary digits of a transmittance after the point.
const DIGITS: u32 = 16;

/// The optical depth that lies before a light sample, or that a texel adds: red in the low half of the first word, green in the high
/// one, blue in the second.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct Depth([u32; 2]);

impl Depth {
    /// Nothing in between.
    pub const CLEAR: Self = Self([0; 2]);

    /// Of depths below 2^16: red, green, blue.
    #[inline(always)]
    pub const fn new([red, green, blue]: [u32; 3]) -> Self {
        Self([red | green << 16, blue])
    }

    /// As it is packed.
    #[inline(always)]
    pub const fn from_words(words: [u32; 2]) -> Self {
        Self(words)
    }

    /// As it is packed.
    #[inline(always)]
    pub const fn words(self) -> [u32; 2] {
        self.0
    }

    /// Red, green and blue.
    #[inline(always)]
    pub const fn channels(self) -> [u32; 3] {
        [self.0[0] & 0xffff, self.0[0] >> 16, self.0[1] & 0xffff]
    }

    /// Both behind each other.
    #[inline(always)]
    #[must_use]
    pub const fn and(self, other: Self) -> Self {
        let ([r, g, b], [s, h, c]) = (self.channels(), other.channels());
        Self::new([capped(r + s), capped(g + h), capped(b + c)])
    }
}

#[inline(always)]
const fn capped(depth: u32) -> u32 {
    if depth < OPAQUE { depth } else { OPAQUE }
}

/// Transmittances of the depths below a stop, in 2^-16.
pub type Transmittances = [u32; STOP as usize];

/// What a depth lets through, in 2^-16: `0..=65536`. `table` holds [`TRANSMITTANCES`].
#[inline(always)]
pub fn transmittance(table: &[u32], depth: u32) -> u32 {
    let place = (depth % STOP) as usize;
    if depth >= OPAQUE || place >= table.len() {
        return 0;
    }
    let stops = depth >> STOP_BITS;
    // Half of the last digit, where any is lost.
    (table[place] + (1 << stops >> 1)) >> stops
}

/// A weight, seen through a depth; rounded.
#[inline(always)]
pub fn tinted(table: &[u32], weight: [u32; 3], depth: Depth) -> [u32; 3] {
    let [red, green, blue] = depth.channels();
    let half = 1 << (DIGITS - 1);
    // At most 65535·65536 + 32768.
    [
        (weight[0] * transmittance(table, red) + half) >> DIGITS,
        (weight[1] * transmittance(table, green) + half) >> DIGITS,
        (weight[2] * transmittance(table, blue) + half) >> DIGITS,
    ]
}

/// As [`tinted`], of a weight as emissions have it, with the table of this crate.
#[cfg(not(target_arch = "spirv"))]
pub fn tinted_weight(weight: Weight, depth: Depth) -> [u32; 3] {
    tinted(&TRANSMITTANCES, weight.map(u32::from), depth)
}

/// Transmittances of the depths below a stop.
#[cfg(not(target_arch = "spirv"))]
pub static TRANSMITTANCES: Transmittances = transmittances();

#[cfg(not(target_arch = "spirv"))]
const fn transmittances() -> Transmittances {
    let (mut table, mut depth) = ([0; STOP as usize], 0);
    while depth < table.len() {
        table[depth] = (halved(depth as f64 / STOP as f64) * (1 << DIGITS) as f64 + 0.5) as u32;
        depth += 1;
    }
    table
}

/// `2^−x` for x in `0.0..=1.0`, to a few 2^-52: the series of the exponential function. Sums and products alone, so that it is the same
/// on every machine.
#[cfg(not(target_arch = "spirv"))]
const fn halved(x: f64) -> f64 {
    let y = -core::f64::consts::LN_2 * x;
    let (mut term, mut sum, mut k) = (1.0, 1.0, 1);
    while k < 24 {
        term *= y / k as f64;
        sum += term;
        k += 1;
    }
    sum
}

/// The depth of a tint that lets the fraction `t` through, in `0.0..=1.0`: the one that lets most nearly as much through, by ratio. 0 is
/// [`OPAQUE`], and nothing else is; `None` where t is no such fraction.
#[cfg(not(target_arch = "spirv"))]
pub fn depth_of(t: f32) -> Option<u32> {
    // Compared so that NaN is refused.
    if !(0.0..=1.0).contains(&t) {
        return None;
    }
    if t == 0.0 {
        return Some(OPAQUE);
    }
    // The last depth d whose tint, moved half a depth up, is still above t: 2^(−(d − ½)/2048) > t.
    let (mut low, mut high) = (0, OPAQUE - 1);
    while low < high {
        let middle = (low + high).div_ceil(2);
        let halves = 2 * middle - 1;
        let (stops, rest) = (halves / (2 * STOP), halves % (2 * STOP));
        let part = halved(f64::from(rest) / f64::from(2 * STOP));
        let whole = f64::from_bits(u64::from(1023 - stops) << 52); // 2^−stops
        if part * whole >= f64::from(t) {
            low = middle;
        } else {
            high = middle - 1;
        }
    }
    Some(low)
}

/// The depth of a tint: what is let through of red, green and blue.
///
/// # Errors
/// A channel that is no fraction; `index` names the texel.
#[cfg(not(target_arch = "spirv"))]
pub fn depth_of_tint(index: usize, tint: [f32; 3]) -> Result<Depth, crate::texture::TextureError> {
    let mut channels = [0; 3];
    for ((channel, value), name) in channels.iter_mut().zip(tint).zip(["red", "green", "blue"]) {
        *channel = depth_of(value).ok_or(crate::texture::TextureError::Tint { index, channel: name, value })?;
    }
    Ok(Depth::new(channels))
}
