//! Scenes of casters: random, deterministic, and made so that hits fall on borders of texels, on edges that triangles share, on corners.

use umbra4_core::{LatticeLight, glam::IVec3, plane_offset::MOST_OFFSET, texture::MOST_SPAN};

use crate::{
    caster_oracle::{
        OracleCaster, OracleReceiver, OracleSurface,
        depth::OPAQUE,
        texel::{Corners, OracleTexture, Wrap},
    },
    meshes::{Mesh, cuboid, icosphere},
    rng::Rng,
    scene::REACH,
    scenes::{self, SampleGrid},
};

/// A scene given by the integers that decide its bits.
#[derive(Clone, Debug)]
pub struct CasterScene {
    /// Light.
    pub light: LatticeLight,
    /// Receivers.
    pub receivers: Vec<OracleReceiver>,
    /// Casters.
    pub casters: Vec<OracleCaster>,
}

/// A generator: a scene whose light has the given samples.
pub type Generator = fn(&mut Rng, SampleGrid) -> CasterScene;

/// All generators, by name.
pub const GENERATORS: [(&str, Generator); 14] = [
    ("dressed_soup", |rng, samples| dressed(rng, scenes::soup, samples)),
    ("dressed_tiny", |rng, samples| dressed(rng, scenes::tiny, samples)),
    ("dressed_outermost", |rng, samples| dressed(rng, scenes::outermost, samples)),
    ("dressed_slivers", |rng, samples| dressed(rng, scenes::slivers, samples)),
    ("dressed_zero_area", |rng, samples| dressed(rng, scenes::zero_area, samples)),
    ("dressed_coarse_grid", |rng, samples| dressed(rng, scenes::coarse_grid, samples)),
    ("dressed_in_planes", |rng, samples| dressed(rng, scenes::in_planes, samples)),
    ("dressed_across_planes", |rng, samples| dressed(rng, scenes::across_planes, samples)),
    ("dressed_full_coverage", |rng, samples| dressed(rng, scenes::full_coverage, samples)),
    ("dressed_crowd", |rng, samples| dressed(rng, scenes::crowd, samples)),
    ("cards", cards),
    ("panes", panes),
    ("closed_casters", closed_casters),
    ("slabs", slabs),
];

/// Sample grids whose rows a word of `bits` holds, some of them jittered; large ones are rare, for the oracle's sake.
pub fn grid(rng: &mut Rng, bits: u32) -> SampleGrid {
    const GRIDS: [(u32, u32); 8] = [(1, 1), (5, 7), (16, 16), (32, 9), (9, 32), (3, 17), (1, 16), (7, 33)];
    loop {
        let (rows, columns) = if rng.one_in(25) { (64, bits) } else { rng.pick(&GRIDS) };
        if columns <= bits {
            let samples = SampleGrid::regular(rows, columns);
            return if rng.one_in(3) { samples.jittered(rng) } else { samples };
        }
    }
}

/// The largest texture coordinate: 2^14 textures.
const FAR: i32 = 1 << 30;

/// The nearest towards zero that an f32 holds.
fn short(x: i64) -> i32 {
    let surplus = (64 - x.unsigned_abs().leading_zeros()).saturating_sub(24);
    let size = (x.unsigned_abs() >> surplus << surplus) as i32;
    if x < 0 { -size } else { size }
}

/// Coordinates of a triangle's corners on a texture of given size: as far from zero, and reaching over as many texels, as is allowed.
fn corners(rng: &mut Rng, size: [u32; 2]) -> Corners {
    let kind = rng.below(8);
    let any = |rng: &mut Rng, extent: i32| [0; 3].map(|_| [0; 2].map(|_| rng.around(extent)));
    let mut corners = match kind {
        0 => [[0, 0], [1 << 16, 0], [0, 1 << 16]],
        1 => any(rng, 1 << 16),
        2 => any(rng, 1 << 20),
        3 => any(rng, FAR),
        // All in one texel, or on its border.
        4 => any(rng, 1000),
        5 => [0; 3].map(|_| [0; 2].map(|_| rng.pick(&[-FAR, FAR, 0]))),
        // Corners on borders of texels, exactly where the size is a power of two.
        6 => [0; 3].map(|_| [0, 1].map(|axis| on_border(i64::from(rng.around(4)), size[axis]))),
        _ => {
            let one = rng.around(1 << 18);
            [[one, one + 1]; 3]
        }
    };
    let away = if kind == 3 && rng.one_in(2) { -1 } else { 1 };
    for axis in 0..2 {
        let lowest = corners.iter().map(|uv| i64::from(short(i64::from(uv[axis])))).min().unwrap_or(0);
        let most = (i64::from(MOST_SPAN - 1) << 16) / i64::from(size[axis]);
        for uv in &mut corners {
            // What is shortened moves by at most 64.
            uv[axis] = away * short(i64::from(uv[axis]).min(lowest + (most - 64).max(0)));
        }
    }
    corners
}

