//! What the engine draws: a ground, a ring of columns, a torus that turns, cubes that float around it, and a lamp that wanders.

use std::f32::consts::TAU;

use umbra4_core::{
    AreaLight, Bounds, LightError,
    glam::{DVec3, Mat4, Vec3, Vec4},
};

/// A vertex as the vertex buffers hold it.
#[derive(Clone, Copy, Debug, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct Vertex {
    pub position: Vec3,
    pub normal: Vec3,
}

/// An instance as the instance buffer holds it.
#[derive(Clone, Copy, Debug, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct Instance {
    pub world: Mat4,
    pub colour: Vec4,
}

/// A mesh: a triangle list.
#[derive(Clone, Debug, Default)]
pub struct Shape {
    pub vertices: Vec<Vertex>,
    pub indices: Vec<u32>,
}

impl Shape {
    /// A grid of quads: `point(u, v)` for u, v in 0..=1 gives position and normal.
    fn grid(columns: u32, rows: u32, point: impl Fn(f32, f32) -> (Vec3, Vec3)) -> Self {
        let mut shape = Self::default();
        for row in 0..=rows {
            for column in 0..=columns {
                let (position, normal) = point(column as f32 / columns as f32, row as f32 / rows as f32);
                shape.vertices.push(Vertex { position, normal });
            }
        }
        for row in 0..rows {
            for column in 0..columns {
                let a = row * (columns + 1) + column;
                let [b, c, d] = [a + 1, a + columns + 1, a + columns + 2];
                shape.indices.extend([a, b, d, a, d, c]);
            }
        }
        shape
    }

    fn with(mut self, other: Self) -> Self {
        let base = self.vertices.len() as u32;
        self.vertices.extend(other.vertices);
        self.indices.extend(other.indices.iter().map(|index| base + index));
        self
    }

    fn ground() -> Self {
        Self::grid(1, 1, |u, v| (Vec3::new(24.0 * u - 12.0, 0.0, 24.0 * v - 12.0), Vec3::Y))
    }

    fn cube() -> Self {
        let face = |normal: Vec3| {
            let side = normal.any_orthonormal_vector();
            let up = normal.cross(side);
            Self::grid(1, 1, move |u, v| (0.5 * normal + (u - 0.5) * side + (v - 0.5) * up, normal))
        };
        let axes = [Vec3::X, Vec3::Y, Vec3::Z];
        axes.into_iter().flat_map(|axis| [axis, -axis]).fold(Self::default(), |cube, normal| cube.with(face(normal)))
    }

    fn column() -> Self {
        let ring = |u: f32| Vec3::new((TAU * u).cos(), 0.0, (TAU * u).sin());
        let shaft = Self::grid(32, 1, |u, v| (ring(u) * (0.42 - 0.08 * v) + Vec3::Y * (3.2 * v), ring(u)));
        let top = Self::grid(1, 1, |u, v| (Vec3::new(u - 0.5, 3.45, v - 0.5), Vec3::Y));
        let bottom = Self::grid(1, 1, |u, v| (Vec3::new(u - 0.5, 3.2, v - 0.5), Vec3::NEG_Y));
        let sides = [Vec3::X, Vec3::NEG_X, Vec3::Z, Vec3::NEG_Z].map(|normal| {
            let side = normal.cross(Vec3::Y);
            Self::grid(1, 1, move |u, v| (0.5 * normal + (u - 0.5) * side + Vec3::Y * (3.2 + 0.25 * v), normal))
        });
        sides.into_iter().fold(shaft.with(top).with(bottom), Self::with)
    }

    fn torus() -> Self {
        Self::grid(96, 32, |u, v| {
            let around = Vec3::new((TAU * u).cos(), (TAU * u).sin(), 0.0);
            let normal = around * (TAU * v).cos() + Vec3::Z * (TAU * v).sin();
            (around * 1.3 + normal * 0.38, normal)
        })
    }
}

/// The shapes, and how often each is drawn.
pub fn shapes() -> [(Shape, u32); 4] {
    [(Shape::ground(), 1), (Shape::column(), 12), (Shape::torus(), 1), (Shape::cube(), 16)]
}

/// The instances of all shapes, in the order of [`shapes`], at a time in seconds.
pub fn instances(time: f32) -> Vec<Instance> {
    let mut all = vec![Instance { world: Mat4::IDENTITY, colour: Vec4::new(0.75, 0.72, 0.68, 1.0) }];
    for k in 0..12 {
        let angle = TAU * k as f32 / 12.0;
        let world = Mat4::from_rotation_y(angle) * Mat4::from_translation(Vec3::X * 5.5);
        all.push(Instance { world, colour: Vec4::new(0.85, 0.82, 0.76, 1.0) });
    }
    let spin = Mat4::from_rotation_y(0.5 * time) * Mat4::from_rotation_x(0.3 * time + 0.6);
    all.push(Instance { world: Mat4::from_translation(Vec3::Y * 2.1) * spin, colour: Vec4::new(0.9, 0.45, 0.25, 1.0) });
    for k in 0..16 {
        let angle = TAU * k as f32 / 16.0 - 0.2 * time;
        let height = 0.7 + 0.45 * (3.0 * angle + time).sin();
        let world = Mat4::from_rotation_y(angle)
            * Mat4::from_translation(Vec3::new(3.1, height, 0.0))
            * Mat4::from_rotation_x(angle * 5.0 + time)
            * Mat4::from_rotation_z(angle)
            * Mat4::from_scale(Vec3::splat(0.5));
        all.push(Instance { world, colour: Vec4::new(0.35, 0.55, 0.8, 1.0) });
    }
    all
}

/// The lamp's corner and edges: 3 × 3 metres, it shines down.
pub fn lamp(time: f32) -> [Vec3; 3] {
    let center = Vec3::new(2.5 * (0.4 * time).cos(), 7.0, 2.5 * (0.4 * time).sin() + 1.0);
    [center - Vec3::new(1.5, 0.0, 1.5), Vec3::X * 3.0, Vec3::Z * 3.0]
}

/// The same for umbra4, with 16 × 16 samples.
pub fn area_light(time: f32) -> Result<AreaLight, LightError> {
    let [corner, u, v] = lamp(time).map(Vec3::as_dvec3);
    AreaLight::new(corner, u, v, 16, 16)
}

/// The world, with everything that moves in it.
pub fn bounds() -> Bounds {
    Bounds { min: DVec3::new(-12.0, -1.0, -12.0), max: DVec3::new(12.0, 8.0, 12.0) }
}
