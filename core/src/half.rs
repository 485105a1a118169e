//! Half resolution: one receiver for two by two pixels, and the way back. The shadows of the others are not exact: they are
//! a mean of their neighbours', by how near those lie in the image and on the lattice.

use glam::{IVec3, Vec3};

/// Pixels of a side, halved.
#[inline(always)]
pub const fn halved(side: u32) -> u32 {
    side.div_ceil(2)
}

/// Pixel `k` of the block that stands for half pixel `half`; `None` beyond the image's edge.
#[inline(always)]
pub fn pixel_of(half: [u32; 2], k: u32, [width, height]: [u32; 2]) -> Option<u32> {
    let (x, y) = (2 * half[0] + (k & 1), 2 * half[1] + (k >> 1));
    if x < width && y < height { Some(y * width + x) } else { None }
}

/// A neighbour among the half pixels, and its weight by place: 9, 3, 3, 1. `None` beyond the image's edge.
#[inline(always)]
pub fn neighbour([x, y]: [u32; 2], k: u32, [width, height]: [u32; 2]) -> Option<(u32, f32)> {
    let along = |p: u32, far: bool| {
        let near = p / 2;
        if !far {
            near
        } else if p & 1 == 0 {
            near.wrapping_sub(1)
        } else {
            near + 1
        }
    };
    let (far_x, far_y) = (k & 1 == 1, k >> 1 == 1);
    let (hx, hy) = (along(x, far_x), along(y, far_y));
    let weight = (if far_x { 1.0 } else { 3.0 }) * (if far_y { 1.0 } else { 3.0 });
    if hx < halved(width) && hy < halved(height) { Some((hy * halved(width) + hx, weight)) } else { None }
}

/// Square of a distance on the lattice, plus one: never 0.
#[inline(always)]
pub fn distance(a: IVec3, b: IVec3) -> f32 {
    let d = a - b;
    let d = Vec3::new(d.x as f32, d.y as f32, d.z as f32);
    d.x * d.x + d.y * d.y + d.z * d.z + 1.0
}
