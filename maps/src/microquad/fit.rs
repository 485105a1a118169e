//! Where the map looks: as narrow as the receivers and what may stand before them allow. On the host, in f64.
//!
//! What blocks a receiver at tangent `s` lies, at depth `z` from the light's plane, within `s·z` and the light's own rectangle. So the map reaches from
//! the least tangent to the greatest, and beyond by the light's half-width over the depth of the nearest occluder; and the nearest is the least
//! depth of all triangles, cut to that region.

use umbra4_core::{
    LatticeLight,
    glam::{DVec3, IVec3, IVec4, UVec4, Vec4},
    jitter::PLACES,
};

use crate::{
    microquad::{
        options::{Footprint, HalfSpaces, MicroOccluders, MicroquadOptions},
        params::{MicroquadParams, PATCHES, QUADS, TRIS},
    },
    shadow_map::MapFrame,
};

/// Column and row of samples at the middle of a light's rectangle, from sample (0, 0), or from the first place of its cell.
pub(crate) fn middle(light: &LatticeLight) -> [f64; 2] {
    let places = if light.jitter.is_some() { f64::from(PLACES) } else { 1.0 };
    // The first place is the middle of the first of its cell's.
    [light.columns, light.rows].map(|count| f64::from(count) * 0.5 - 0.5 / places)
}

/// The light's frame: `x` and `y` in its steps from its centre, `z` in lattice units before it.
#[derive(Clone, Copy, Debug)]
pub struct LightAxes {
    center: IVec3,
    /// Duals of both steps, and the normal.
    axes: [DVec3; 3],
    /// Where the centre is, in columns and rows of samples.
    place: [f64; 2],
    /// Half the light, in steps.
    half: [f64; 2],
    /// Lengths of both steps, lattice units.
    steps: [f64; 2],
}

impl LightAxes {
    /// That of a light.
    pub fn new(light: &LatticeLight) -> Self {
        let (u, v) = (light.step_u.as_dvec3(), light.step_v.as_dvec3());
        let normal = u.cross(v).normalize_or_zero();
        let (across, along) = (v.cross(normal), normal.cross(u));
        let duals = [across / u.dot(across), along / v.dot(along)];
        let middle = middle(light);
        let center = (light.origin.as_dvec3() + u * middle[0] + v * middle[1]).round().as_ivec3();
        let off = (center - light.origin).as_dvec3();
        Self {
            center,
            axes: [duals[0], duals[1], normal],
            place: duals.map(|dual| dual.dot(off)),
            half: [f64::from(light.columns) * 0.5, f64::from(light.rows) * 0.5],
            steps: [u.length(), v.length()],
        }
    }

    /// Where a lattice point lies.
    pub fn place(&self, p: IVec3) -> DVec3 {
        let off = (p - self.center).as_dvec3();
        DVec3::from_array(self.axes.map(|axis| axis.dot(off)))
    }

    /// The longer edge of the light, lattice units.
    fn longer_edge(&self) -> f64 {
        (self.half[0] * self.steps[0]).max(self.half[1] * self.steps[1]) * 2.0
    }
}

/// Which tangents receivers are seen at, in steps per lattice unit. Those of many threads can be joined.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tangents {
    low: [f64; 2],
    high: [f64; 2],
    /// Receivers before the light that lie further to a side than the map may reach: they see all of the light.
    pub beyond: u64,
}

impl Tangents {
    /// Of no receiver.
    pub const NONE: Self = Self { low: [f64::INFINITY; 2], high: [f64::NEG_INFINITY; 2], beyond: 0 };

    /// With a receiver at `p`; `widest` as in the options.
    #[must_use]
    pub fn with(mut self, axes: &LightAxes, widest: f32, p: IVec3) -> Self {
        let at = axes.place(p);
        if at.z > 0.0 {
            let tangents = [at.x / at.z, at.y / at.z];
            let most = axes.steps.map(|step| f64::from(widest) / step);
            if tangents[0].abs() > most[0] || tangents[1].abs() > most[1] {
                self.beyond += 1;
                return self;
            }
            for (axis, tangent) in tangents.into_iter().enumerate() {
                self.low[axis] = self.low[axis].min(tangent);
                self.high[axis] = self.high[axis].max(tangent);
            }
        }
        self
    }

    /// Of both.
    #[must_use]
    pub fn union(mut self, other: Self) -> Self {
        for axis in 0..2 {
            self.low[axis] = self.low[axis].min(other.low[axis]);
            self.high[axis] = self.high[axis].max(other.high[axis]);
        }
        self.beyond += other.beyond;
        self
    }

    /// Whether no receiver can be shadowed.
    pub fn is_empty(&self) -> bool {
        self.low[0] > self.high[0]
    }

