//! Two grids between a light and a floor, of which the upper one turns: the scene in which Liktor et al. 2015 (figure 14) show that the shadow of
//! the lower, still grid is modulated by what the upper one lets through from where.

use umbra4_core::glam::{DVec3, Vec3};

use crate::scene::WorldScene;

/// Bars of each grid, each way.
const BARS: i32 = 5;

/// The scene with the upper grid turned by `angle` radians, and `across` × `across` receivers on the floor between −1.5 and 1.5.
pub fn two_grids(angle: f64, across: u32, samples: u32) -> WorldScene {
    let (mut vertices, mut triangles) = (Vec::new(), Vec::new());
    let mut grid = |height: f64, pitch: f64, angle: f64| {
        let (along, aside) = (DVec3::new(angle.cos(), 0.0, angle.sin()), DVec3::new(-angle.sin(), 0.0, angle.cos()));
        let (half, width) = (pitch * f64::from(BARS) * 0.5, pitch * 0.25);
        for (along, aside) in [(along, aside), (aside, along)] {
            for bar in 0..=BARS {
                let middle = aside * (f64::from(bar) * pitch - half) + DVec3::Y * height;
                let first = vertices.len() as u32;
                for (x, y) in [(-half, -width), (half, -width), (half, width), (-half, width)] {
                    vertices.push((middle + along * x + aside * y).as_vec3());
                }
                triangles.extend([[first, first + 1, first + 2], [first, first + 2, first + 3]]);
            }
        }
    };
    grid(3.0, 0.6, angle);
    grid(1.0, 0.3, 0.0);
    let floor = vertices.len() as u32;
    vertices.extend([(-4.0, -4.0), (4.0, -4.0), (4.0, 4.0), (-4.0, 4.0)].map(|(x, z)| Vec3::new(x, 0.0, z)));
    triangles.extend([[floor, floor + 1, floor + 2], [floor, floor + 2, floor + 3]]);
    let at = |k: u32| (3.0 * (f64::from(k) + 0.5) / f64::from(across) - 1.5) as f32;
    let receivers = (0..across * across).map(|k| Vec3::new(at(k % across), 1e-4, at(k / across))).collect();
    let (corner, edge_u, edge_v) = (DVec3::new(-0.5, 5.0, -0.5), DVec3::X, DVec3::Z);
    WorldScene { vertices, triangles, receivers, corner, edge_u, edge_v, rows: samples, columns: samples }
}
