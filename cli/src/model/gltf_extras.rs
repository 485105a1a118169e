//! The extras of a glTF document that are meant for this program. Extras of others are passed over.

use std::collections::BTreeMap;

use gltf::json::Extras;
use serde_json::value::RawValue;

/// Name, among the extras of a node, of a light with an area.
pub(super) const LIGHT: &str = "umbra4";
/// Name, among the extras of a node or of a mesh, of how it casts and receives shadows.
pub(super) const CASTER: &str = "umbra4_caster";

/// What the extras say under a name.
pub(super) fn find(extras: &Extras, name: &str) -> Option<Box<RawValue>> {
    let mut extras: BTreeMap<String, Box<RawValue>> = serde_json::from_str(extras.as_ref()?.get()).ok()?;
    extras.remove(name)
}
