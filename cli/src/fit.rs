//! A camera, a light and a ground for a model that comes without.

use umbra4_core::{
    Bounds,
    glam::{DVec3, Vec3},
};

use crate::{
    camera::{Camera, CameraError, Viewpoint},
    light_file::LightShape,
    model::Model,
};

/// Vertical angle of view, degrees, where none is asked for.
const FOV: f64 = 35.0;

/// From the model's middle towards the fitted camera.
const CAMERA_SIDE: DVec3 = DVec3::new(0.55, 0.5, 1.0);
/// From the model's middle towards the fitted light.
const LIGHT_SIDE: DVec3 = DVec3::new(-0.55, 1.0, 0.45);
/// Half the ground's width, in diagonals of the model.
const GROUND: f64 = 6.0;
/// Distance from the model's middle at which the ground has faded into the backdrop, in diagonals of the model.
pub const FADE: f64 = 2.8;

/// Length of the diagonal of `bounds`, never zero.
pub fn diagonal(bounds: Bounds) -> f64 {
    let diagonal = (bounds.max - bounds.min).length();
    if diagonal > 0.0 { diagonal } else { 1.0 }
}

/// A camera that sees all of `bounds`; what is given is kept.
///
/// # Errors
/// As [`Camera::new`].
pub fn camera(bounds: Bounds, given: Viewpoint) -> Result<Camera, CameraError> {
    let fov = given.fov.unwrap_or(FOV);
    let to = given.to.unwrap_or(bounds.center());
    let distance = 0.5 * diagonal(bounds) / (fov.to_radians() * 0.5).sin().max(1e-6);
    Camera::new(given.from.unwrap_or(to + CAMERA_SIDE.normalize() * distance), to, fov)
}

/// A square light that faces the middle of `bounds`. `size` is the length of its edges and `distance` how far its
/// middle is from that of the bounds, both in diagonals of the bounds.
pub fn light(bounds: Bounds, size: f64, distance: f64) -> LightShape {
    let unit = diagonal(bounds);
    let towards = LIGHT_SIDE.normalize();
    let u = towards.cross(DVec3::Y).normalize();
    let v = u.cross(towards);
    // edge_u × edge_v must point back at the model.
    let (edge_u, edge_v) = (u * (size * unit), v * (size * unit));
    let corner = bounds.center() + towards * (distance * unit) - (edge_u + edge_v) * 0.5;
    LightShape { corner: corner.to_array(), edge_u: edge_u.to_array(), edge_v: edge_v.to_array() }
}

/// A level square under `bounds`, as wide as the light's and the camera's surroundings.
pub fn ground(bounds: Bounds) -> Model {
    let (center, half) = (bounds.center(), GROUND * diagonal(bounds));
    let corner =
        |x: f64, z: f64| Vec3::new((center.x + x * half) as f32, bounds.min.y as f32, (center.z + z * half) as f32);
    Model {
        vertices: vec![corner(-1.0, -1.0), corner(-1.0, 1.0), corner(1.0, 1.0), corner(1.0, -1.0)],
        triangles: vec![[0, 1, 2], [0, 2, 3]],
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const BOX: Bounds = Bounds { min: DVec3::new(-1.0, 0.0, -2.0), max: DVec3::new(3.0, 2.0, 1.0) };

    #[test]
    fn the_light_faces_the_model() {
        let shape = light(BOX, 0.3, 1.0);
        let [corner, u, v] = [shape.corner, shape.edge_u, shape.edge_v].map(DVec3::from_array);
        let middle = corner + (u + v) * 0.5;
        assert!(u.cross(v).dot(BOX.center() - middle) > 0.0);
        assert!((middle.distance(BOX.center()) - diagonal(BOX)).abs() < 1e-9);
    }

    #[test]
    fn a_point_sized_model_still_has_a_camera() {
        let point = Bounds { min: DVec3::ONE, max: DVec3::ONE };
        assert!(camera(point, Viewpoint::default()).is_ok());
    }

    #[test]
    fn the_ground_touches_the_model_from_below() {
        assert!(ground(BOX).vertices.iter().all(|v| v.y == 0.0));
    }
}
