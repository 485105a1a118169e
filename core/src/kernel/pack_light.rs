//! Kernel `pack_light`: sums of the weights of lit samples → an image, in words of 32 bits: as parts of what a light gives all of
//! whose samples emit `emission::WHOLE`. Divided in integers: the same bits everywhere.

use crate::{
    kernel::{fetch, pack, store},
    params::Params,
    ratio,
};

/// Channels of a pixel: red, green, blue, and an alpha of 1.
pub const CHANNELS: u32 = 4;

/// The most that a channel's sum can be, for a light of so many samples.
#[cfg(not(target_arch = "spirv"))]
pub const fn whole(samples: u32) -> u32 {
    samples * crate::emission::WHOLE as u32
}

/// Bits of a channel of `sum / whole`: a half float where `texels`, the channels that a word holds, is 2, else a float.
#[inline(always)]
pub fn channel_bits(sum: u32, whole: u32, texels: u32) -> u32 {
    if texels == 2 { ratio::float16(sum, whole) } else { ratio::float32(sum, whole) }
}

/// Word `id` of the image, rows one after the other; a row takes `pitch` words, of `texels` channels each. `elements` is the
/// sum that becomes 1.
#[inline(always)]
pub fn pack_light(id: usize, params: &Params, light: &[[u32; 3]], image: &mut [u32]) {
    let pass = params.pass();
    let Some([y, column]) = pack::place(id, &pass) else { return };
    let bits = 32 / pass.texels;
    let (mut word, mut k) = (0, 0);
    while k < pass.texels {
        let place = column * pass.texels + k;
        let (x, channel) = (place / CHANNELS, place % CHANNELS);
        if x < pass.width {
            let sums = fetch(light, (y * pass.width + x) as usize, [0; 3]);
            let sum = match channel {
                0 => sums[0],
                1 => sums[1],
                2 => sums[2],
                _ => pass.elements,
            };
            word |= channel_bits(sum, pass.elements, pass.texels) << (k * bits);
        }
        k += 1;
    }
    store(image, id, word);
}

// What the division takes.
#[cfg(not(target_arch = "spirv"))]
const _: () = assert!(whole(crate::light::MAX_SAMPLES * crate::light::MAX_SAMPLES) < ratio::MOST_FLOAT);
