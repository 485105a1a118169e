//! Keys of a mesh's triangles and edges from those of its vertices: for executors with room to keep these, so that nothing is
//! divided twice. A triangle's own keys are then made as often as they are asked for.

use glam::IVec3;

use crate::{
    edge_plane::LightGrid,
    frame::LightFrame,
    lanes::{Lanes, Sixteen},
    occluder::{Facing, LightSides, Occluder},
    proj4::{KEYS, KeyTile, Keys, NODE, NOTHING, TOUCHING, quotient_above, reaches, triangle_keys},
};

/// What a vertex brings to the keys of its triangles and edges, for a light and for the light of its first sample alone.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(align(32))] // no more than a line of the cache
pub struct VertexKeys {
    /// Slopes from the first column, from the last (negated), from the first row, from the last (negated); the height
    /// (negated); slopes from the first column and the first row, negated.
    keys: [f32; 8],
}

impl VertexKeys {
    /// Of one vertex. Without use where it reaches the light plane: [`VertexKeys::touches`].
    #[inline]
    pub fn new(frame: &LightFrame, p: IVec3) -> Self {
        let q = frame.place(p);
        let (low, high) = (q.w - q.error_w, q.w + q.error_w);
        let (inverse_low, inverse_high) = (Lanes::recip(Lanes::max(low, TOUCHING)), Lanes::recip(high));
        let above = |x: f32| quotient_above(x, inverse_low, inverse_high);
        let [a, last_a, b, last_b] = reaches(frame, &q).map(above);
        Self { keys: [a, last_a, b, last_b, -low, above(q.error_a - q.a), above(q.error_b - q.b), 0.0] }
    }

    /// The keys of everything between vertices are the largest of theirs.
    #[inline(always)]
    #[must_use]
    pub fn and(&self, other: &Self) -> Self {
        let mut keys = [0.0; 8];
        let mut k = 0;
        while k < 8 {
            keys[k] = Lanes::max(self.keys[k], other.keys[k]);
            k += 1;
        }
        Self { keys }
    }

    /// Whether a vertex touches the light plane, or lies behind it: slopes have no bound.
    #[inline(always)]
    pub fn touches(&self) -> bool {
        touches(self.keys[4])
    }

    /// Keys for the light.
    #[inline(always)]
    pub fn for_light(&self) -> Keys {
        let [a, last_a, b, last_b, low, ..] = self.keys;
        [a, last_a, b, last_b, low]
    }
}

/// The same, told from the height among its keys.
#[inline(always)]
fn touches(height: f32) -> bool {
    height > -TOUCHING
}

/// Sixteen triangles of a mesh, or fewer: what they have in memory brought together, lane-major.
#[derive(Clone, Copy, Debug)]
pub struct TriangleTile {
    /// `corners[corner][axis][lane]`.
    corners: [[[i32; NODE]; 3]; 3],
    /// Largest keys of the corners: `between[key][lane]`.
    between: [[f32; NODE]; 8],
    /// Bit n: lane n holds a triangle.
    lanes: u32,
}

impl TriangleTile {
    const EMPTY: Self = Self { corners: [[[0; NODE]; 3]; 3], between: [[f32::MIN; NODE]; 8], lanes: 0 };

    /// The corners of lane `lane % 16`.
    #[inline(always)]
    fn corners(&self, lane: usize) -> [IVec3; 3] {
        self.corners.map(|[x, y, z]| IVec3::new(x[lane % NODE], y[lane % NODE], z[lane % NODE]))
    }

    /// Lanes with a corner that touches the light plane, or lies behind it.
    #[inline(always)]
    fn touching(&self) -> u32 {
        let mut bits = 0;
        for (lane, key) in self.between[4].iter().enumerate() {
            bits |= u32::from(touches(*key)) << lane;
        }
        bits & self.lanes
    }

    /// The keys `which` of the corners; those of a lane that touches the light plane are made from its corners, by `frame`.
    #[inline(always)]
    fn keys(&self, which: [usize; KEYS], frame: &LightFrame) -> KeyTile {
        let mut tile = KeyTile { keys: which.map(|key| self.between[key % 8]) };
        for lane in lanes_of(self.touching()) {
            tile.set(lane, &triangle_keys(frame, &self.corners(lane)).unwrap_or(NOTHING));
        }
        tile
    }

    /// Lane `lane % 16` as an occluder, if the light lies on that side of it.
    #[inline(always)]
    pub fn occluder(&self, lane: usize, facing: Facing) -> Option<Occluder> {
        facing.occluder(self.corners(lane))
    }
}

