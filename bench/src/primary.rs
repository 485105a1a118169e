//! Primary visibility: the receivers are what the camera sees.

use std::time::Duration;

use obvhs::{
    BvhBuildParams,
    cwbvh::builder::build_cwbvh_from_tris,
    ray::{Ray, RayHit},
    triangle::Triangle,
};
use umbra4::model::Model;
use umbra4_core::glam::{DVec3, Vec3};

use crate::image_size::ImageSize;

/// A pinhole camera; y is up.
#[derive(Clone, Copy, Debug)]
pub struct Camera {
    /// Where it stands, world.
    pub eye: DVec3,
    /// What it looks at, world.
    pub target: DVec3,
    /// Opening angle from the lower to the upper edge of the image.
    pub vertical_degrees: f64,
}

impl Camera {
    /// Direction through the middle of pixel (`x`, `y`) of an image; (0, 0) is upper left.
    fn direction(&self, x: u32, y: u32, size: ImageSize) -> DVec3 {
        let forward = (self.target - self.eye).normalize();
        let right = forward.cross(DVec3::Y).normalize();
        let up = right.cross(forward);
        let half = (self.vertical_degrees.to_radians() * 0.5).tan();
        let along = |pixel: u32, pixels: u32| ((f64::from(pixel) + 0.5) / f64::from(pixels) * 2.0 - 1.0) * half;
        let aspect = f64::from(size.width) / f64::from(size.height);
        forward + right * (along(x, size.width) * aspect) - up * along(y, size.height)
    }
}

/// A point that the camera sees.
#[derive(Clone, Copy, Debug)]
pub struct Hit {
    /// Column of the pixel.
    pub x: u32,
    /// Row of the pixel.
    pub y: u32,
    /// Where the triangle's plane is hit: computed in f64, rounded once.
    pub position: Vec3,
    /// Geometric normal of the triangle, towards the camera, of length one.
    pub normal: Vec3,
}

/// What the pixels see, row by row; pixels that see nothing are left out.
pub fn hits(model: &Model, camera: &Camera, size: ImageSize) -> Vec<Hit> {
    let triangles = rival_triangles(model);
    let bvh = build_cwbvh_from_tris(&triangles, BvhBuildParams::medium_build(), &mut Duration::default());
    let mut hits = Vec::new();
    for y in 0..size.height {
        for x in 0..size.width {
            let direction = camera.direction(x, y, size);
            let ray = Ray::new_inf(camera.eye.as_vec3().into(), direction.as_vec3().into());
            let mut hit = RayHit::none();
            let triangle = |id: usize| &triangles[bvh.primitive_indices[id] as usize];
            if bvh.ray_traverse(ray, &mut hit, |ray, id| triangle(id).intersect(ray)) {
                let triangle = triangle(hit.primitive_id as usize);
                let [a, b, c] = [triangle.v0, triangle.v1, triangle.v2].map(|v| Vec3::from(v).as_dvec3());
                let normal = (b - a).cross(c - a).normalize_or_zero();
                let t = normal.dot(a - camera.eye) / normal.dot(direction);
                let normal = if normal.dot(direction) > 0.0 { -normal } else { normal };
                let position = camera.eye + direction * t;
                hits.push(Hit { x, y, position: position.as_vec3(), normal: normal.as_vec3() });
            }
        }
    }
    // A triangle without a plane, or one seen exactly edge-on, is no surface to stand on.
    hits.retain(|hit| hit.position.is_finite() && hit.normal != Vec3::ZERO);
    hits
}

/// The model's triangles as the BVH crate takes them.
pub fn rival_triangles(model: &Model) -> Vec<Triangle> {
    let vertex = |index: u32| model.vertices[index as usize].into();
    model.triangles.iter().map(|&[a, b, c]| Triangle { v0: vertex(a), v1: vertex(b), v2: vertex(c) }).collect()
}
