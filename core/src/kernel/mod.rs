//! Kernels: what one thread of a GPU does for one id of a stage. Each fetches, calls the stage, and stores; a stage that
//! is no single function (sorting) has several. [`TABLE`] says what each is bound to.
//!
//! They are plain functions over slices, so that a processor runs them as well, one id after the other.

// A kernel's arguments are its bindings.
#![allow(clippy::too_many_arguments)]

pub mod accumulate;
pub mod build_level;
pub mod casters;
#[cfg(not(target_arch = "spirv"))]
pub mod dispatch;
pub mod face_pixels;
pub mod half;
pub mod illuminate;
pub mod key_receivers;
pub mod key_triangles;
pub mod light_params;
pub mod order_cloud;
pub mod order_triangles;
pub mod pack;
pub mod pack_light;
pub mod probe;
pub mod reduce;
pub mod resolve;
pub mod resolve_cloud;
pub mod resolve_cloud_by_table;
pub mod resolve_punctual;
pub mod settle_receivers;
pub mod snap_receivers;
pub mod snap_vertices;
pub mod sort;
pub mod status;
mod table;
pub mod triangles;
pub mod weigh;
pub mod weigh_tinted;

use crate::params::Dispatched;

pub use table::{Access, Bound, Kernel, KernelInfo, ParamsKind, Slot, TABLE, WORKGROUP};

/// Element `index`, or `absent` where there is none.
#[inline(always)]
pub fn fetch<T: Copy>(from: &[T], index: usize, absent: T) -> T {
    if index < from.len() { from[index] } else { absent }
}

/// Writes element `index`, if there is one.
#[inline(always)]
pub fn store<T: Copy>(to: &mut [T], index: usize, value: T) {
    if index < to.len() {
        to[index] = value;
    }
}

/// A point that takes no part: not snapped, or not there. No lattice point has such a coordinate.
pub const NOWHERE: [i32; 3] = [i32::MIN; 3];

/// A lattice point; `None` where there is none.
#[inline(always)]
pub fn point(from: &[[i32; 3]], index: usize) -> Option<glam::IVec3> {
    let p = fetch(from, index, NOWHERE);
    if p[0] == i32::MIN { None } else { Some(glam::IVec3::new(p[0], p[1], p[2])) }
}

/// The id of a thread: workgroups of a dispatch are laid out in rows, since a row is limited.
#[inline(always)]
pub fn id<P: Dispatched>(thread: [u32; 3], params: &P) -> usize {
    thread[1].wrapping_mul(params.row()).wrapping_add(thread[0]) as usize
}
