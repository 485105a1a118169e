//! Kernel `probe`: one integer helper of this crate, alone. No stage runs it; tests hold it against the same on a host.

use crate::{
    kernel::{fetch, store},
    mask_word::{MaskWord, PairWord},
    params::Params,
    wide::{Limbs, WideInt},
};

/// Words that a probe reads.
pub const IN: usize = 8;
/// Words that a probe writes.
pub const OUT: usize = 8;

/// What is probed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[repr(u32)]
pub enum Helper {
    /// [`WideInt::product`] of words 0 and 1.
    Product,
    /// [`WideInt::area`] of words 0 to 3.
    Area,
    /// Limbs in words 0 to 2: [`WideInt::times`] word 3.
    Times,
    /// Limbs in words 0 to 2, and 3 to 5: [`WideInt::plus`].
    Plus,
    /// The same: [`WideInt::minus`].
    Minus,
    /// Limbs in words 0 to 2: [`WideInt::sign`].
    Sign,
    /// A word in word 0 and columns in words 2 and 3: all operations of [`MaskWord`] for u32.
    Word,
    /// The same for [`PairWord`], in words 0 and 1.
    Pair,
}

impl Helper {
    /// All of them.
    pub const ALL: [Self; 8] =
        [Self::Product, Self::Area, Self::Times, Self::Plus, Self::Minus, Self::Sign, Self::Word, Self::Pair];
}

/// What the helper with number `helper` makes of eight words.
#[inline(always)]
pub fn probed(helper: u32, w: [u32; IN]) -> [u32; OUT] {
    let (a, b) = (Limbs::from_words([w[0], w[1], w[2]]), Limbs::from_words([w[3], w[4], w[5]]));
    let wide = |x: Limbs| {
        let [low, mid, high] = x.words();
        [low, mid, high, 0, 0, 0, 0, 0]
    };
    if helper == Helper::Product as u32 {
        wide(Limbs::product(w[0] as i32, w[1] as i32))
    } else if helper == Helper::Area as u32 {
        wide(Limbs::area(w[0] as i32, w[1] as i32, w[2] as i32, w[3] as i32))
    } else if helper == Helper::Times as u32 {
        wide(a.times(w[3] as i32))
    } else if helper == Helper::Plus as u32 {
        wide(a.plus(b))
    } else if helper == Helper::Minus as u32 {
        wide(a.minus(b))
    } else if helper == Helper::Sign as u32 {
        [a.sign() as u32, 0, 0, 0, 0, 0, 0, 0]
    } else if helper == Helper::Word as u32 {
        word(w[0], w[2], w[3], |x| [x, 0])
    } else {
        word(PairWord { low: w[0], high: w[1] }, w[2], w[3], |x| [x.low, x.high])
    }
}

/// `start` and `end` in `0..=BITS`.
#[inline(always)]
fn word<W: MaskWord>(word: W, start: u32, end: u32, halves: impl Fn(W) -> [u32; 2]) -> [u32; OUT] {
    let span = W::span(start, end);
    let ([a, b], [c, d]) = (halves(span), halves(word.without(span)));
    let [e, f] = halves(word.and(span).or(W::below(start)));
    let bit = if start < W::BITS { word.bit(start) as u32 } else { 2 };
    [a, b, c, d, e, f, word.count() | bit << 8, word.lowest()]
}

/// Probe `id`: its words go in, and come out.
#[inline(always)]
pub fn probe(id: usize, params: &Params, words: &[[u32; IN]], out: &mut [[u32; OUT]]) {
    let pass = params.pass();
    if id >= pass.count as usize {
        return;
    }
    store(out, id, probed(pass.shift, fetch(words, id, [0; IN])));
}
