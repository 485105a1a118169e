//! What the camera sees: one triangle a pixel, by a library BVH; then the exact point on it.

use std::time::Duration;

use obvhs::{
    BvhBuildParams,
    cwbvh::{CwBvh, builder::build_cwbvh_from_tris},
    ray::{Ray, RayHit},
    triangle::Triangle,
};
use rayon::prelude::*;
use umbra4_core::glam::{DVec3, Vec3, Vec3A};

use crate::{camera::Camera, model::Model};

/// A surface point that a pixel sees.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// World position: computed in f64 from the triangle's corners, then rounded once to f32.
    pub position: Vec3,
    /// The triangle's geometric normal, of length 1, on the side that is seen.
    pub normal: Vec3,
    /// Index of the triangle.
    pub triangle: u32,
}

/// What every pixel sees, row by row from the top; `None` where it sees nothing.
#[derive(Clone, Debug, PartialEq)]
pub struct GBuffer {
    /// Pixels a row.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// `width · height` pixels.
    pub hits: Vec<Option<Hit>>,
}

impl GBuffer {
    /// The pixels that see something.
    pub fn seen(&self) -> impl Iterator<Item = &Hit> {
        self.hits.iter().flatten()
    }
}

/// Traces one ray through the middle of every pixel.
pub fn visible_surfaces(model: &Model, camera: &Camera, width: u32, height: u32) -> GBuffer {
    let tracer = Tracer::new(model, camera.from());
    let hits = (0..height)
        .into_par_iter()
        .flat_map_iter(|y| {
            let tracer = &tracer;
            (0..width).map(move |x| tracer.hit(camera.direction(x, y, width, height)))
        })
        .collect();
    GBuffer { width, height, hits }
}

/// The BVH stands in a unit frame around the eye, so that f32 serves any scale and any distance from the origin.
struct Tracer<'a> {
    model: &'a Model,
    eye: DVec3,
    bvh: Option<CwBvh>,
    /// In the order of the BVH's leaves.
    triangles: Vec<Triangle>,
    /// Index in the model of every one of `triangles`.
    owners: Vec<u32>,
}

impl<'a> Tracer<'a> {
    fn new(model: &'a Model, eye: DVec3) -> Self {
        let reach = model.vertices.iter().map(|v| (v.as_dvec3() - eye).abs().max_element()).fold(0.0, f64::max);
        let mut triangles = Vec::new();
        let mut owners = Vec::new();
        for (index, owner) in (0..model.triangles.len()).zip(0_u32..) {
            if let Some(corners) = model.corners(index)
                && normal(corners) != DVec3::ZERO
            {
                let [v0, v1, v2] = corners.map(|p| Vec3A::from(((p - eye) / reach).as_vec3()));
                triangles.push(Triangle { v0, v1, v2 });
                owners.push(owner);
            }
        }
        if triangles.is_empty() {
            return Self { model, eye, bvh: None, triangles, owners };
        }
        let bvh = build_cwbvh_from_tris(&triangles, BvhBuildParams::medium_build(), &mut Duration::default());
        let order = &bvh.primitive_indices;
        let triangles = order.iter().map(|&i| triangles[i as usize]).collect();
        let owners = order.iter().map(|&i| owners[i as usize]).collect();
        Self { model, eye, bvh: Some(bvh), triangles, owners }
    }

    fn hit(&self, direction: DVec3) -> Option<Hit> {
        let bvh = self.bvh.as_ref()?;
        let ray = Ray::new(Vec3A::ZERO, direction.as_vec3a(), 0.0, f32::MAX);
        let mut hit = RayHit::none();
        if !bvh.ray_traverse(ray, &mut hit, |ray, id| self.triangles[id].intersect(ray)) {
            return None;
        }
        let triangle = *self.owners.get(hit.primitive_id as usize)?;
        let corners = self.model.corners(triangle as usize)?;
        let normal = normal(corners);
        let towards_eye = if normal.dot(direction) > 0.0 { -normal } else { normal };
        let position = on_triangle(corners, normal, self.eye, direction).as_vec3();
        Some(Hit { position, normal: towards_eye.as_vec3(), triangle })
    }
}

/// Of length 1, or zero for a degenerate triangle.
fn normal([a, b, c]: [DVec3; 3]) -> DVec3 {
    // Edges are scaled first, so that neither tiny nor huge triangles lose their normal to the range of f64.
    let (u, v) = (b - a, c - a);
    let scale = u.abs().max_element().max(v.abs().max_element());
    if scale > 0.0 { (u / scale).cross(v / scale).normalize_or_zero() } else { DVec3::ZERO }
}

/// Where the ray meets the triangle's plane, in barycentric coordinates kept inside the triangle.
fn on_triangle([a, b, c]: [DVec3; 3], normal: DVec3, eye: DVec3, direction: DVec3) -> DVec3 {
    let (u, v) = (b - a, c - a);
    let at = eye + direction * (normal.dot(a - eye) / normal.dot(direction)) - a;
    let area = u.cross(v).dot(normal);
    let (s, t) = (at.cross(v).dot(normal) / area, u.cross(at).dot(normal) / area);
    if !(s.is_finite() && t.is_finite()) {
        // The ray grazes the plane: any point of the triangle will do.
        return a + (u + v) / 3.0;
    }
    let (s, t) = (s.clamp(0.0, 1.0), t.clamp(0.0, 1.0));
    let excess = (s + t).max(1.0);
    a + u * (s / excess) + v * (t / excess)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn square(size: f32, offset: Vec3) -> Model {
        let corner = |x: f32, z: f32| offset + Vec3::new(x, 0.0, z) * size;
        Model {
            vertices: vec![corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0)],
            triangles: vec![[0, 1, 2], [0, 2, 3], [0, 0, 1]],
        }
    }

    #[test]
    fn hits_lie_on_the_surface_at_any_scale() {
        for size in [1e-30_f32, 1e-6, 1.0, 1e6, 1e30] {
            let model = square(size, Vec3::ZERO);
            let camera = Camera::new(DVec3::new(0.3, 2.0, 0.1) * f64::from(size), DVec3::ZERO, 30.0).unwrap();
            let seen = visible_surfaces(&model, &camera, 8, 8);
            for hit in seen.hits {
                let hit = hit.unwrap();
                assert_eq!((hit.position.y, hit.normal), (0.0, Vec3::Y));
                assert!(hit.triangle < 2);
            }
        }
    }

    #[test]
    fn degenerate_models_show_nothing() {
        let model = Model { vertices: vec![Vec3::ZERO; 3], triangles: vec![[0, 1, 2]] };
        let camera = Camera::new(DVec3::ONE, DVec3::ZERO, 30.0).unwrap();
        assert_eq!(visible_surfaces(&model, &camera, 4, 4).seen().count(), 0);
    }
}