/// The bits that are set, from the lowest on.
#[inline(always)]
fn lanes_of(mut bits: u32) -> impl Iterator<Item = usize> {
    core::iter::from_fn(move || {
        let lane = bits.trailing_zeros();
        bits &= bits.wrapping_sub(1);
        if lane < u32::BITS { Some(lane as usize) } else { None }
    })
}

/// A mesh as one light sees it.
#[derive(Clone, Copy, Debug)]
pub struct KeyedMesh<'a> {
    grid: &'a LightGrid,
    sides: LightSides,
    vertices: &'a [IVec3],
    triangles: &'a [[u32; 3]],
    keys: &'a [VertexKeys],
}

impl<'a> KeyedMesh<'a> {
    /// Of vertices on the lattice with their keys, as many, and the vertex indices of triangles.
    pub fn new(grid: &'a LightGrid, vertices: &'a [IVec3], triangles: &'a [[u32; 3]], keys: &'a [VertexKeys]) -> Self {
        Self { grid, sides: LightSides::new(&grid.light), vertices, triangles, keys }
    }

    /// The first sixteen of the triangles `ids`. Those that do not exist, or name vertices that do not, leave their lanes empty.
    #[inline(always)]
    pub fn tile(&self, ids: impl Iterator<Item = usize>) -> TriangleTile {
        let mut tile = TriangleTile::EMPTY;
        // Loads of all lanes before what depends on them: their misses overlap.
        let mut triangles = [[0; 3]; NODE];
        for (lane, (triangle, id)) in triangles.iter_mut().zip(ids).enumerate() {
            if let Some(found) = self.triangles.get(id) {
                *triangle = *found;
                tile.lanes |= 1 << lane;
            }
        }
        for (lane, triangle) in triangles.iter().enumerate() {
            let mut between = VertexKeys { keys: [f32::MIN; 8] };
            for (corner, vertex) in tile.corners.iter_mut().zip(triangle) {
                let vertex = *vertex as usize;
                let (Some(p), Some(keys)) = (self.vertices.get(vertex), self.keys.get(vertex)) else {
                    tile.lanes &= !(1 << lane);
                    break;
                };
                for (axis, value) in corner.iter_mut().zip(p.to_array()) {
                    axis[lane] = value;
                }
                between = between.and(keys);
            }
            if tile.lanes >> lane & 1 == 1 {
                for (key, value) in tile.between.iter_mut().zip(between.keys) {
                    key[lane] = value;
                }
            }
        }
        tile
    }

    /// Keys for the light. [`NOTHING`] for what lies behind it, and for empty lanes.
    #[inline(always)]
    pub fn light_keys(&self, tile: &TriangleTile) -> KeyTile {
        tile.keys([0, 1, 2, 3, 4], &self.grid.frame)
    }

    /// Keys for the light of the first sample, of which `corner` is the frame.
    #[inline(always)]
    pub fn corner_keys(&self, tile: &TriangleTile, corner: &LightFrame) -> KeyTile {
        tile.keys([0, 5, 2, 6, 4], corner)
    }

    /// On which side of every triangle the light lies, `keys` being theirs for the light; [`Facing::Nothing`] where those are
    /// [`NOTHING`].
    #[inline(always)]
    pub fn facings(&self, tile: &TriangleTile, keys: &KeyTile) -> [Facing; NODE] {
        let [front, back, mixed] = self.sides.sure::<Sixteen>(&tile.corners);
        let mut facings = [Facing::Nothing; NODE];
        for lane in lanes_of(tile.lanes) {
            if keys.entry(lane) == NOTHING {
                continue;
            }
            let is_in = |lanes: u32| lanes >> lane & 1 == 1;
            // What is degenerate has no doubt, and seems to be all at once.
            facings[lane % NODE] = match (is_in(front), is_in(back), is_in(mixed)) {
                (true, false, false) => Facing::Front,
                (false, true, false) => Facing::Back,
                (false, false, true) => Facing::Mixed,
                _ => Facing::of(&self.grid.light, tile.corners(lane)),
            };
        }
        facings
    }

    /// Keys of the edge between two vertices.
    #[inline]
    pub fn edge_keys(&self, from: u32, to: u32) -> Keys {
        let ends = [from, to].map(|vertex| self.vertices.get(vertex as usize).zip(self.keys.get(vertex as usize)));
        let [Some((&from, from_keys)), Some((&to, to_keys))] = ends else { return NOTHING };
        let between = from_keys.and(to_keys);
        if between.touches() {
            return triangle_keys(&self.grid.frame, &[from, to, to]).unwrap_or(NOTHING);
        }
        between.for_light()
    }
}
