//! Kernels of half resolution.

use crate::{
    gbuffer::ViewParams,
    half::{distance, halved, neighbour, pixel_of},
    kernel::{NOWHERE, fetch, point, store},
};

/// The receiver of half pixel `id`: the first of its pixels that has one.
#[inline(always)]
pub fn thin(id: usize, params: &ViewParams, receivers: &[[i32; 3]], thinned: &mut [[i32; 3]]) {
    if id >= params.count as usize {
        return;
    }
    let mut found = NOWHERE;
    if let Some(pixel) = standing(id, params, receivers) {
        found = fetch(receivers, pixel as usize, NOWHERE);
    }
    store(thinned, id, found);
}

/// The first of half pixel `id`'s pixels that has a receiver; `None` where none has one, or the image is empty.
#[inline(always)]
pub(super) fn standing(id: usize, params: &ViewParams, receivers: &[[i32; 3]]) -> Option<u32> {
    let width = halved(params.width);
    if width == 0 {
        return None;
    }
    let half = [id as u32 % width, id as u32 / width];
    let (mut found, mut k) = (None, 4);
    while k > 0 {
        k -= 1;
        if let Some(pixel) = pixel_of(half, k, [params.width, params.height])
            && fetch(receivers, pixel as usize, NOWHERE)[0] != i32::MIN
        {
            found = Some(pixel);
        }
    }
    found
}

/// Lit samples of pixel `id`, or sums of their weights, a channel each: the mean of its neighbours', each weighted by its place
/// in the image and by how near it lies to the pixel's receiver, the nearest of them counting in full. A pixel that stands for
/// its block keeps its own.
#[inline(always)]
pub fn upsample<const CHANNELS: usize>(
    id: usize,
    params: &ViewParams,
    receivers: &[[i32; 3]],
    thinned: &[[i32; 3]],
    lit: &[[u32; CHANNELS]],
    upsampled: &mut [[u32; CHANNELS]],
) {
    if id >= params.count as usize || params.width == 0 {
        return;
    }
    let pixel = [id as u32 % params.width, id as u32 / params.width];
    let none = [0; CHANNELS];
    let mut mean = none;
    if let Some(own) = point(receivers, id) {
        // Its own block first: where that is its own receiver, nothing is interpolated.
        if let Some((half, _)) = neighbour(pixel, 0, [params.width, params.height])
            && point(thinned, half as usize) == Some(own)
        {
            store(upsampled, id, fetch(lit, half as usize, none));
            return;
        }
        let (mut nearest, mut k) = (f32::MAX, 0);
        while k < 4 {
            if let Some((half, _)) = neighbour(pixel, k, [params.width, params.height])
                && let Some(other) = point(thinned, half as usize)
            {
                let d = distance(own, other);
                nearest = if d < nearest { d } else { nearest };
            }
            k += 1;
        }
        let (mut sum, mut weights, mut k) = ([0.0; CHANNELS], 0.0, 0);
        let (mut least, mut most) = ([u32::MAX; CHANNELS], none);
        while k < 4 {
            if let Some((half, place)) = neighbour(pixel, k, [params.width, params.height])
                && let Some(other) = point(thinned, half as usize)
            {
                let closeness = nearest / distance(own, other);
                let weight = place * closeness * closeness;
                let value = fetch(lit, half as usize, none);
                let mut c = 0;
                while c < CHANNELS {
                    sum[c] += weight * value[c] as f32;
                    least[c] = if value[c] < least[c] { value[c] } else { least[c] };
                    most[c] = if value[c] > most[c] { value[c] } else { most[c] };
                    c += 1;
                }
                weights += weight;
            }
            k += 1;
        }
        if weights > 0.0 {
            let mut c = 0;
            while c < CHANNELS {
                // Sums of weights have more digits than a float: what all neighbours have stays what it is.
                let rounded = (sum[c] / weights + 0.5) as u32;
                mean[c] = if rounded < least[c] {
                    least[c]
                } else if rounded > most[c] {
                    most[c]
                } else {
                    rounded
                };
                c += 1;
            }
        }
    }
    store(upsampled, id, mean);
}
