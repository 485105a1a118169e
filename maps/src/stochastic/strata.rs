//! Where on the light a texel looks from (section 7.1): 4 × 4 neighbours take the 16 strata of the light, each a random place of its own.
//!
//! Strata are laid out plainly, column by column and row by row. So each of the four classes that interleaved sampling tells apart has a stratum in
//! every quarter of the light.

use glam::Vec2;

/// Strata along each edge of the light.
pub const STRATA: u32 = 4;

/// The place on the light, `−1.0..1.0` each, of texel (`column`, `row`).
#[inline(always)]
pub fn light_position(column: u32, row: u32, seed: u32) -> Vec2 {
    let random = mixed(mixed(mixed(seed ^ 0x9e37_79b9).wrapping_add(column)).wrapping_add(row));
    Vec2::new(within(column % STRATA, random & 0xffff), within(row % STRATA, random >> 16))
}

/// 16 binary digits of a place in a stratum: all of this is exact.
#[inline(always)]
fn within(stratum: u32, digits: u32) -> f32 {
    let place = stratum as f32 + (digits as f32 + 0.5) / 65536.0;
    place * (2.0 / STRATA as f32) - 1.0
}

/// An integer of which every bit depends on all bits of `x` (the finaliser of MurmurHash3).
#[inline(always)]
fn mixed(x: u32) -> u32 {
    let x = (x ^ x >> 16).wrapping_mul(0x85eb_ca6b);
    let x = (x ^ x >> 13).wrapping_mul(0xc2b2_ae35);
    x ^ x >> 16
}