    /// The least depth, lattice units, at which a triangle reaches into the region in which it may block a receiver; infinite where it does not.
    pub fn nearest(&self, axes: &LightAxes, corners: [IVec3; 3]) -> f64 {
        let corners = corners.map(|p| axes.place(p));
        if self.is_empty() {
            return f64::INFINITY;
        }
        // Not negative inside.
        let plane = |k: usize, p: DVec3| {
            let (axis, xy) = (k / 2 % 2, [p.x, p.y]);
            match k {
                0 | 2 => xy[axis] - self.low[axis] * p.z + axes.half[axis],
                1 | 3 => self.high[axis] * p.z + axes.half[axis] - xy[axis],
                _ => p.z,
            }
        };
        const PLANES: usize = 5;
        let mut polygon = [DVec3::ZERO; 3 + PLANES];
        polygon[..3].copy_from_slice(&corners);
        let mut count = 3;
        for k in 0..PLANES {
            let (mut cut, mut kept) = ([DVec3::ZERO; 3 + PLANES], 0);
            for i in 0..count {
                let corner = |i: usize| polygon.get(i).copied().unwrap_or_default();
                let (p, q) = (corner(i), corner(if i + 1 < count { i + 1 } else { 0 }));
                let (at_p, at_q) = (plane(k, p), plane(k, q));
                let mut keep = |point: DVec3| {
                    // A convex polygon gains one corner a plane, but for rounding.
                    if let Some(place) = cut.get_mut(kept) {
                        *place = point;
                        kept += 1;
                    }
                };
                if at_p >= 0.0 {
                    keep(p);
                }
                if (at_p >= 0.0) != (at_q >= 0.0) {
                    keep(p + (q - p) * (at_p / (at_p - at_q)));
                }
            }
            (polygon, count) = (cut, kept);
        }
        polygon.iter().take(count).fold(f64::INFINITY, |least, p| least.min(p.z))
    }
}

/// Where the map looks for all receivers and the corners of all triangles, one after the other: what kernels are told, and how many receivers lie
/// beyond it ([`Tangents::beyond`]).
pub fn fitted(
    options: &MicroquadOptions,
    light: &LatticeLight,
    receivers: impl Iterator<Item = IVec3>,
    triangles: impl Iterator<Item = [IVec3; 3]>,
) -> (MicroquadParams, u64) {
    let axes = LightAxes::new(light);
    let tangents = receivers.fold(Tangents::NONE, |tangents, p| tangents.with(&axes, options.map.widest, p));
    let nearest = triangles.fold(f64::INFINITY, |least, corners| tangents.nearest(&axes, corners).min(least));
    (params(options, light, &tangents, nearest), tangents.beyond)
}

/// What kernels are told of a light and its map. `nearest` is the least of [`Tangents::nearest`].
pub fn params(options: &MicroquadOptions, light: &LatticeLight, tangents: &Tangents, nearest: f64) -> MicroquadParams {
    let axes = LightAxes::new(light);
    let map = &options.map;
    let least = f64::from(map.near) * axes.longer_edge();
    // A little before the nearest occluder, so that rounding leaves it on the map.
    let near = if nearest.is_finite() { (nearest * 0.999).max(least) } else { least };
    let (low, high) = if tangents.is_empty() { ([0.0; 2], [0.0; 2]) } else { (tangents.low, tangents.high) };
    let size = f64::from(map.size);
    // Tangents in steps per near distance; a texel is left free at each end.
    let spans = [0, 1].map(|axis| {
        let (from, to) = (low[axis] * near - axes.half[axis], high[axis] * near + axes.half[axis]);
        let texels = (size - 2.0) / (to - from);
        (texels, 1.0 - from * texels)
    });
    let homogeneous = |axis: usize| {
        let (texels, first) = spans[axis];
        (axes.axes[axis] * texels + axes.axes[2] * (first / near)).as_vec3().extend(texels as f32)
    };
    let frame = MapFrame {
        center: axes.center.extend(map.size as i32),
        across: homogeneous(0),
        down: homogeneous(1),
        toward: (axes.axes[2] / near).as_vec3().extend(map.slope_bias),
    };
    let [x, y] = axes.place;
    let half = axes.half;
    let middle = middle(light);
    let off = [middle[0] - x, middle[1] - y];
    let HalfSpaces { directions, distances } = match options.footprint {
        Footprint::Table(half_spaces) => half_spaces,
        _ => HalfSpaces { directions: 0, distances: 0 },
    };
    let kind = match options.occluders {
        MicroOccluders::Micropatches => PATCHES,
        MicroOccluders::Microquads => QUADS,
        MicroOccluders::Microtris => TRIS,
    };
    let vector = |v: [f64; 4]| Vec4::from_array(v.map(|x| x as f32));
    MicroquadParams {
        pass: UVec4::ZERO,
        // All tiles, where it is no kernel that goes through them.
        part: UVec4::new(0, 0, 0, u32::MAX),
        counts: UVec4::new(light.rows, light.columns, kind, directions),
        table: UVec4::new(distances, if light.columns > 32 { 2 } else { 1 }, 0, 0),
        frame,
        light: vector([off[0] - half[0], off[1] - half[1], off[0] + half[0], off[1] + half[1]]),
        samples: vector([x, y, 1.0 / spans[0].0, 1.0 / spans[1].0]),
        grid: vector([middle[0], middle[1], 1.0 / half[0], 1.0 / half[1]]),
        bias: Vec4::new(1.0 + map.depth_bias, 0.0, 0.0, 0.0),
        origin: light.origin.extend(light.jitter.code() as i32),
        step_u: light.step_u.extend(0),
        step_v: light.step_v.extend(0),
    }
}

// Vectors of four, and nothing between them.
const _: () = assert!(size_of::<MicroquadParams>().is_multiple_of(size_of::<IVec4>()));
