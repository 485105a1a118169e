//! Which texel of a triangle a light sample is seen through: a ratio of determinants, certified like every sign.
//!
//! Let receiver p see sample L through triangle (a, b, c). Where the ray meets it, the corners count as the determinants of the
//! edges opposite to them do ([`crate::exact`]): all have one sign, and their sum D is that of the triangle's own. With the corners at
//! `m_a, m_b, m_c` (integers, in 2^-16 texels from the texel the triangle counts from), the texel is `⌊N / (D·2^16)⌋`, where
//! `N = Σ w·m`. A hit on the border of two texels belongs to the upper one.
//!
//! # Error bound
//! Weights are linear over the grid; each is known to within Δ, the error of its three products and of their sum. N and D are sums of
//! three, so that N/D moves by at most `2·m·Δ'/(D − Δ')` with m the largest of the corners' and Δ' the sum of the three Δ, besides
//! eight roundoffs of the quotient's own. Where a border lies that near, the texel is found in integers: `N ≥ D·2^16·t` for the borders t
//! in question, magnitudes of at most 130 bits.

use glam::IVec3;

use crate::{
    doubt::{PairForms, PairIntegers},
    edge_plane::{LightGrid, ReceiverTile, cross_magnitudes, float},
    jitter::{Place, Samples},
    lanes::Lanes,
    occluder::Occluder,
    real::Real,
    statistics::Tally,
    texture::{TextureSize, TexturedTriangle},
    view::SPARE,
    wide::multiply,
};

/// What a corner counts, over the light's grid.
#[derive(Clone, Copy)]
struct Weight<R> {
    at_origin: R,
    per_row: R,
    per_column: R,
    doubt: f32,
}

impl<R: Real> Weight<R> {
    /// Of the corner opposite to the edge `from → to`.
    #[inline(always)]
    fn new(grid: &LightGrid, p: IVec3, from: IVec3, to: IVec3) -> Self {
        let (d, e, g) = (from - p, to - from, grid.light.origin - p);
        let normal = R::cross(d, e);
        let extent = float(grid.light.step_u).abs() * grid.light.last_column()
            + float(grid.light.step_v).abs() * grid.light.last_row();
        // Two products and sums more than a side has, relative to the same terms.
        let error = R::SIDE_ERROR * (1.5 * SPARE);
        Self {
            at_origin: R::dot(&normal, g),
            per_row: R::dot(&normal, grid.light.step_v),
            per_column: R::dot(&normal, grid.light.step_u),
            doubt: error * cross_magnitudes(float(d), float(e)).dot(float(g).abs() + extent),
        }
    }

    #[inline(always)]
    fn at(&self, place: &Place) -> R {
        let along = self.at_origin.plus(self.per_row, R::from_f32(place.row));
        along.plus(self.per_column, R::from_f32(place.column))
    }
}

/// A receiver and a textured triangle: where its light samples are seen.
pub(crate) struct TexelView<R> {
    texture: TextureSize,
    /// Its corners in the order of the planes.
    triangle: TexturedTriangle,
    /// Of corners a, b, c.
    weights: [Weight<R>; 3],
    /// Of all three together.
    doubt: f32,
    pair: PairIntegers,
    forms: PairForms,
}

impl<R: Real> TexelView<R> {
    /// Of a lane's receiver, and an occluder that lies in a texture as `triangle` tells.
    #[inline(always)]
    pub(crate) fn new<S: Samples>(
        grid: &LightGrid,
        receivers: &ReceiverTile,
        occluder: &Occluder,
        lane: usize,
        texture: TextureSize,
        triangle: TexturedTriangle,
    ) -> Self {
        let pair = PairIntegers::new::<S>(&grid.light, receivers, occluder, lane, false);
        let (p, [a, b, c]) = (pair.receiver, pair.corners);
        let weights = [Weight::new(grid, p, b, c), Weight::new(grid, p, c, a), Weight::new(grid, p, a, b)];
        let doubt = weights[0].doubt + weights[1].doubt + weights[2].doubt;
        let [x, x_a, x_b, x_c, y, y_a, y_b, y_c] = triangle;
        let triangle = if occluder.is_swapped() { [x, x_a, x_c, x_b, y, y_a, y_c, y_b] } else { triangle };
        Self { texture, triangle, weights, doubt, pair, forms: PairForms::NONE }
    }

    /// Texels that were found in integers.
    #[inline(always)]
    pub(crate) fn fallbacks(&self) -> Tally {
        self.pair.fallbacks
    }