/// The coordinate of border `k` of `size` texels, on 2^-16.
fn on_border(k: i64, size: u32) -> i32 {
    short((k * (1 << 17) + i64::from(size)).div_euclid(2 * i64::from(size)))
}

fn wraps(rng: &mut Rng) -> [Wrap; 2] {
    [0; 2].map(|_| rng.pick(&[Wrap::Repeat, Wrap::Clamp]))
}

fn size(rng: &mut Rng) -> [u32; 2] {
    const SIDES: [u32; 9] = [1, 2, 3, 4, 5, 7, 16, 64, 100];
    match rng.below(12) {
        0 => [1, 1],
        1 => [rng.pick(&[1000, 1 << 14]), rng.pick(&[1, 3])],
        2 => [3, 1000],
        _ => [rng.pick(&SIDES), rng.pick(&SIDES)],
    }
}

fn texture<T>(rng: &mut Rng, [width, height]: [u32; 2], mut texel: impl FnMut(&mut Rng) -> T) -> OracleTexture<T> {
    let texels = (0..width * height).map(|_| texel(rng)).collect();
    OracleTexture { width, height, texels, wrap: wraps(rng) }
}

fn cutout(rng: &mut Rng, triangles: usize) -> OracleSurface {
    let size = size(rng);
    let threshold = rng.pick(&[1, 127, 128, 255, 128]);
    // Alphas of all sizes, or next to the threshold.
    let near = rng.one_in(2);
    let texture = texture(rng, size, |rng| match near {
        true => threshold - rng.below(2) as u8,
        false => rng.next_u64() as u8,
    });
    let coordinates = (0..triangles).map(|_| corners(rng, size)).collect();
    // A threshold that everything passes is legal.
    let threshold = if rng.one_in(20) { 0 } else { threshold };
    OracleSurface::Cutout { texture, coordinates, threshold }
}

fn depths(rng: &mut Rng) -> [u16; 3] {
    [0; 3].map(|_| match rng.below(8) {
        0 => 0,
        1 => OPAQUE,
        2 => OPAQUE - 1,
        3 => rng.next_u64() as u16,
        4 => rng.below(3) as u16,
        _ => rng.below(8 * 2048) as u16,
    })
}

fn tinted(rng: &mut Rng, triangles: usize) -> OracleSurface {
    if rng.one_in(3) {
        return OracleSurface::Tinted { texture: OracleTexture::one(depths(rng)), coordinates: None };
    }
    let size = size(rng);
    let texture = texture(rng, size, depths);
    let coordinates = Some((0..triangles).map(|_| corners(rng, size)).collect());
    OracleSurface::Tinted { texture, coordinates }
}

/// Layers that some others have nothing in common with.
fn layers(rng: &mut Rng) -> u32 {
    match rng.below(5) {
        0 => 1 << rng.pick(&[0, 1, 16, 31]),
        1 => rng.pick(&[0b10, 0b11 | 1 << 31, !0b10]),
        _ => u32::MAX,
    }
}

fn offset(rng: &mut Rng, extent: i32) -> i32 {
    if rng.one_in(2) { 0 } else { rng.pick(&[1, 2, 7, extent >> 10, extent >> 4]).min(MOST_OFFSET as i32) }
}

/// A caster of given triangles, whatever else it is.
fn caster(rng: &mut Rng, triangles: Vec<[IVec3; 3]>, extent: i32) -> OracleCaster {
    let count = triangles.len();
    let surface = match rng.below(5) {
        0 => OracleSurface::Opaque,
        1 | 2 => cutout(rng, count),
        _ => tinted(rng, count),
    };
    let tinted = matches!(surface, OracleSurface::Tinted { .. });
    let offset = if tinted { 0 } else { offset(rng, extent) };
    OracleCaster { triangles, surface, closed: false, offset, layers: layers(rng) }
}

