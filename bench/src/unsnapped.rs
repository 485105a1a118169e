//! The second oracle on a real scene: original coordinates, exact arithmetic. It is slow, so it is given only triangles
//! near the pyramid between the receiver and the light.

use rayon::prelude::*;
use umbra4_core::glam::{DVec3, IVec3, Vec3};
use umbra4_tests::{oracle::hit, scene::WorldScene, second_oracle::ExactScene};

use crate::{problem::Problem, scene::Scene};

/// Triangles are left out where they are farther outside the pyramid than this share of the largest coordinate: some
/// 500 lattice units, where the snap moves nothing by more than 33 (a sample of a 64 × 64 light).
const MARGIN: f64 = 1e-6;

/// Bits on the original coordinates against those on the lattice.
#[derive(Clone, Copy, Debug, Default)]
pub struct Moved {
    /// Receivers compared.
    pub receivers: usize,
    /// Their bits.
    pub bits: u64,
    /// Bits that differ.
    pub moved: u64,
    /// Bits of these that the snap does not explain.
    pub unexplained: u64,
}

impl Moved {
    fn plus(self, other: Self) -> Self {
        Self {
            receivers: self.receivers + other.receivers,
            bits: self.bits + other.bits,
            moved: self.moved + other.moved,
            unexplained: self.unexplained + other.unexplained,
        }
    }
}

/// A scene on both sides of the snap.
pub struct Unsnapped<'a> {
    scene: &'a Scene,
    problem: &'a Problem<'a>,
    /// All triangles on the lattice.
    triangles: &'a [[IVec3; 3]],
    margin: f64,
}

impl<'a> Unsnapped<'a> {
    /// The scene, and its triangles snapped to the problem's lattice.
    pub fn new(scene: &'a Scene, problem: &'a Problem<'a>, triangles: &'a [[IVec3; 3]]) -> Self {
        let corners = scene.model.vertices.iter().map(|v| v.as_dvec3()).chain(scene.light.corners());
        let largest = corners.map(|p| p.abs().max_element()).fold(0.0, f64::max);
        Self { scene, problem, triangles, margin: MARGIN * largest }
    }

    /// Compares the masks of the `chosen` receivers, given all receivers' world and lattice coordinates and masks.
    pub fn moved(&self, chosen: &[usize], world: &[Vec3], points: &[IVec3], masks: &[u64]) -> Moved {
        let rows = self.problem.rows();
        let one = |&i: &usize| self.moved_one(world[i], points[i], &masks[i * rows..(i + 1) * rows]);
        chosen.par_iter().map(one).reduce(Moved::default, Moved::plus)
    }

    fn moved_one(&self, receiver: Vec3, point: IVec3, mask: &[u64]) -> Moved {
        let Scene { model, lamp, .. } = self.scene;
        let light = &self.problem.light;
        let planes = self.pyramid(receiver.as_dvec3());
        let outside = |corners: &[DVec3; 3]| {
            planes.iter().any(|(normal, on)| corners.iter().all(|&v| normal.dot(v - on) < -self.margin))
        };
        let corners = |t: &[u32; 3]| t.map(|v| model.vertices[v as usize].as_dvec3());
        let near: Vec<usize> =
            (0..model.triangles.len()).filter(|&t| !outside(&corners(&model.triangles[t]))).collect();
        let scene = WorldScene {
            vertices: near.iter().flat_map(|&t| model.triangles[t]).map(|v| model.vertices[v as usize]).collect(),
            triangles: (0..near.len() as u32).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect(),
            receivers: vec![receiver],
            corner: lamp.corner,
            edge_u: lamp.edge_u,
            edge_v: lamp.edge_v,
            rows: light.rows,
            columns: light.columns,
        };
        let snapped = |_: usize, row: usize, column: usize, t: usize| {
            hit(point, light.sample(row as u32, column as u32), self.triangles[near[t]])
        };
        let (moved, unexplained) = ExactScene::new(&scene, &self.problem.lattice).differences(0, mask, &snapped);
        let bits = u64::from(light.sample_count());
        Moved { receivers: 1, bits, moved, unexplained: unexplained.len() as u64 }
    }

    /// Planes (unit normal, point) with the pyramid of light and receiver on the positive side: what lies wholly on the
    /// negative side of one blocks nothing. A degenerate plane has normal NaN, of which nothing is on any side.
    fn pyramid(&self, receiver: DVec3) -> [(DVec3, DVec3); 6] {
        let light = &self.scene.light;
        let corners = light.corners();
        let side = |k: usize| {
            let normal = (corners[k] - receiver).cross(corners[(k + 1) % 4] - receiver).normalize();
            (if normal.dot(light.center() - receiver) < 0.0 { -normal } else { normal }, receiver)
        };
        let shines = self.scene.lamp.edge_u.cross(self.scene.lamp.edge_v).normalize();
        [side(0), side(1), side(2), side(3), (shines, corners[0]), (-shines, receiver)]
    }
}
