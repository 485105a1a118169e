//! A pixel of an engine's G-buffer → a receiver on the lattice.
//!
//! A position that the engine stores is rounded to f32 by whoever made it; how far it may be off is the engine's to say
//! ([`crate::Lift`]). A depth is unprojected here, with a bound on its own error: the lift follows from it, pixel by pixel.

use glam::{IVec3, Vec3, Vec4};

use crate::{
    exact::{self, Wide},
    params::Dispatched,
    snap::{LIMIT, SnapParams, is_finite, snap_point},
    surface::{self, Lift, Upwards, by_normal},
};

/// What turns pixels into receivers.
#[derive(Clone, Copy, Debug, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct ViewParams {
    /// The lattice.
    pub snap: SnapParams,
    /// Pixels there are.
    pub count: u32,
    /// See [`crate::params::PassParams::row`].
    pub row: u32,
    /// Pixels of a row of the image.
    pub width: u32,
    /// Rows of the image.
    pub height: u32,
    /// First pixel.
    pub first: u32,
    /// The sample of multisampled textures that is taken.
    pub sample: u32,
    /// A [`NormalEncoding`].
    pub normals: u32,
    /// Steps by which stored positions are lifted.
    pub lift: i32,
    /// Depth of pixels without a surface.
    pub empty_depth: f32,
    /// Largest error of a depth, relative to it.
    pub depth_error: f32,
    /// Largest error of a depth, beside that.
    pub depth_quantum: f32,
    /// 2 / width
    pub pixel_width: f32,
    /// 2 / height
    pub pixel_height: f32,
    /// Where in a pixel its surface is seen: x and y, in 0..=1, downwards.
    pub place: [f32; 2],
    /// Largest error of that place, in pixels.
    pub place_error: f32,
    /// Triangles of the frame.
    pub triangles: u32,
    /// Columns of the inverse view-projection matrix: clip space, with x and y in −1..=1, y up, → world.
    pub unproject: [[f32; 4]; 4],
}

impl Dispatched for ViewParams {
    #[inline(always)]
    fn count(&self) -> u32 {
        self.count
    }

    #[inline(always)]
    fn row(&self) -> u32 {
        self.row
    }

    fn with_row(self, row: u32) -> Self {
        Self { row, ..self }
    }
}

/// How a G-buffer stores normals, world space. They need not have unit length.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[repr(u32)]
pub enum NormalEncoding {
    /// x, y, z in −1..=1, as they are.
    #[default]
    Signed,
    /// x, y, z in 0..=1: twice the texel, less one.
    Biased,
    /// Two components in −1..=1: the octahedron, unfolded onto a square.
    Octahedral,
}

/// A normal from its texel.
#[inline]
pub fn decode_normal(encoding: u32, texel: [f32; 4]) -> Vec3 {
    let [x, y, z, _] = texel;
    if encoding == NormalEncoding::Biased as u32 {
        return Vec3::new(2.0 * x - 1.0, 2.0 * y - 1.0, 2.0 * z - 1.0);
    }
    if encoding == NormalEncoding::Octahedral as u32 {
        let z = 1.0 - x.abs() - y.abs();
        if z >= 0.0 {
            return Vec3::new(x, y, z);
        }
        let folded = |a: f32, b: f32| if a >= 0.0 { 1.0 - b.abs() } else { b.abs() - 1.0 };
        return Vec3::new(folded(x, y), folded(y, x), z);
    }
    Vec3::new(x, y, z)
}

/// What a pixel is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Pixel {
    /// Nothing is seen through it.
    Empty,
    /// Its position or normal is NaN, infinite or outside the lattice.
    Refused,
    /// A receiver, lifted off its surface.
    Receiver(IVec3),
}

/// By the lattice normal of the triangle that the pixel shows, towards the side of the pixel's normal. A triangle without a
/// plane, or seen edge on, leaves it to the pixel's normal.
#[inline]
pub fn by_owner([a, b, c]: [IVec3; 3], normal: Vec3) -> Upwards {
    let own = exact::cross::<Wide>(b - a, c - a).components();
    let (axis, sign) = surface::dominant_axis(&own);
    let (e, f) = (b - a, c - a);
    let e = Vec3::new(e.x as f32, e.y as f32, e.z as f32);
    let f = Vec3::new(f.x as f32, f.y as f32, f.z as f32);
    let towards = e.cross(f).dot(normal);
    if sign == 0 || !is_finite(towards) || towards == 0.0 {
        return by_normal(normal);
    }
    Upwards { axis, sign: if towards > 0.0 { sign } else { -sign } }
}