fn triangles(mesh: &Mesh) -> Vec<[IVec3; 3]> {
    mesh.triangles.iter().map(|t| t.map(|v| mesh.vertices[v as usize])).collect()
}

fn receivers(rng: &mut Rng, points: impl IntoIterator<Item = IVec3>) -> Vec<OracleReceiver> {
    points.into_iter().map(|point| OracleReceiver { point, layers: layers(rng) }).collect()
}

/// A scene of another kind, its triangles dealt out to casters.
fn dressed(rng: &mut Rng, generator: scenes::Generator, samples: SampleGrid) -> CasterScene {
    let scene = generator(rng, samples);
    let extent = scene.receivers.iter().map(|p| p.abs().max_element()).max().unwrap_or(0);
    let mut dealt = vec![vec![]; 1 + rng.below(5)];
    for triangle in triangles(&scene.mesh) {
        let to = rng.below(dealt.len());
        dealt[to].push(triangle);
    }
    let casters = dealt.into_iter().map(|triangles| caster(rng, triangles, extent)).collect();
    CasterScene { light: scene.light, receivers: receivers(rng, scene.receivers), casters }
}

/// A turn that maps axes to axes.
fn turn(rng: &mut Rng) -> impl Fn(IVec3) -> IVec3 + use<> {
    let signs = IVec3::from_array(rng.pick(&[[1, 1, 1], [1, -1, -1], [-1, 1, -1], [-1, -1, 1]]));
    let first = rng.below(3);
    move |p| IVec3::new(p[first], p[(first + 1) % 3], p[(first + 2) % 3]) * signs
}

impl CasterScene {
    fn turned(mut self, rng: &mut Rng) -> Self {
        let turn = turn(rng);
        let LatticeLight { origin, step_u, step_v, .. } = self.light;
        self.light = LatticeLight { origin: turn(origin), step_u: turn(step_u), step_v: turn(step_v), ..self.light };
        self.receivers.iter_mut().for_each(|receiver| receiver.point = turn(receiver.point));
        for corner in self.casters.iter_mut().flat_map(|caster| caster.triangles.as_flattened_mut()) {
            *corner = turn(*corner);
        }
        self
    }

    /// The scene with one caster moved.
    #[must_use]
    pub fn with_moved(&self, caster: usize, by: IVec3) -> Self {
        let mut moved = self.clone();
        for corner in moved.casters[caster].triangles.as_flattened_mut() {
            *corner = (*corner + by).clamp(IVec3::splat(-REACH), IVec3::splat(REACH));
        }
        moved
    }

    /// Number of triangles of all casters.
    pub fn triangles(&self) -> usize {
        self.casters.iter().map(|caster| caster.triangles.len()).sum()
    }
}

/// A lamp over a floor, both of the same coarse grid: a card half-way between them that has its corners on the grid's half units is met
/// by samples on its edges, its corners, and the borders of its texels.
struct Stage {
    light: LatticeLight,
    /// Half of the grid's unit: that of cards.
    half: i32,
    /// Height of the lamp, in halves.
    height: i32,
    /// Halves from the middle to where the light ends, and a little more.
    reach: i32,
}

impl Stage {
    fn new(rng: &mut Rng, samples: SampleGrid) -> Self {
        let SampleGrid { rows, columns, jitter } = samples;
        // Steps are multiples of the least that places need.
        let unit = 1024 << rng.below(8);
        let reach = rows.max(columns) as i32 + 8;
        let height = 2 * rng.pick(&[2, 8, 16, 32]);
        let origin = IVec3::new(-(columns as i32) / 2 * unit, height * unit / 2, -(rows as i32) / 2 * unit);
        let light = LatticeLight { origin, step_u: IVec3::X * unit, step_v: IVec3::Z * unit, rows, columns, jitter };
        Self { light, half: unit / 2, height, reach }
    }

    fn floor(&self, rng: &mut Rng, count: usize) -> Vec<IVec3> {
        let at = |rng: &mut Rng| 2 * rng.around(self.reach / 4) * self.half;
        (0..count).map(|_| IVec3::new(at(rng), 0, at(rng))).collect()
    }
}

