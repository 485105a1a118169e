//! Where light and camera are: around a model on the ground, or inside the atrium.

use umbra4::model::Model;
use umbra4_core::glam::DVec3;

use super::{Lamp, PAPER_DIAGONAL, PAPER_DISTANCE, Scene, SceneError, diagonal, edge};
use crate::primary::Camera;

/// Half the edge of the ground plane, in diagonals of the model's box.
const GROUND: f64 = 2.5;

/// How a camera sees a model; lengths are in diagonals of the model's box.
#[derive(Clone, Copy, Debug)]
pub(super) struct View {
    /// Direction from the centre of the box to the camera; of any length.
    pub towards: DVec3,
    /// Distance of the camera from the centre of the box.
    pub distance: f64,
    /// What it looks at, from the centre of the box.
    pub target: DVec3,
}

/// The dragons'.
pub(super) const DRAGON_VIEW: View =
    View { towards: DVec3::new(0.25, 0.55, 1.0), distance: 1.2, target: DVec3::new(0.04, -0.06, 0.0) };

/// The trees': low enough to look under the crowns.
pub(super) const FOLIAGE_VIEW: View =
    View { towards: DVec3::new(0.25, 0.36, 1.0), distance: 0.95, target: DVec3::new(0.06, -0.06, 0.0) };

/// The scaffold's: from beside it, so that ground under it and ground in its shadow are seen.
pub(super) const LATTICE_VIEW: View =
    View { towards: DVec3::new(0.8, 0.5, 1.0), distance: 1.3, target: DVec3::new(0.1, -0.1, -0.05) };

/// The ball's.
pub(super) const HAIRBALL_VIEW: View =
    View { towards: DVec3::new(0.25, 0.55, 1.0), distance: 1.3, target: DVec3::new(0.12, -0.1, 0.0) };

/// A model on a ground plane; the light above and beside it, facing it.
pub(super) fn on_ground(mut model: Model, view: View, paper_light: f64, samples: u32) -> Result<Scene, SceneError> {
    let extent = model.bounds();
    let (center, diagonal, edge) = (extent.center(), diagonal(extent), edge(paper_light, extent));
    add_ground(&mut model, center, extent.min.y, GROUND * diagonal);

    let away = DVec3::new(-0.45, 0.8, 0.4).normalize();
    // edge_u × edge_v points back at the model.
    let edge_v = DVec3::Y.cross(away).normalize() * edge;
    let edge_u = edge_v.normalize().cross(-away) * edge;
    let lamp = Lamp::around(center + away * (PAPER_DISTANCE / PAPER_DIAGONAL * diagonal), edge_u, edge_v);

    let eye = center + view.towards.normalize() * view.distance * diagonal;
    let camera = Camera { eye, target: center + view.target * diagonal, vertical_degrees: 40.0 };
    Scene::new(model, extent, lamp, camera, samples)
}

/// Two triangles under the model.
pub(super) fn add_ground(model: &mut Model, center: DVec3, height: f64, half: f64) {
    let first = model.vertices.len() as u32;
    for (x, z) in [(-half, -half), (-half, half), (half, half), (half, -half)] {
        model.vertices.push(DVec3::new(center.x + x, height, center.z + z).as_vec3());
    }
    model.triangles.extend([[first, first + 1, first + 2], [first, first + 2, first + 3]]);
}

/// The atrium, with the light hanging in it at half its height, shining down; the camera looks along it.
pub(super) fn in_atrium(model: Model, paper_light: f64, samples: u32) -> Result<Scene, SceneError> {
    let extent = model.bounds();
    let edge = edge(paper_light, extent);
    let lamp = Lamp::around(DVec3::new(0.0, 7.5, 0.0), DVec3::X * edge, DVec3::Z * edge);
    debug_assert!(lamp.edge_u.cross(lamp.edge_v).y < 0.0, "the light shines down");
    let camera = Camera { eye: DVec3::new(-9.5, 5.0, 0.7), target: DVec3::new(2.0, 2.2, -0.3), vertical_degrees: 60.0 };
    Scene::new(model, extent, lamp, camera, samples)
}