    /// The place in the texture of the texel that a sample is seen through. The sample is one that the triangle blocks.
    #[inline(always)]
    pub(crate) fn texel(&mut self, place: &Place) -> u32 {
        if self.texture.is_one() {
            return 0;
        }
        let w = [self.weights[0].at(place), self.weights[1].at(place), self.weights[2].at(place)];
        let sum =
            R::from_f32(0.0).plus(w[0], R::from_f32(1.0)).plus(w[1], R::from_f32(1.0)).plus(w[2], R::from_f32(1.0));
        let [_, x_a, x_b, x_c, _, y_a, y_b, y_c] = self.triangle;
        let x = self.along([x_a, x_b, x_c], &w, sum, place);
        let y = self.along([y_a, y_b, y_c], &w, sum, place);
        self.texture.place(&self.triangle, [x, y])
    }

    /// Whole texels along one axis, of corners at `m`.
    #[inline(always)]
    fn along(&mut self, m: [u32; 3], w: &[R; 3], sum: R, place: &Place) -> u32 {
        let most = larger(m[0], larger(m[1], m[2]));
        let last = most >> 16;
        // All in one texel, as often in small triangles.
        if last == 0 {
            return 0;
        }
        let (texel, size) = (R::from_f32(1.0 / 65536.0), Lanes::abs(sum.to_f32()));
        let at = [of::<R>(m[0]), of::<R>(m[1]), of::<R>(m[2])];
        let scaled = R::from_f32(0.0).plus(w[0], at[0]).plus(w[1], at[1]).plus(w[2], at[2]);
        let known = size - self.doubt;
        let (mut from, mut to) = (0, last);
        if known > size * 0.5 {
            let x = R::from_f32(0.0).plus(scaled.over(sum), texel).to_f32();
            let most = most as f32 / 65536.0;
            let doubt = 2.0 * most * self.doubt / known + most * (8.0 * f32::EPSILON);
            from = within(Lanes::floor(Lanes::max(x - doubt, 0.0)), last);
            to = within(Lanes::floor(Lanes::max(x + doubt, 0.0)), last);
        }
        if from == to {
            return from;
        }
        self.pair.fallbacks += 1;
        texel_of(self.forms.weights(&self.pair, place), m, last)
    }
}

/// A whole number up to 2^32.
#[inline(always)]
fn of<R: Real>(m: u32) -> R {
    // Both halves are floats.
    R::from_f32((m & 0xffff) as f32).plus(R::from_f32((m >> 16) as f32), R::from_f32(65536.0))
}

#[inline(always)]
fn larger(a: u32, b: u32) -> u32 {
    if a > b { a } else { b }
}

#[inline(always)]
fn within(texel: i32, last: u32) -> u32 {
    if texel < 0 {
        0
    } else if (texel as u32) < last {
        texel as u32
    } else {
        last
    }
}

/// Five words, the least significant first.
type Sum = [u32; 5];

/// `sum + w·m`.
#[inline(always)]
fn plus(sum: Sum, w: [u32; 3], m: u32) -> Sum {
    let (w0, w1, w2) = (multiply(w[0], m), multiply(w[1], m), multiply(w[2], m));
    let (a, c0) = carried(sum[0], w0.0, 0);
    let (b, c1) = carried(sum[1], w1.0, w0.1);
    let (c, c2) = carried(sum[2], w2.0, w1.1);
    let (d, c3) = carried(sum[3], w2.1, 0);
    let (b, c1) = with_carry(b, c1, c0);
    let (c, c2) = with_carry(c, c2, c1);
    let (d, c3) = with_carry(d, c3, c2);
    [a, b, c, d, sum[4].wrapping_add(c3)]
}

/// The sum of three words, and what is carried.
#[inline(always)]
fn carried(a: u32, b: u32, c: u32) -> (u32, u32) {
    let ab = a.wrapping_add(b);
    let abc = ab.wrapping_add(c);
    (abc, (ab < a) as u32 + (abc < ab) as u32)
}

/// A word and its carry with what was carried before.
#[inline(always)]
fn with_carry(word: u32, carry: u32, before: u32) -> (u32, u32) {
    let sum = word.wrapping_add(before);
    (sum, carry + (sum < word) as u32)
}

#[inline(always)]
fn is_less(a: &Sum, b: &Sum) -> bool {
    // No loop: some drivers count rounds (`kernel::resolve`).
    let mut less = a[0] < b[0];
    less = a[1] < b[1] || (a[1] == b[1] && less);
    less = a[2] < b[2] || (a[2] == b[2] && less);
    less = a[3] < b[3] || (a[3] == b[3] && less);
    a[4] < b[4] || (a[4] == b[4] && less)
}

/// Two words of 32 bits as a float.
#[inline(always)]
fn joined(high: u32, low: u32) -> f32 {
    high as f32 * 4_294_967_296.0 + low as f32
}