/// Two triangles between opposite corners of a rectangle in a plane across an axis, and the coordinates that make `texels` of it.
fn card(rng: &mut Rng, min: IVec3, max: IVec3, axis: usize, texels: [[i32; 2]; 2]) -> [([IVec3; 3], Corners); 2] {
    let (along, across) = ((axis + 1) % 3, (axis + 2) % 3);
    let corner = |k: usize| {
        let [right, up] = [k == 1 || k == 2, k >= 2];
        let mut p = min;
        p[along] = if right { max[along] } else { min[along] };
        p[across] = if up { max[across] } else { min[across] };
        (p, [texels[0][usize::from(right)], texels[1][usize::from(up)]])
    };
    let halves = if rng.one_in(2) { [[0, 1, 2], [0, 2, 3]] } else { [[1, 3, 0], [3, 1, 2]] };
    halves.map(|half| (half.map(|k| corner(k).0), half.map(|k| corner(k).1)))
}

/// Cards across the axes between a lamp and a floor of one grid, textured so that borders of texels, too, lie on it.
pub fn cards(rng: &mut Rng, samples: SampleGrid) -> CasterScene {
    let stage = Stage::new(rng, samples);
    let mut casters = vec![];
    for _ in 0..1 + rng.below(6) {
        let axis = if rng.one_in(4) { rng.pick(&[0, 2]) } else { 1 };
        let at = IVec3::new(rng.around(stage.reach / 2), stage.height / 2, rng.around(stage.reach / 2));
        let extent = [0; 3].map(|_| 1 + rng.below(stage.reach as usize) as i32);
        let (mut min, mut max) = (at, at + IVec3::from_array(extent));
        if axis == 1 {
            // Mostly half-way; or elsewhere, where nothing is on the grid but the axes are.
            min.y = if rng.one_in(4) { 1 + rng.below(stage.height as usize - 1) as i32 } else { stage.height / 2 };
            max.y = min.y;
        } else {
            (min.y, max.y) = (rng.pick(&[0, 1, stage.height / 4]), stage.height * 3 / 4);
            max[axis] = min[axis];
        }
        let (along, across) = ((axis + 1) % 3, (axis + 2) % 3);
        let (min, max) = (min * stage.half, max * stage.half);
        // A texel for each half unit, or every other one; or any number.
        let cells = [along, across].map(|axis| ((max[axis] - min[axis]) / stage.half).max(1) as u32);
        let size = match rng.below(4) {
            0 => [rng.pick(&[1, 2, 4, 8, 16]), rng.pick(&[1, 2, 4, 8, 16])],
            1 => size(rng),
            2 => cells.map(|cells| cells.next_power_of_two()),
            _ => cells,
        };
        let texels = [0, 1].map(|axis| {
            let first = i64::from(rng.around(3));
            let count = if rng.one_in(3) { i64::from(size[axis]) } else { i64::from(cells[axis]) };
            let ends = [first, first + count].map(|k| on_border(k, size[axis]));
            if rng.one_in(3) { [ends[1], ends[0]] } else { ends }
        });
        let (triangles, coordinates): (Vec<_>, Vec<_>) = card(rng, min, max, axis, texels).into_iter().unzip();
        let surface = match rng.below(3) {
            0 => OracleSurface::Tinted { texture: texture(rng, size, depths), coordinates: Some(coordinates) },
            _ => {
                let texture = texture(rng, size, |rng| rng.pick(&[0, 127, 128, 255]));
                OracleSurface::Cutout { texture, coordinates, threshold: 128 }
            }
        };
        let is_tinted = matches!(surface, OracleSurface::Tinted { .. });
        let offset = if is_tinted || !rng.one_in(4) { 0 } else { rng.pick(&[1, stage.half, 3 * stage.half]) };
        casters.push(OracleCaster { triangles, surface, closed: false, offset, layers: layers(rng) });
    }
    let mut points = stage.floor(rng, 24);
    for caster in &casters {
        points.extend(on_triangles(rng, &caster.triangles, stage.half));
    }
    CasterScene { light: stage.light, receivers: receivers(rng, points), casters }.turned(rng)
}

