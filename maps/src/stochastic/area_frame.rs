//! The light frame: oblique axes along the light's edges, in which every parallelogram is the square `−1..=1`.

#[cfg(not(target_arch = "spirv"))]
use glam::DVec3;
use glam::{IVec3, Vec3};
#[cfg(not(target_arch = "spirv"))]
use umbra4_core::{LatticeLight, jitter::PLACES};

/// Lattice → light frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AreaFrame {
    /// A point near the light, lattice: differences from it are exact, before anything is rounded to f32.
    pub origin: IVec3,
    /// What a, b and d grow by a lattice unit.
    pub axes: [Vec3; 3],
    /// a and b of `origin`, negated; its d is 0.
    pub center: Vec3,
    /// Lengths of half the edges, lattice units.
    pub half_edges: [f32; 2],
}

impl AreaFrame {
    /// That of a light: all of its cells, not only what lies between its outermost samples.
    #[cfg(not(target_arch = "spirv"))]
    pub fn new(light: &LatticeLight) -> Self {
        let (step_u, step_v) = (light.step_u.as_dvec3(), light.step_v.as_dvec3());
        let places = if light.jitter.is_some() { f64::from(PLACES) } else { 1.0 };
        let (half_u, half_v) = (step_u * (f64::from(light.columns) * 0.5), step_v * (f64::from(light.rows) * 0.5));
        // The first sample, or place, lies half a step inside the corner.
        let center = half_u + half_v - (step_u + step_v) * (0.5 / places);
        let normal = half_u.cross(half_v).normalize_or_zero();
        let unit = half_u.length().max(half_v.length());
        // The dual basis: each axis is perpendicular to the other two.
        let dual = |other: DVec3, own: DVec3| {
            let across = other.cross(normal);
            across / across.dot(own)
        };
        let (along_u, along_v) = (dual(half_v, half_u), dual(half_u, half_v));
        Self {
            origin: light.origin,
            axes: [along_u.as_vec3(), along_v.as_vec3(), (normal / unit).as_vec3()],
            center: DVec3::new(along_u.dot(center), along_v.dot(center), 0.0).as_vec3(),
            half_edges: [half_u.length() as f32, half_v.length() as f32],
        }
    }

    /// A lattice point in the light frame. d is 0 or less behind the light.
    #[inline(always)]
    pub fn place(&self, point: IVec3) -> Vec3 {
        let from = point - self.origin;
        let from = Vec3::new(from.x as f32, from.y as f32, from.z as f32);
        let [u, v, n] = self.axes;
        Vec3::new(dot(u, from) - self.center.x, dot(v, from) - self.center.y, dot(n, from))
    }
}

#[inline(always)]
fn dot(a: Vec3, b: Vec3) -> f32 {
    a.x * b.x + a.y * b.y + a.z * b.z
}
