//! A small world as an engine keeps it, and what it has to become on the lattice, computed here from the world alone.

use umbra4_core::{
    AreaLight, Bounds, Lattice, Lift,
    gbuffer::NormalEncoding,
    glam::{DVec3, IVec3, Mat4, Vec3},
    kernel::{NOWHERE, status::Status},
};
use umbra4_tests::{
    device::{buffer, filled},
    rng::Rng,
};
use umbra4_wgpu::{
    Frame, GBuffer, Gpu, Indices, Instances, Light, Mesh, Resolution, Surface, Vertices,
    wgpu::{Buffer, BufferUsages, IndexFormat, TextureFormat, TextureView},
};

/// Pixels: a width that fills no row of words.
pub const SIZE: [u32; 2] = [37, 11];
const REACH: f64 = 10.0;

pub fn bounds() -> Bounds {
    Bounds { min: DVec3::splat(-REACH), max: DVec3::splat(REACH) }
}

pub fn lattice() -> Lattice {
    Lattice::covering(bounds()).expect("finite bounds")
}

/// A light above the scene that shines down.
pub fn light(rows: u32, columns: u32, x: f64) -> AreaLight {
    AreaLight::new(DVec3::new(x, 6.0, -1.0), DVec3::X * 2.0, DVec3::Z * 1.5, rows, columns).expect("a light with area")
}

struct OwnMesh {
    vertices: Buffer,
    offset: u64,
    stride: u64,
    count: u32,
    indices: Option<(Buffer, IndexFormat, u32, u32, i32)>,
    instances: Option<(Buffer, u64, u64, u32)>,
}

/// What the lattice has to hold.
#[derive(Clone, Debug, Default)]
pub struct Expected {
    pub vertices: Vec<[i32; 3]>,
    pub triangles: Vec<[u32; 3]>,
    pub receivers: Vec<[i32; 3]>,
    pub status: Status,
}

impl Expected {
    /// The triangles that can block: all of whose corners are there.
    pub fn corners(&self) -> Vec<[IVec3; 3]> {
        let corner = |v: u32| self.vertices.get(v as usize).filter(|p| **p != NOWHERE).map(|p| IVec3::from_array(*p));
        self.triangles.iter().filter_map(|[a, b, c]| Some([corner(*a)?, corner(*b)?, corner(*c)?])).collect()
    }
}

/// Everything an engine keeps.
pub struct World {
    meshes: Vec<OwnMesh>,
    positions: TextureView,
    normals: TextureView,
    encoding: NormalEncoding,
    lift: Lift,
    /// Before they were encoded.
    pub pixel_normals: Vec<Vec3>,
    pub expected: Expected,
}

/// How many of what a world is made to have.
#[derive(Clone, Copy)]
pub struct Wish {
    pub triangles: u32,
    /// One in so many vertices, indices and pixels cannot be used.
    pub bad: usize,
    pub encoding: NormalEncoding,
}

struct Maker<'a> {
    gpu: &'a Gpu,
    rng: Rng,
    bad: usize,
    lattice: Lattice,
    expected: Expected,
}

fn finite(p: Vec3, lattice: &Lattice) -> Option<IVec3> {
    lattice.snap(p).ok()
}

