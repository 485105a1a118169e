//! Kernels of half resolution.

use crate::{
    gbuffer::ViewParams,
    half::{distance, halved, neighbour, pixel_of},
    kernel::{NOWHERE, fetch, point, store},
};

/// The receiver of half pixel `id`: the first of its pixels that has one.
#[inline(always)]
pub fn thin(id: usize, params: &ViewParams, receivers: &[[i32; 3]], thinned: &mut [[i32; 3]]) {
    let width = halved(params.width);
    if id >= params.count as usize || width == 0 {
        return;
    }
    let half = [id as u32 % width, id as u32 / width];
    let mut found = NOWHERE;
    let mut k = 4;
    while k > 0 {
        k -= 1;
        if let Some(pixel) = pixel_of(half, k, [params.width, params.height]) {
            let own = fetch(receivers, pixel as usize, NOWHERE);
            found = if own[0] == i32::MIN { found } else { own };
        }
    }
    store(thinned, id, found);
}

/// The lit samples of pixel `id`: the mean of its neighbours', each weighted by its place in the image and by how near it lies
/// to the pixel's receiver, the nearest of them counting in full. A pixel that stands for its block keeps its own.
#[inline(always)]
pub fn upsample(
    id: usize,
    params: &ViewParams,
    receivers: &[[i32; 3]],
    thinned: &[[i32; 3]],
    lit: &[u32],
    upsampled: &mut [u32],
) {
    if id >= params.count as usize || params.width == 0 {
        return;
    }
    let pixel = [id as u32 % params.width, id as u32 / params.width];
    let mut mean = 0;
    if let Some(own) = point(receivers, id) {
        // Its own block first: where that is its own receiver, nothing is interpolated.
        if let Some((half, _)) = neighbour(pixel, 0, [params.width, params.height])
            && point(thinned, half as usize) == Some(own)
        {
            store(upsampled, id, fetch(lit, half as usize, 0));
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
        let (mut sum, mut weights, mut k) = (0.0, 0.0, 0);
        while k < 4 {
            if let Some((half, place)) = neighbour(pixel, k, [params.width, params.height])
                && let Some(other) = point(thinned, half as usize)
            {
                let closeness = nearest / distance(own, other);
                let weight = place * closeness * closeness;
                sum += weight * fetch(lit, half as usize, 0) as f32;
                weights += weight;
            }
            k += 1;
        }
        if weights > 0.0 {
            mean = (sum / weights + 0.5) as u32;
        }
    }
    store(upsampled, id, mean);
}