/// Points on a caster: its corner, its edges, in its planes, and one unit and a few beside them.
fn on_triangles(rng: &mut Rng, triangles: &[[IVec3; 3]], near: i32) -> Vec<IVec3> {
    let Some(&[a, b, c]) = triangles.get(rng.below(triangles.len().max(1))) else { return vec![] };
    let in_plane = a + (b - a) / 4 + (c - a) / 4;
    let beside = a + (b - a) / 2 - (c - a) / 4;
    let off = in_plane + rng.point(1);
    vec![a, a + (b - a) / 2, in_plane, beside, off, in_plane + rng.point(near)]
}

/// Panes of glass over one another, each a rectangle of triangles that share edges and corners, which samples lie on.
pub fn panes(rng: &mut Rng, samples: SampleGrid) -> CasterScene {
    let stage = Stage::new(rng, samples);
    let mut casters = vec![];
    for _ in 0..1 + rng.below(5) {
        let height = if rng.one_in(3) { rng.below(stage.height as usize) as i32 } else { stage.height / 2 };
        let min = [0; 2].map(|_| rng.around(stage.reach / 2));
        let extent = [0; 2].map(|_| 2 + rng.below(stage.reach as usize) as i32);
        let mut triangles = pane(rng, min, extent).unwrap_or_default();
        // Level, or rising in steps: a height for every column of corners, so that edges stay shared.
        let slant = IVec3::new(1, rng.pick(&[0, 0, 0, 1, -1]), 1);
        for corner in triangles.as_flattened_mut() {
            let [x, z] = [corner.x, corner.z];
            *corner = IVec3::new(x, height + slant.y * (x - min[0]).min(stage.height) / 8, z) * stage.half;
        }
        // Some are wound the other way.
        triangles.iter_mut().filter(|_| rng.one_in(4)).for_each(|triangle| triangle.swap(0, 1));
        let count = triangles.len();
        let surface = if rng.one_in(8) { cutout(rng, count) } else { tinted(rng, count) };
        casters.push(OracleCaster { surface, layers: layers(rng), ..OracleCaster::opaque(triangles) });
    }
    let mut points = stage.floor(rng, 24);
    for caster in &casters {
        points.extend(on_triangles(rng, &caster.triangles, stage.half));
    }
    CasterScene { light: stage.light, receivers: receivers(rng, points), casters }.turned(rng)
}

/// The rectangle from `min`, of a given extent, in triangles over the plane y = 0: two of them, a fan, or a grid of pairs. None where
/// it has no extent.
pub fn pane(rng: &mut Rng, min: [i32; 2], extent: [i32; 2]) -> Option<Vec<[IVec3; 3]>> {
    let at = |x: i32, z: i32| IVec3::new(min[0] + x, 0, min[1] + z);
    let [width, depth] = extent;
    if width <= 0 || depth <= 0 {
        return None;
    }
    let pair = |rng: &mut Rng, [x, z]: [i32; 2], [right, down]: [i32; 2]| {
        let [a, b, c, d] = [at(x, z), at(right, z), at(right, down), at(x, down)];
        if rng.one_in(2) { [[a, b, c], [a, c, d]] } else { [[a, b, d], [b, c, d]] }
    };
    Some(match rng.below(3) {
        0 => pair(rng, [0, 0], extent).to_vec(),
        1 if width > 1 && depth > 1 => {
            // Around a node inside; all nodes of the border, or its corners alone.
            let middle = at(1 + rng.below(width as usize - 1) as i32, 1 + rng.below(depth as usize - 1) as i32);
            let around = if rng.one_in(2) {
                let along = (0..width).map(|x| at(x, 0)).chain((0..depth).map(|z| at(width, z)));
                let back = (0..width).map(|x| at(width - x, depth)).chain((0..depth).map(|z| at(0, depth - z)));
                along.chain(back).collect()
            } else {
                vec![at(0, 0), at(width, 0), at(width, depth), at(0, depth)]
            };
            (0..around.len()).map(|k| [middle, around[k], around[(k + 1) % around.len()]]).collect()
        }
        _ => {
            let cuts = |rng: &mut Rng, extent: i32| {
                let mut cuts = vec![0, extent];
                cuts.extend((0..3).map(|_| rng.below(extent as usize + 1) as i32));
                cuts.sort_unstable();
                cuts.dedup();
                cuts
            };
            let (columns, rows) = (cuts(rng, width), cuts(rng, depth));
            let mut triangles = vec![];
            for row in rows.windows(2) {
                for column in columns.windows(2) {
                    triangles.extend(pair(rng, [column[0], row[0]], [column[1], row[1]]));
                }
            }
            triangles
        }
    })
}