impl Maker<'_> {
    fn bad(&mut self) -> bool {
        self.bad > 0 && self.rng.one_in(self.bad)
    }

    /// A point between the light and the receivers, now and then one that no lattice holds.
    fn vertex(&mut self) -> Vec3 {
        let p = Vec3::new(self.rng.real(4.0) as f32, 1.0 + 3.0 * self.rng.unit() as f32, self.rng.real(4.0) as f32);
        match self.bad() {
            true => self.rng.pick(&[
                Vec3::new(f32::NAN, p.y, p.z),
                Vec3::new(p.x, f32::INFINITY, p.z),
                Vec3::new(p.x, p.y, 1.0e9),
                Vec3::new(f32::MIN, p.y, p.z),
            ]),
            false => p,
        }
    }

    fn expect_vertex(&mut self, p: Vec3) {
        let point = finite(p, &self.lattice);
        self.expected.status.vertices += u32::from(point.is_none());
        self.expected.vertices.push(point.map_or(NOWHERE, |p| p.to_array()));
    }

    /// Vertices with other data around them.
    fn interleaved(&mut self, points: &[Vec3], offset: usize, stride: usize) -> Buffer {
        let mut bytes = vec![0xff; offset + points.len() * stride];
        for (place, p) in bytes[offset..].chunks_exact_mut(stride).zip(points) {
            place[..12].copy_from_slice(bytemuck::bytes_of(&p.to_array()));
        }
        buffer(self.gpu, &bytes, BufferUsages::STORAGE | BufferUsages::VERTEX)
    }

    /// Triangles without indices, in world space.
    fn plain(&mut self, triangles: u32) -> OwnMesh {
        let points: Vec<Vec3> = (0..3 * triangles).map(|_| self.vertex()).collect();
        let base = self.expected.vertices.len() as u32;
        points.iter().for_each(|&p| self.expect_vertex(p));
        self.expected.triangles.extend((0..triangles).map(|t| [0, 1, 2].map(|k| base + 3 * t + k)));
        let vertices = self.interleaved(&points, 0, 12);
        OwnMesh { vertices, offset: 0, stride: 12, count: 3 * triangles, indices: None, instances: None }
    }

    /// Indexed triangles among vertices with other data around them, drawn once or, moved, several times.
    fn indexed(&mut self, triangles: u32, format: IndexFormat, instances: u32) -> OwnMesh {
        let count = triangles / 2 + 3;
        let points: Vec<Vec3> = (0..count).map(|_| self.vertex()).collect();
        let (offset, stride, base_vertex, first) = (264 + 4 * 3, 28, -5, 3);
        let vertices = self.interleaved(&points, offset, stride);
        let matrices: Vec<Mat4> = (0..instances)
            .map(|k| {
                let moved = Vec3::new(self.rng.real(1.0) as f32, self.rng.real(0.5) as f32, self.rng.real(1.0) as f32);
                Mat4::from_translation(moved) * Mat4::from_rotation_y(k as f32)
            })
            .collect();
        let base = self.expected.vertices.len() as u32;
        if instances == 0 {
            points.iter().for_each(|&p| self.expect_vertex(p));
        }
        for m in &matrices {
            // Sums from left to right, as the kernel has them.
            let row = |p: Vec3, r: usize| m.x_axis[r] * p.x + m.y_axis[r] * p.y + m.z_axis[r] * p.z + m.w_axis[r];
            points.iter().for_each(|&p| self.expect_vertex(Vec3::new(row(p, 0), row(p, 1), row(p, 2))));
        }
        let mut indices = vec![7_u32; first as usize];
        let mut own = Vec::new();
        for _ in 0..triangles {
            let mut corners = [0; 3].map(|_| self.rng.below(count as usize) as i64);
            if self.bad() {
                corners[self.rng.below(3)] = self.rng.pick(&[-1, -5, i64::from(count), 60_000]);
            }
            // The index of a vertex below the base wraps round, as it does in a draw.
            let written = corners.map(|corner| (corner - i64::from(base_vertex)) as u32);
            indices.extend(written);
            own.push(corners.iter().all(|c| (0..i64::from(count)).contains(c)).then(|| corners.map(|c| c as u32)));
        }
        for instance in 0..instances.max(1) {
            for corners in &own {
                self.expected.status.triangles += u32::from(corners.is_none());
                let base = base + instance * count;
                self.expected.triangles.push(corners.map_or([u32::MAX; 3], |c| c.map(|v| base + v)));
            }
        }
        let narrow: Vec<u16> = indices.iter().map(|&i| i as u16).collect();
        let bytes: &[u8] = match format {
            IndexFormat::Uint16 => bytemuck::cast_slice(&narrow),
            IndexFormat::Uint32 => bytemuck::cast_slice(&indices),
        };
        let index_buffer = buffer(self.gpu, bytes, BufferUsages::STORAGE | BufferUsages::INDEX);
        let bytes: Vec<u8> =
            matrices.iter().flat_map(|m| [bytemuck::bytes_of(&m.to_cols_array()), &[0xee; 16]].concat()).collect();
        let instance_buffer = buffer(self.gpu, &[&[0xdd; 20][..], &bytes].concat(), BufferUsages::STORAGE);
        OwnMesh {
            vertices,
            offset: offset as u64,
            stride: stride as u64,
            count,
            indices: Some((index_buffer, format, first, 3 * triangles, base_vertex)),
            instances: (instances > 0).then_some((instance_buffer, 20, 80, instances)),
        }
    }

    /// A receiver near the ground: its texels, and what it has to become.
    fn pixel(&mut self, lift: Lift) -> ([f32; 4], Vec3, [i32; 3]) {
        let p = Vec3::new(self.rng.real(5.0) as f32, self.rng.real(0.4) as f32, self.rng.real(5.0) as f32);
        let (axis, sign) = (self.rng.below(3), if self.rng.one_in(2) { 1 } else { -1 });
        let mut normal = [0, 1, 2].map(|_| self.rng.real(0.6) as f32);
        normal[axis] = 0.9 * sign as f32;
        let normal = Vec3::from_array(normal);
        if self.rng.one_in(9) {
            // Nothing is seen.
            return ([p.x, p.y, p.z, 0.0], normal, NOWHERE);
        }
        if self.bad() {
            self.expected.status.receivers += 1;
            let bad = self.rng.pick(&[f32::NAN, f32::NEG_INFINITY, 1.0e6]);
            return ([p.x, bad, p.z, 1.0], normal, NOWHERE);
        }
        let mut point = self.lattice.snap(p).expect("it is inside").to_array();
        point[axis] += sign * lift.steps();
        ([p.x, p.y, p.z, 1.0], normal, point)
    }
}

