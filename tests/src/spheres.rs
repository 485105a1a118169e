//! Spheres under a lamp, for the approximate family; and options of it.

use umbra4_core::{
    AreaLight, Bounds, Jitter, Lattice, LatticeLight, Lift,
    glam::{DVec3, Vec3},
};
use umbra4_cpu::{
    Occluders, Receivers,
    maps::microquad::{Footprint, MapOptions, MicroOccluders, MicroquadOptions},
};

use crate::meshes::{Mesh, icosphere};

/// A scene under a lamp of 1 × 1, three units above a floor.
#[derive(Clone, Debug)]
pub struct Lit {
    /// What shadows are cast by.
    pub occluders: Occluders,
    /// Where they are looked for.
    pub receivers: Receivers,
    /// What both are on.
    pub lattice: Lattice,
}

/// Spheres between the lamp and the floor, as in figure 7 of Schwarz and Stamminger 2008; the floor is drawn, too. `receivers` along each edge of a
/// square of it.
pub fn spheres(count: usize, receivers: usize) -> Lit {
    let lattice = Lattice::covering(Bounds { min: DVec3::splat(-8.0), max: DVec3::splat(8.0) }).expect("a world");
    let unit = 1.0 / lattice.step();
    let mut mesh = Mesh { vertices: vec![], triangles: vec![] };
    let side = (count as f64).cbrt().ceil() as usize;
    for k in 0..count {
        let place = |k: usize| (k % side) as f64 - (side - 1) as f64 / 2.0;
        let center = DVec3::new(place(k) * 0.5, 0.9 + place(k / side / side) * 0.35, place(k / side) * 0.5);
        mesh.add(&icosphere((center * unit).round().as_ivec3(), 3, |_| 0.16 * unit));
    }
    let floor = [[-3.0, -3.0], [-3.0, 3.0], [3.0, 3.0], [3.0, -3.0]];
    mesh.add_quad(floor.map(|[x, z]| (DVec3::new(x, 0.0, z) * unit).round().as_ivec3()));
    let vertices: Vec<DVec3> = mesh.vertices.iter().map(|v| lattice.to_world(*v)).collect();
    let at = |k: usize| (k as f32 + 0.5) / receivers as f32 * 4.0 - 2.0;
    let points: Vec<Vec3> =
        (0..receivers * receivers).map(|k| Vec3::new(at(k % receivers), 0.0, at(k / receivers))).collect();
    let normals = vec![Vec3::Y; points.len()];
    Lit {
        occluders: Occluders::from_f64(&lattice, &vertices, &mesh.triangles).expect("vertices are inside"),
        receivers: Receivers::on_surfaces(&lattice, &points, &normals, Lift::F32_POSITIONS).expect("as well"),
        lattice,
    }
}

/// The lamp above them.
pub fn lamp(lit: &Lit, rows: u32, columns: u32, jitter: Jitter) -> LatticeLight {
    // X × Z = −Y: it shines down.
    let lamp = AreaLight::new(DVec3::new(-0.5, 3.0, -0.5), DVec3::X, DVec3::Z, rows, columns).expect("a lamp");
    lamp.with_jitter(jitter).snap(&lit.lattice, Lift::NONE).expect("it is coarse enough")
}

/// Options with a map of `size` texels along each edge.
pub fn options(size: u32, occluders: MicroOccluders, footprint: Footprint) -> MicroquadOptions {
    MicroquadOptions { map: MapOptions { size, ..MapOptions::default() }, occluders, footprint }
}
