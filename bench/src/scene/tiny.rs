//! A small scene made by code, for tests: a leaning fan of triangles over a ground plane.

use umbra4::model::Model;
use umbra4_core::glam::{DVec3, Vec3};

use super::{Lamp, Scene, place::add_ground};
use crate::primary::Camera;

/// The scene, with a light of `samples` × `samples`.
pub fn tiny(samples: u32) -> Scene {
    let mut model = Model::default();
    for i in 0..12_u8 {
        let a = f32::from(i) * 0.55;
        let base = Vec3::new(a.cos(), 0.3 + 0.07 * f32::from(i), a.sin());
        let first = model.vertices.len() as u32;
        model.vertices.extend([base, base + Vec3::new(0.4, 0.3, -0.2), base + Vec3::new(-0.1, 0.5, 0.37)]);
        model.triangles.push([first, first + 1, first + 2]);
    }
    add_ground(&mut model, DVec3::ZERO, 0.0, 4.0);
    let extent = model.bounds();
    let corner = DVec3::new(-0.6, 4.0, -0.4);
    let lamp = Lamp { corner, edge_u: DVec3::X * 1.1, edge_v: DVec3::new(0.0, 0.1, 1.2) };
    let camera = Camera { eye: DVec3::new(0.5, 3.0, 5.0), target: DVec3::Y * 0.4, vertical_degrees: 50.0 };
    #[expect(clippy::unwrap_used, reason = "a light with an area")]
    Scene::new(model, extent, lamp, camera, samples).unwrap()
}
