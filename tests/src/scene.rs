//! A scene to test: in lattice integers, or in world floats, and what both become behind the library's own door.

use umbra4_core::{
    AreaLight, Bounds, Lattice, LatticeLight, Lift,
    glam::{DVec3, IVec3, Vec3},
    jitter::PLACES,
    snap::LIMIT,
};
use umbra4_cpu::{Occluders, Receivers};

use crate::{meshes::Mesh, oracle};

/// Largest coordinate of a generated point: the outermost lattice point. Light samples stop one short of it.
pub const REACH: i32 = LIMIT - 1;

/// A scene given by the very integers that decide its bits.
#[derive(Clone, Debug)]
pub struct Scene {
    /// Light; its samples at most `REACH − 1` in size, its steps at least 64 along some axis.
    pub light: LatticeLight,
    /// Receivers.
    pub receivers: Vec<IVec3>,
    /// Occluders.
    pub mesh: Mesh,
}

/// What an executor is given.
#[derive(Clone, Debug)]
pub struct Inputs {
    /// The lattice that all below is on.
    pub lattice: Lattice,
    /// Light.
    pub light: LatticeLight,
    /// Occluders.
    pub occluders: Occluders,
    /// Receivers.
    pub receivers: Receivers,
}

impl Inputs {
    /// The corners of all triangles.
    pub fn triangles(&self) -> Vec<[IVec3; 3]> {
        (0..self.occluders.triangles().len())
            .map(|t| self.occluders.corners(t).expect("the index is below the number of triangles"))
            .collect()
    }

    /// The masks that the oracle finds.
    pub fn oracle(&self) -> Vec<u64> {
        oracle::oracle_masks(&self.light, self.receivers.points(), &self.triangles())
    }

    /// The lattice integers, as a scene.
    pub fn scene(&self) -> Scene {
        let mesh =
            Mesh { vertices: self.occluders.vertices().to_vec(), triangles: self.occluders.triangles().to_vec() };
        Scene { light: self.light, receivers: self.receivers.points().to_vec(), mesh }
    }
}

impl Scene {
    /// Brings the scene in through the library's public interface, on a lattice of step `2^-exponent`: the world is the
    /// integers times the step, so that nothing is rounded, and this is checked.
    pub fn inputs(&self, exponent: i32) -> Inputs {
        let step = 2.0_f64.powi(-exponent);
        let world = |p: IVec3| p.as_dvec3() * step;
        // The outermost bounds for which the exponent is not smaller: the lattice keeps a margin of 1024 units.
        let reach = DVec3::splat(f64::from(LIMIT - 1024) * step);
        let lattice = Lattice::covering(Bounds { min: -reach, max: reach }).expect("bounds are finite and not empty");
        assert_eq!(lattice.exponent(), exponent, "the lattice is as fine as its bounds allow");

        let vertices: Vec<DVec3> = self.mesh.vertices.iter().copied().map(world).collect();
        let occluders = Occluders::from_f64(&lattice, &vertices, &self.mesh.triangles).expect("vertices are inside");
        let points: Vec<DVec3> = self.receivers.iter().copied().map(world).collect();
        let receivers = Receivers::raw_f64(&lattice, &points).expect("receivers are inside");
        let LatticeLight { origin, step_u, step_v, rows, columns, jitter } = self.light;
        let (edge_u, edge_v) = (world(step_u) * f64::from(columns), world(step_v) * f64::from(rows));
        // The corner is half a step before the first sample, or half of one between places before the first place.
        let places = if jitter.is_some() { f64::from(PLACES) } else { 1.0 };
        let corner = world(origin) - (world(step_u) + world(step_v)) * (0.5 / places);
        let light = AreaLight::new(corner, edge_u, edge_v, rows, columns)
            .and_then(|light| light.with_jitter(jitter).snap(&lattice, Lift::NONE))
            .unwrap_or_else(|error| panic!("{error}: {:?}", self.light));

        assert_eq!(occluders.vertices(), self.mesh.vertices, "integers snap to themselves");
        assert_eq!(receivers.points(), self.receivers, "integers snap to themselves");
        assert_eq!(light, self.light, "a light with integer samples snaps to itself");
        Inputs { lattice, light, occluders, receivers }
    }
}

/// A scene in world coordinates, as an engine has it.
#[derive(Clone, Debug)]
pub struct WorldScene {
    /// Vertices.
    pub vertices: Vec<Vec3>,
    /// Vertex indices.
    pub triangles: Vec<[u32; 3]>,
    /// Receivers, taken raw.
    pub receivers: Vec<Vec3>,
    /// The light's corner.
    pub corner: DVec3,
    /// Its edge along the columns.
    pub edge_u: DVec3,
    /// Its edge along the rows.
    pub edge_v: DVec3,
    /// Rows of samples.
    pub rows: u32,
    /// Columns of samples.
    pub columns: u32,
}

impl WorldScene {
    /// The light.
    pub fn light(&self) -> AreaLight {
        AreaLight::new(self.corner, self.edge_u, self.edge_v, self.rows, self.columns).expect("a light with area")
    }

    /// The bounds of all there is.
    pub fn bounds(&self) -> Bounds {
        let points = self.vertices.iter().chain(&self.receivers).map(|p| p.as_dvec3());
        Bounds::of(points.chain(self.light().corners()))
    }

    /// The scene on the finest lattice that holds it.
    pub fn inputs(&self) -> Inputs {
        self.inputs_on(Lattice::covering(self.bounds()).expect("the scene is finite and not empty"))
    }

    /// The scene on a given lattice.
    pub fn inputs_on(&self, lattice: Lattice) -> Inputs {
        Inputs {
            lattice,
            light: self.light().snap(&lattice, Lift::NONE).unwrap_or_else(|error| panic!("{error}")),
            occluders: Occluders::new(&lattice, &self.vertices, &self.triangles).expect("vertices are inside"),
            receivers: Receivers::raw(&lattice, &self.receivers).expect("receivers are inside"),
        }
    }

    /// The scene scaled, then moved, each coordinate rounded to f32.
    #[must_use]
    pub fn transformed(&self, scale: f64, offset: DVec3) -> Self {
        let moved = |p: &Vec3| (p.as_dvec3() * scale + offset).as_vec3();
        Self {
            vertices: self.vertices.iter().map(moved).collect(),
            triangles: self.triangles.clone(),
            receivers: self.receivers.iter().map(moved).collect(),
            corner: self.corner * scale + offset,
            edge_u: self.edge_u * scale,
            edge_v: self.edge_v * scale,
            ..*self
        }
    }
}