/// A pixel with a stored world position; a fourth component of 0 says that there is no surface.
#[inline]
pub fn from_position(params: &ViewParams, position: [f32; 4], upwards: Upwards) -> Pixel {
    if position[3] == 0.0 {
        return Pixel::Empty;
    }
    let position = Vec3::new(position[0], position[1], position[2]);
    receiver(params, position, upwards, params.lift)
}

/// A pixel with a stored depth.
#[inline]
pub fn from_depth(params: &ViewParams, x: u32, y: u32, depth: f32, upwards: Upwards) -> Pixel {
    if depth == params.empty_depth {
        return Pixel::Empty;
    }
    let (position, error) = unproject(params, x, y, depth);
    // In lattice units.
    let error = error * params.snap.scale;
    if !is_finite(error) || error >= MAX_ERROR {
        return Pixel::Refused;
    }
    receiver(params, position, upwards, Lift::off_by(error).steps())
}

/// Largest error of a position for which a receiver is still a point of the lattice, lattice units.
const MAX_ERROR: f32 = (LIMIT / 8) as f32;

fn receiver(params: &ViewParams, position: Vec3, Upwards { axis, sign }: Upwards, lift: i32) -> Pixel {
    match snap_point(&params.snap, position) {
        Some(point) if sign != 0 => {
            let p = surface::lift(point, axis, sign * lift);
            let inside = |c: i32| c > -LIMIT && c < LIMIT;
            if inside(p.x) && inside(p.y) && inside(p.z) { Pixel::Receiver(p) } else { Pixel::Refused }
        }
        _ => Pixel::Refused,
    }
}

/// World position of a pixel at a depth, and a bound on the error of each of its coordinates.
///
/// Let `E` be the error of a homogeneous coordinate `v`, and `p = v/w`. Then `|δp| ≤ (E + |p|·E_w) / (|w| − E_w)`, and the
/// division adds its own rounding. `E` counts 8 roundings against the sum over absolute values (products, sums and the
/// matrix' own), 4 of the pixel's place, what the depth was rounded by, and how far from its place the rasteriser took it:
/// vertices are moved to a grid finer than pixels, and a triangle's inside moves no further than they do.
#[inline]
pub fn unproject(params: &ViewParams, x: u32, y: u32, depth: f32) -> (Vec3, f32) {
    const EPSILON: f32 = f32::EPSILON;
    let [x, y] = [x as f32 + params.place[0], y as f32 + params.place[1]];
    let place = [x * params.pixel_width - 1.0, 1.0 - y * params.pixel_height];
    let moved = [params.place_error * params.pixel_width, params.place_error * params.pixel_height];
    let depth_error = depth.abs() * params.depth_error + params.depth_quantum;
    let [a, b, c, d] = params.unproject;
    let row = |r: usize| {
        let terms = Vec4::new(a[r] * place[0], b[r] * place[1], c[r] * depth, d[r]);
        let sum = terms.x.abs() + terms.y.abs() + terms.z.abs() + terms.w.abs();
        let (a, b) = (a[r].abs(), b[r].abs());
        let error = EPSILON * (8.0 * sum + 4.0 * (a + b)) + (a * moved[0] + b * moved[1]) + c[r].abs() * depth_error;
        (terms.x + terms.y + terms.z + terms.w, error)
    };
    let ((x, ex), (y, ey), (z, ez), (w, ew)) = (row(0), row(1), row(2), row(3));
    let rest = w.abs() - ew;
    let p = Vec3::new(x / w, y / w, z / w);
    let off = |p: f32, e: f32| {
        let p = p.abs();
        (e + p * ew) / rest + 4.0 * EPSILON * p
    };
    let (ex, ey, ez) = (off(p.x, ex), off(p.y, ey), off(p.z, ez));
    let largest = if ex > ey { ex } else { ey };
    let largest = if ez > largest { ez } else { largest };
    // A little more for the arithmetic of the bound; where w may be 0, or nearly, there is no point.
    if rest > 0.01 * w.abs() { (p, 1.001 * largest) } else { (p, f32::MAX) }
}