/// The highest word that is not 0 and the one below it, as a float; and the place of the latter.
#[inline(always)]
fn leading(sum: &Sum) -> (f32, i32) {
    if sum[4] != 0 {
        (joined(sum[4], sum[3]), 3)
    } else if sum[3] != 0 {
        (joined(sum[3], sum[2]), 2)
    } else if sum[2] != 0 {
        (joined(sum[2], sum[1]), 1)
    } else {
        (joined(sum[1], sum[0]), 0)
    }
}

/// `2^(32·words)`, of quotients that are near 1 once multiplied with it.
#[inline(always)]
fn by_words(words: i32) -> f32 {
    if words >= 2 {
        1.844_674_4e19
    } else if words == 1 {
        4_294_967_296.0
    } else if words == 0 {
        1.0
    } else if words == -1 {
        1.0 / 4_294_967_296.0
    } else {
        0.0
    }
}

/// `⌊Σ w·m / (2^16·Σ w)⌋`, at most `last`.
///
/// Both sums are integers, and leading words lose but 2^-20 of them: below 2^16, the quotient is known to within a sixteenth. One
/// comparison with the nearest border tells the rest.
#[cfg_attr(not(target_arch = "spirv"), inline)]
#[cfg_attr(target_arch = "spirv", inline(never))]
fn texel_of(w: [[u32; 3]; 3], m: [u32; 3], last: u32) -> u32 {
    let at = plus(plus(plus([0; 5], w[0], m[0]), w[1], m[1]), w[2], m[2]);
    let whole = plus(plus(plus([0; 5], w[0], 1), w[1], 1), w[2], 1);
    let ((part, of_part), (all, of_all)) = (leading(&at), leading(&whole));
    let quotient = part / all * (1.0 / 65536.0) * by_words(of_part - of_all);
    let nearest = within(Lanes::floor(Lanes::min(quotient + 0.5, 65536.0)), last);
    let border = nearest << 16;
    let is_below = is_less(&at, &plus(plus(plus([0; 5], w[0], border), w[1], border), w[2], border));
    if is_below && nearest > 0 { nearest - 1 } else { nearest }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn value(sum: Sum) -> [u128; 2] {
        let low = u128::from(sum[0]) | u128::from(sum[1]) << 32 | u128::from(sum[2]) << 64 | u128::from(sum[3]) << 96;
        [low, u128::from(sum[4])]
    }

    #[test]
    fn sums_carry_through_all_words() {
        let most = [u32::MAX; 3];
        let sum = plus(plus([0; 5], most, u32::MAX), most, u32::MAX);
        let product = ((1_u128 << 96) - 1) * ((1 << 32) - 1);
        let (low, carry) = product.overflowing_add(product);
        assert_eq!(value(sum), [low, u128::from(carry)]);
        assert!(is_less(&[9, 0, 0, 0, 1], &[0, 0, 0, 0, 2]) && !is_less(&[1, 2, 3, 4, 5], &[1, 2, 3, 4, 5]));
    }

    #[test]
    fn borders_belong_to_the_upper_texel() {
        let w = |x: u32| [0, x, 0];
        for t in 0..9_u32 {
            // Half way between two corners.
            assert_eq!(texel_of([w(1), w(1), w(0)], [0, t << 17, 0], 20), t);
            let below = if t > 0 { (t << 17) - 2 } else { 0 };
            assert_eq!(texel_of([w(1), w(1), w(0)], [0, below, 0], 20), t.max(1) - 1);
        }
    }

    /// Of weights that 128 bits hold with their sums.
    fn expected(w: [u128; 3], m: [u32; 3]) -> u32 {
        let at: u128 = w.iter().zip(m).map(|(w, m)| w * u128::from(m)).sum();
        (at / (w.iter().sum::<u128>() << 16)) as u32
    }

    #[test]
    fn quotients_are_right_whatever_the_lengths_of_weights() {
        let mut random = 1_u64;
        let mut next = || {
            random = random.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (random >> 32) as u32
        };
        let mut borders = 0;
        for _ in 0..200_000 {
            let mut weight = || {
                let word = u128::from(next()) << 64 | u128::from(next()) << 32 | u128::from(next());
                (word % (1 << 93)) >> (next() % 93)
            };
            let w = [weight(), weight(), weight()];
            if w == [0; 3] {
                continue;
            }
            let mut m = [next(), next(), next()].map(|m| m >> (next() % 32));
            if next() % 2 == 0 {
                // All corners on borders, or beside them.
                m = m.map(|m| (m & 0xffff_0000).wrapping_add(next() % 3).wrapping_sub(1));
                borders += 1;
            }
            let words = w.map(|w| [w as u32, (w >> 32) as u32, (w >> 64) as u32]);
            let last = m[0].max(m[1]).max(m[2]) >> 16;
            assert_eq!(texel_of(words, m, last), expected(w, m), "{w:?} {m:?}");
        }
        assert!(borders > 1000);
    }
}