/// Boxes and balls that have an inside, with receivers in and around them, textured or not, with planes moved or not.
pub fn closed_casters(rng: &mut Rng, samples: SampleGrid) -> CasterScene {
    let extent = 1 << (18 + rng.below(8));
    let light = scenes::light(rng, samples, IVec3::ZERO, extent);
    let (mut casters, mut points) = (vec![], vec![]);
    for _ in 0..1 + rng.below(4) {
        let (at, size) = (rng.point(extent), 64 + rng.around(extent / 2).abs());
        let mut triangles = if rng.one_in(2) {
            triangles(&cuboid(at - IVec3::splat(size), at + IVec3::ONE + (rng.point(size) + size)))
        } else {
            let (jagged, depth) = (rng.one_in(2), rng.below(3) as u32);
            triangles(&icosphere(at, depth, |_| f64::from(size) * if jagged { 0.5 + rng.unit() } else { 1.0 }))
        };
        // Turned inside out now and then: what faces the light is another half.
        if rng.one_in(4) {
            triangles.iter_mut().for_each(|triangle| triangle.swap(1, 2));
        }
        // Adds nothing.
        if rng.one_in(4) {
            let [a, b, _] = triangles[0];
            triangles.push([a, b, a]);
        }
        let count = triangles.len();
        let surface = if rng.one_in(2) { OracleSurface::Opaque } else { cutout(rng, count) };
        points.extend((0..12).map(|_| at + rng.point(size / 2)));
        points.extend(on_triangles(rng, &triangles, 8));
        let closed = !rng.one_in(4);
        casters.push(OracleCaster { triangles, surface, closed, offset: offset(rng, size), layers: layers(rng) });
    }
    points.extend((0..30).map(|_| rng.point(extent)));
    CasterScene { light, receivers: receivers(rng, points), casters }
}

/// Surfaces whose planes are moved by a little, or a lot, with receivers between where they are and where they are moved to; some of
/// them lie across planes through the light, where nothing is moved.
pub fn slabs(rng: &mut Rng, samples: SampleGrid) -> CasterScene {
    let extent = 1 << (18 + rng.below(8));
    let light = scenes::light(rng, samples, IVec3::ZERO, extent / 2);
    let (mut casters, mut points) = (vec![], vec![]);
    for _ in 0..1 + rng.below(5) {
        let mut triangles = vec![];
        let offset = rng.pick(&[1, 3, 64, extent >> 8, extent >> 3, extent]).min(MOST_OFFSET as i32);
        for _ in 0..1 + rng.below(8) {
            let (at, size) = (rng.point(extent), 1 + (extent >> rng.below(4)));
            let mut triangle = [0; 3].map(|_| at + rng.point(size));
            if rng.one_in(4) {
                // Its plane passes a corner of the light: on which side do all samples lie?
                let [i, j] = [light.rows, light.columns].map(|count| rng.pick(&[0, count as i32 - 1, count as i32]));
                triangle[0] = light.origin + light.step_v * i + light.step_u * j
                    - light.step_u / 64 * rng.around(32)
                    - light.step_v / 64 * rng.around(32);
            }
            let sample = light.sample(rng.below(light.rows as usize) as u32, rng.below(light.columns as usize) as u32);
            let [a, b, c] = triangle;
            let inside = a + (b - a) / 4 + (c - a) / 4;
            // On the way from there to a sample, and beyond it; and along each axis.
            let toward = (sample - inside).as_dvec3().normalize_or_zero();
            for far in [0.0, 0.5, 0.99, 1.0, 1.01, 2.0, -0.5] {
                points.push(inside + (toward * far * f64::from(offset)).round().as_ivec3());
            }
            for k in 0..3 {
                points.push(inside + IVec3::AXES[k] * rng.pick(&[offset, offset - 1, offset + 1, -offset]));
            }
            points.extend(on_triangles(rng, &[triangle], offset.min(extent >> 4)));
            triangles.push(triangle);
        }
        let count = triangles.len();
        let surface = if rng.one_in(2) { OracleSurface::Opaque } else { cutout(rng, count) };
        casters.push(OracleCaster { triangles, surface, closed: false, offset, layers: layers(rng) });
    }
    CasterScene { light, receivers: receivers(rng, points), casters }
}
