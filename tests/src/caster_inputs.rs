//! A scene of casters behind the library's own door: as an engine would hand it over.

use std::collections::BTreeMap;

use umbra4_core::{
    Lattice, LatticeLight, Layers,
    glam::{DVec3, Vec2},
    texture::{TextureSize, Wrap},
};
use umbra4_cpu::{Caster, Occluders, Receivers};

use crate::{
    caster_oracle::{
        OracleCaster, OracleSurface,
        depth::OPAQUE,
        texel::{self, OracleTexture},
    },
    caster_scenes::CasterScene,
    meshes::Mesh,
    scene::Scene,
};

/// What an executor is given.
#[derive(Clone, Debug)]
pub struct CasterInputs {
    /// The lattice that all below is on.
    pub lattice: Lattice,
    /// Light.
    pub light: LatticeLight,
    /// Casters.
    pub casters: Vec<Caster>,
    /// Receivers.
    pub receivers: Receivers,
}

impl CasterScene {
    /// Brings the scene in through the library's public interface, as [`Scene::inputs`] does.
    pub fn inputs(&self, exponent: i32) -> CasterInputs {
        let receivers = self.receivers.iter().map(|receiver| receiver.point).collect();
        let bare = Scene { light: self.light, receivers, mesh: Mesh::default() }.inputs(exponent);
        let casters = self.casters.iter().enumerate().map(|(k, caster)| caster_of(&bare.lattice, caster, k % 2 == 0));
        let casters = casters.collect();
        // None where all are on all: that is another path.
        let layers: Vec<_> = self.receivers.iter().map(|receiver| Layers::from_bits(receiver.layers)).collect();
        let receivers = match layers.iter().all(|layers| *layers == Layers::ALL) {
            true => bare.receivers,
            false => bare.receivers.on_layers(&layers).expect("as many layers as receivers"),
        };
        CasterInputs { lattice: bare.lattice, light: bare.light, casters, receivers }
    }
}

/// A caster as an engine has it. Corners in the same place, with the same texture coordinates, are one vertex where `shared` says so.
pub fn caster_of(lattice: &Lattice, caster: &OracleCaster, shared: bool) -> Caster {
    let none = vec![];
    let (coordinates, is_textured) = match &caster.surface {
        OracleSurface::Cutout { coordinates, .. } | OracleSurface::Tinted { coordinates: Some(coordinates), .. } => {
            (coordinates, true)
        }
        _ => (&none, false),
    };
    let (mut vertices, mut uvs, mut triangles) = (vec![], vec![], vec![]);
    let mut known = BTreeMap::new();
    for (t, triangle) in caster.triangles.iter().enumerate() {
        triangles.push([0, 1, 2].map(|k| {
            let uv = if is_textured { coordinates[t][k] } else { [0; 2] };
            let vertex = || {
                vertices.push(lattice.to_world(triangle[k]));
                uvs.push(coordinate(uv));
                vertices.len() as u32 - 1
            };
            let key = (triangle[k].to_array(), uv, if shared { 0 } else { 3 * t + k });
            *known.entry(key).or_insert_with(vertex)
        }));
    }
    of_mesh(lattice, caster, &vertices, &uvs, &triangles)
}

fn of_mesh(
    lattice: &Lattice,
    caster: &OracleCaster,
    vertices: &[DVec3],
    uvs: &[Vec2],
    triangles: &[[u32; 3]],
) -> Caster {
    let mesh = Occluders::from_f64(lattice, vertices, triangles).expect("vertices are inside");
    let of_surface = match &caster.surface {
        OracleSurface::Opaque => Ok(Caster::opaque(mesh)),
        OracleSurface::Cutout { texture, threshold, .. } => {
            Caster::cutout(mesh, uvs, size_of(texture), &texture.texels, *threshold)
        }
        OracleSurface::Tinted { texture, coordinates: None } => Caster::tinted(mesh, texture.texels[0].map(tint_of)),
        OracleSurface::Tinted { texture, coordinates: Some(_) } => {
            let tints: Vec<_> = texture.texels.iter().map(|depths| depths.map(tint_of)).collect();
            Caster::stained(mesh, uvs, size_of(texture), &tints)
        }
    };
    let result = of_surface
        .and_then(|of| if caster.closed { of.closed() } else { Ok(of) })
        .and_then(|of| if caster.offset == 0 { Ok(of) } else { of.with_plane_offset(caster.offset as u32) });
    result.unwrap_or_else(|error| panic!("{error}: {caster:?}")).on_layers(Layers::from_bits(caster.layers))
}

fn size_of<T>(texture: &OracleTexture<T>) -> TextureSize {
    let wrap = texture.wrap.map(|wrap| match wrap {
        texel::Wrap::Repeat => Wrap::Repeat,
        texel::Wrap::Clamp => Wrap::Clamp,
    });
    TextureSize { width: texture.width, height: texture.height, wrap }
}

/// The float coordinates that are rounded to these, 2^-16 of a texture each.
fn coordinate(units: [i32; 2]) -> Vec2 {
    let [u, v] = units.map(|x| {
        let float = (f64::from(x) / 65536.0) as f32;
        assert_eq!(f64::from(float) * 65536.0, f64::from(x), "the coordinate is short");
        float
    });
    Vec2::new(u, v)
}

/// A tint that is rounded to this depth: not near any half-way.
pub fn tint_of(depth: u16) -> f32 {
    match depth {
        0 => 1.0,
        OPAQUE => 0.0,
        depth => (-f64::from(depth) / 2048.0).exp2() as f32,
    }
}