fn octahedral(n: Vec3) -> [f32; 2] {
    let n = n / (n.x.abs() + n.y.abs() + n.z.abs());
    let sign = |x: f32| if x >= 0.0 { 1.0 } else { -1.0 };
    if n.z >= 0.0 { [n.x, n.y] } else { [(1.0 - n.y.abs()) * sign(n.x), (1.0 - n.x.abs()) * sign(n.y)] }
}

fn encoded(gpu: &Gpu, normals: &[Vec3], encoding: NormalEncoding) -> TextureView {
    match encoding {
        NormalEncoding::Signed => {
            let texels: Vec<[f32; 4]> = normals.iter().map(|n| [n.x, n.y, n.z, 0.0]).collect();
            filled(gpu, SIZE, TextureFormat::Rgba32Float, bytemuck::cast_slice(&texels))
        }
        NormalEncoding::Biased => {
            let byte = |c: f32| ((c * 0.5 + 0.5) * 255.0).round() as u8;
            let texels: Vec<[u8; 4]> = normals.iter().map(|n| [byte(n.x), byte(n.y), byte(n.z), 0]).collect();
            filled(gpu, SIZE, TextureFormat::Rgba8Unorm, bytemuck::cast_slice(&texels))
        }
        NormalEncoding::Octahedral => {
            let texels: Vec<[f32; 2]> = normals.iter().map(|n| octahedral(*n)).collect();
            filled(gpu, SIZE, TextureFormat::Rg32Float, bytemuck::cast_slice(&texels))
        }
    }
}

impl World {
    pub fn new(gpu: &Gpu, seed: u64, wish: Wish) -> Self {
        let lattice = lattice();
        let lift = Lift::f32_positions_off_by(2).expect("1 to 8 units");
        let rng = Rng::new(seed);
        let mut maker = Maker { gpu, rng, bad: wish.bad, lattice, expected: Expected::default() };
        let part = wish.triangles / 4;
        let meshes = vec![
            maker.indexed(part, IndexFormat::Uint16, 0),
            maker.plain(part),
            maker.indexed(part / 3, IndexFormat::Uint32, 3),
            maker.indexed(part | 1, IndexFormat::Uint16, 1),
        ];
        let pixels: Vec<_> = (0..SIZE[0] * SIZE[1]).map(|_| maker.pixel(lift)).collect();
        let texels: Vec<[f32; 4]> = pixels.iter().map(|(texel, ..)| *texel).collect();
        let normals: Vec<Vec3> = pixels.iter().map(|(_, normal, _)| *normal).collect();
        maker.expected.receivers = pixels.iter().map(|(.., point)| *point).collect();
        Self {
            meshes,
            positions: filled(gpu, SIZE, TextureFormat::Rgba32Float, bytemuck::cast_slice(&texels)),
            normals: encoded(gpu, &normals, wish.encoding),
            encoding: wish.encoding,
            lift,
            pixel_normals: normals,
            expected: maker.expected,
        }
    }

    pub fn meshes(&self) -> Vec<Mesh<'_>> {
        let meshes = self.meshes.iter();
        meshes
            .map(|own| Mesh {
                vertices: Vertices { buffer: &own.vertices, offset: own.offset, stride: own.stride, count: own.count },
                indices: own.indices.as_ref().map(|(buffer, format, first, count, base_vertex)| Indices {
                    buffer,
                    format: *format,
                    first: *first,
                    count: *count,
                    base_vertex: *base_vertex,
                }),
                instances: own.instances.as_ref().map(|(buffer, offset, stride, count)| Instances {
                    buffer,
                    offset: *offset,
                    stride: *stride,
                    count: *count,
                }),
            })
            .collect()
    }

    /// The frame of this world with some lights.
    pub fn frame<'a>(&'a self, meshes: &'a [Mesh<'a>], lights: &'a [Light<'a>]) -> Frame<'a> {
        Frame { bounds: bounds(), meshes, gbuffer: self.gbuffer(), resolution: Resolution::Full, lights }
    }

    pub fn gbuffer(&self) -> GBuffer<'_> {
        GBuffer {
            surface: Surface::Positions { view: &self.positions, lift: self.lift },
            normals: &self.normals,
            encoding: self.encoding,
            triangles: None,
            sample: 0,
        }
    }
}
