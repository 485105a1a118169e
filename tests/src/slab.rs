//! A slab and a wall on a floor: shadows that are soft, and shadows that begin where the wall stands.

use umbra4_core::glam::{DVec3, Vec3};

use crate::{rng::Rng, scene::WorldScene};

/// A slab above a floor, and a wall that stands on it; receivers on the floor, some of them close to the wall.
pub fn slab_and_wall(across: u32) -> WorldScene {
    let mut vertices = Vec::new();
    let mut triangles = Vec::new();
    let mut quad = |corners: [[f32; 3]; 4]| {
        let first = vertices.len() as u32;
        vertices.extend(corners.map(Vec3::from_array));
        triangles.extend([[first, first + 1, first + 2], [first, first + 2, first + 3]]);
    };
    quad([[-4.0, 0.0, -4.0], [4.0, 0.0, -4.0], [4.0, 0.0, 4.0], [-4.0, 0.0, 4.0]]);
    quad([[-1.2, 1.0, -0.7], [0.0, 1.0, -0.7], [0.0, 1.0, 0.7], [-1.2, 1.0, 0.7]]);
    quad([[0.9, 0.0, -1.0], [0.9, 0.8, -1.0], [0.9, 0.8, 1.0], [0.9, 0.0, 1.0]]);
    quad([[0.9, 0.8, -1.0], [1.2, 0.8, -1.0], [1.2, 0.8, 1.0], [0.9, 0.8, 1.0]]);
    let at = |k: u32| 4.0 * (k as f32 + 0.5) / across as f32 - 2.0;
    let receivers = (0..across * across).map(|k| Vec3::new(at(k % across), 1e-4, at(k / across))).collect();
    let (corner, edge_u, edge_v) = (DVec3::new(-0.5, 3.0, -0.5), DVec3::X, DVec3::Z);
    WorldScene { vertices, triangles, receivers, corner, edge_u, edge_v, rows: 16, columns: 16 }
}

/// Steps of receivers at several depths before the light, so that planes differ.
#[must_use]
pub fn with_receivers_in_the_air(mut scene: WorldScene, rng: &mut Rng) -> WorldScene {
    for receiver in scene.receivers.iter_mut().step_by(2) {
        receiver.y = (rng.unit() * 0.7 + 0.1) as f32;
    }
    scene
}
