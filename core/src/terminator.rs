//! The shadow terminator of coarse meshes. Where a mesh stands for a smooth surface, its vertex normals say that a receiver is lit
//! which its flat triangles put in shadow, rightly: masks are of the mesh. Either shading follows the mesh, or receivers leave it.
//!
//! **Coherent shading** (Sintorn, Eisemann and Assarsson 2008, section 4.3 and figure 8): at each vertex the least cosine of the
//! adjacent faces, `l_bend = min n_f·l`, is interpolated over triangles; where it is not above 0 a receiver is black, and near
//! that, its shading is blended into it: `α·phong + (1 − α)·max(l_bend, 0)`, `α = min(1, max(c·l_bend, 0))`. All corners of a
//! triangle that faces away have an l_bend of at most 0, so that it is black; and what is interpolated is the same on both sides of an
//! edge. For a light with an area, l points to its middle, or the least over its corners is taken.
//!
//! **Lifted receivers** (the tangent planes of Hanika, "Hacking the shadow terminator", Ray Tracing Gems II, chapter 4): a receiver
//! is moved off its triangle, on to the surface that the vertex normals imply, before it is snapped. Its mask is exact, of the point
//! that it was moved to; what it must not meet on its way is its own triangle, and where that is convex it does not.

use glam::Vec3;

/// `c` of the paper, which found that it works well: shading is Phong's where `l_bend` is at least 1/3.
pub const SHARPNESS: f32 = 3.0;

/// The least cosine at a vertex, so far `least`, with one more face. `to_light` and `face_normal` have length 1.
#[inline(always)]
pub fn least_cosine(least: f32, to_light: Vec3, face_normal: Vec3) -> f32 {
    let cosine = dot(to_light, face_normal);
    if cosine < least { cosine } else { least }
}

/// A value of the corners at a place in the triangle, by its barycentric coordinates.
#[inline(always)]
pub fn interpolated(corners: [f32; 3], barycentric: [f32; 3]) -> f32 {
    barycentric[0] * corners[0] + barycentric[1] * corners[1] + barycentric[2] * corners[2]
}

/// Coherent shading: of the interpolated least cosine, and what else would be shown, from 0 to 1. `sharpness`: above 0, see
/// [`SHARPNESS`].
#[inline(always)]
pub fn coherent(bend: f32, phong: f32, sharpness: f32) -> f32 {
    if bend > 0.0 {
        let steep = sharpness * bend;
        let share = if steep < 1.0 { steep } else { 1.0 };
        share * phong + (1.0 - share) * bend
    } else {
        0.0
    }
}

/// Where a receiver is moved to: `p + Σ bᵢ·max(0, (vᵢ − p)·nᵢ)·nᵢ`. `corners` of its triangle, their `normals` of length 1,
/// `barycentric` its place in it. Never moved inwards: where the surface is hollow it stays.
#[inline(always)]
pub fn lifted(corners: [Vec3; 3], normals: [Vec3; 3], barycentric: [f32; 3]) -> Vec3 {
    let p = corners[0] * barycentric[0] + corners[1] * barycentric[1] + corners[2] * barycentric[2];
    let (mut up, mut k) = (Vec3::ZERO, 0);
    while k < 3 {
        let height = dot(corners[k] - p, normals[k]);
        if height > 0.0 {
            up += normals[k] * (barycentric[k] * height);
        }
        k += 1;
    }
    p + up
}

#[inline(always)]
fn dot(a: Vec3, b: Vec3) -> f32 {
    a.x * b.x + a.y * b.y + a.z * b.z
}
