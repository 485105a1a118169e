//! The first camera of a glTF document. Those that are rolled are set upright, since all cameras here are.

use gltf::{Document, json::camera};
use umbra4_core::glam::DVec3;

use super::gltf::Placed;
use crate::camera::Viewpoint;

/// The first camera with a perspective, if there is one.
pub(super) fn read(document: &Document, nodes: &[Placed<'_>]) -> Option<Viewpoint> {
    nodes.iter().find_map(|(node, transform)| {
        // Not the crate's wrapper: that one takes it for granted that the type says which of the projections is there.
        let json: &camera::Camera = document.as_json().cameras.get(node.camera()?.index())?;
        let fov = f64::from(json.perspective.as_ref()?.yfov).to_degrees();
        let from = transform.transform_point3(DVec3::ZERO);
        // Far away, a step of length 1 would be lost.
        let step = from.abs().max_element().max(1.0);
        let to = from + transform.transform_vector3(DVec3::NEG_Z).normalize_or_zero() * step;
        Some(Viewpoint { from: Some(from), to: Some(to), fov: Some(fov) })
    })
}
