//! A small fast generator (SplitMix64), so that a scene is the same on every machine and with every library version.

use umbra4_core::glam::IVec3;

/// A deterministic stream of numbers.
#[derive(Clone, Debug)]
pub struct Rng(u64);

impl Rng {
    /// The stream of `seed`.
    pub fn new(seed: u64) -> Self {
        Self(seed)
    }

    /// The stream of a seed and a name: tests that differ in name see different scenes.
    pub fn named(seed: u64, name: &str) -> Self {
        // FNV-1a.
        let hash =
            name.bytes().fold(0xcbf2_9ce4_8422_2325_u64, |h, b| (h ^ u64::from(b)).wrapping_mul(0x100_0000_01b3));
        Self(seed ^ hash)
    }

    /// 64 random bits.
    pub fn next_u64(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// An index below `n`; `n` > 0.
    pub fn below(&mut self, n: usize) -> usize {
        ((u128::from(self.next_u64()) * n as u128) >> 64) as usize
    }

    /// An integer in `-extent..=extent`; `extent` ≥ 0.
    pub fn around(&mut self, extent: i32) -> i32 {
        (self.below(2 * extent as usize + 1) as i64 - i64::from(extent)) as i32
    }

    /// A point in the cube `-extent..=extent`.
    pub fn point(&mut self, extent: i32) -> IVec3 {
        IVec3::new(self.around(extent), self.around(extent), self.around(extent))
    }

    /// True once in `n` times.
    pub fn one_in(&mut self, n: usize) -> bool {
        self.below(n) == 0
    }

    /// One of `choices`, which are not empty.
    pub fn pick<T: Copy>(&mut self, choices: &[T]) -> T {
        choices[self.below(choices.len())]
    }

    /// A float in `0.0..1.0`.
    pub fn unit(&mut self) -> f64 {
        (self.next_u64() >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// A float in `-extent..extent`.
    pub fn real(&mut self, extent: f64) -> f64 {
        (self.unit() * 2.0 - 1.0) * extent
    }
}
