//! Triangles of one light: keyed, put in order and packed under their hierarchy.

use std::iter::once;

use bytemuck::allocation::zeroed_vec;
use rayon::prelude::*;
use umbra4_core::{
    edge_plane::LightGrid,
    frame::LightFrame,
    hierarchy::Levels,
    keyed_mesh::{KeyedMesh, TriangleTile, VertexKeys},
    occluder::{Facing, Occluder},
    order::{Entry, code},
    proj4::{KeyTile, Keys, NODE, NOTHING},
};

use crate::{
    Occluders,
    open_sides::Side,
    order::{fitted, sort},
};

/// Leaves that are worth a job.
const LEAVES_A_JOB: usize = 256;

/// What the triangles of a scene are to a light.
#[derive(Default)]
pub(crate) struct KeyedTriangles {
    vertex_keys: Vec<VertexKeys>,
    /// By index.
    pub(crate) facings: Vec<Facing>,
    /// Of all; once they are packed, of those that count, along the curve.
    pub(crate) order: Vec<Entry>,
    /// The boundary of those that face the light, where neighbours are known.
    pub(crate) open_sides: Option<Vec<Side>>,
}

/// Triangles in order, and the lowest level of their hierarchy.
#[derive(Default)]
pub(crate) struct PackedTriangles {
    pub(crate) occluders: Vec<Occluder>,
    /// Room for the levels above is left.
    pub(crate) nodes: Vec<KeyTile>,
    /// The same for the light's first sample, where mixed triangles stand for nothing; empty unless asked for.
    pub(crate) corner_nodes: Vec<KeyTile>,
}

impl KeyedTriangles {
    /// Keys of the vertices alone.
    pub(crate) fn of_vertices(grid: &LightGrid, scene: &Occluders) -> Self {
        let vertex_keys = scene.vertices().par_iter().map(|vertex| VertexKeys::new(&grid.frame, *vertex)).collect();
        Self { vertex_keys, ..Self::default() }
    }

    /// The mesh with its keys.
    pub(crate) fn mesh<'a>(&'a self, grid: &'a LightGrid, scene: &'a Occluders) -> KeyedMesh<'a> {
        KeyedMesh::new(grid, scene.vertices(), scene.triangles(), &self.vertex_keys)
    }

    /// Every triangle's side and code.
    pub(crate) fn code(&mut self, grid: &LightGrid, scene: &Occluders) {
        let count = scene.triangles().len();
        let (mut facings, mut order) = (vec![Facing::Nothing; count], vec![Entry::default(); count]);
        let mesh = self.mesh(grid, scene);
        let codes = fitted(&grid.frame, count, |id| {
            let keys = mesh.light_keys(&mesh.tile(once(id))).entry(0);
            if keys == NOTHING { None } else { Some(keys) }
        });
        let leaves =
            facings.par_chunks_mut(NODE).zip(order.par_chunks_mut(NODE)).with_min_len(LEAVES_A_JOB).enumerate();
        leaves.for_each(|(leaf, (facings, order))| {
            let first = leaf * NODE;
            let tile = mesh.tile(first..first + facings.len());
            let keys = mesh.light_keys(&tile);
            let found = mesh.facings(&tile, &keys);
            for (lane, (facing, entry)) in facings.iter_mut().zip(order).enumerate() {
                let (keys, index) = (keys.entry(lane), (first + lane) as u32);
                if found[lane] == Facing::Nothing {
                    *entry = Entry { code: Entry::ABSENT, index };
                } else {
                    *facing = found[lane];
                    *entry = Entry { code: code(&codes, &keys), index };
                }
            }
        });
        (self.facings, self.order) = (facings, order);
    }

    /// All of them with their keys, by index: what the grid takes.
    pub(crate) fn by_index(&self, grid: &LightGrid, scene: &Occluders) -> Vec<Option<(Keys, Occluder)>> {
        let (mesh, count) = (self.mesh(grid, scene), scene.triangles().len());
        let leaves = (0..count.div_ceil(NODE)).into_par_iter();
        leaves.flat_map_iter(|leaf| keyed(&mesh, leaf * NODE..count.min((leaf + 1) * NODE))).collect()
    }

    /// Puts them in order, and packs them; by their keys for the light's first sample, too, where the frame of that light is
    /// given.
    pub(crate) fn pack(
        &mut self,
        grid: &LightGrid,
        scene: &Occluders,
        levels: &Levels,
        corner: Option<&LightFrame>,
    ) -> PackedTriangles {
        sort(&mut self.order);
        // Those that take no part come last.
        self.order.truncate(self.order.partition_point(|entry| entry.code != Entry::ABSENT));
        let (mesh, leaves) = (self.mesh(grid, scene), self.order.par_chunks(NODE));
        PackedTriangles::of(self.order.len(), levels, corner, leaves, |entries, leaf| {
            let mut facings = [Facing::Nothing; NODE];
            for (facing, entry) in facings.iter_mut().zip(entries) {
                *facing = self.facings[entry.index as usize];
            }
            let tile = mesh.tile(entries.iter().map(|entry| entry.index as usize));
            let keys = mesh.light_keys(&tile);
            leaf.fill(&mesh, &tile, keys, &facings);
        })
    }

    /// Every triangle's side, and all of them packed as they lie: what takes no part leaves a gap.
    pub(crate) fn pack_in_place(
        &mut self,
        grid: &LightGrid,
        scene: &Occluders,
        levels: &Levels,
        corner: Option<&LightFrame>,
    ) -> PackedTriangles {
        let count = scene.triangles().len();
        let mut facings = vec![Facing::Nothing; count];
        let (mesh, leaves) = (self.mesh(grid, scene), facings.par_chunks_mut(NODE).enumerate());
        let packed = PackedTriangles::of(count, levels, corner, leaves, |(index, facings), leaf| {
            let first = index * NODE;
            let tile = mesh.tile(first..first + facings.len());
            let keys = mesh.light_keys(&tile);
            let found = mesh.facings(&tile, &keys);
            facings.copy_from_slice(&found[..facings.len()]);
            leaf.fill(&mesh, &tile, keys, &found);
        });
        self.facings = facings;
        packed
    }

    /// The mixed ones, with their keys.
    pub(crate) fn mixed(&self, grid: &LightGrid, scene: &Occluders) -> Vec<(Occluder, Keys)> {
        let mesh = self.mesh(grid, scene);
        let facings = self.facings.par_iter().enumerate().with_min_len(NODE * LEAVES_A_JOB);
        let ids: Vec<usize> = facings.filter(|(_, facing)| **facing == Facing::Mixed).map(|(id, _)| id).collect();
        let found = ids.par_chunks(NODE).flat_map_iter(|ids| keyed(&mesh, ids.iter().copied()));
        found.flatten_iter().map(|(keys, occluder)| (occluder, keys)).collect()
    }
}

/// Where sixteen triangles are packed.
pub(crate) struct Leaf<'a> {
    occluders: &'a mut [Occluder],
    keys: &'a mut KeyTile,
    corner: Option<(&'a LightFrame, &'a mut KeyTile)>,
}

impl Leaf<'_> {
    /// One triangle; `lane` is one of the leaf's.
    pub(crate) fn put(&mut self, lane: usize, keys: &Keys, occluder: Occluder) {
        self.occluders[lane] = occluder;
        self.keys.set(lane, keys);
    }

    /// With triangles, their keys for the light, and their sides of it.
    fn fill(self, mesh: &KeyedMesh<'_>, tile: &TriangleTile, keys: KeyTile, facings: &[Facing; NODE]) {
        for (lane, (occluder, facing)) in self.occluders.iter_mut().zip(facings).enumerate() {
            *occluder = tile.occluder(lane, *facing).unwrap_or(Occluder::NONE);
        }
        let without = |mut keys: KeyTile, out: fn(Facing) -> bool| {
            for (lane, _) in facings.iter().enumerate().filter(|(_, facing)| out(**facing)) {
                keys.set(lane, &NOTHING);
            }
            keys
        };
        *self.keys = without(keys, |facing| facing == Facing::Nothing);
        if let Some((frame, keys)) = self.corner {
            *keys = without(mesh.corner_keys(tile, frame), |facing| facing.direction() == 0);
        }
    }
}

impl PackedTriangles {
    /// Of `count` triangles: `fill` is called with each of `leaves` and its room.
    pub(crate) fn of<T: Send>(
        count: usize,
        levels: &Levels,
        corner: Option<&LightFrame>,
        leaves: impl IndexedParallelIterator<Item = T>,
        fill: impl Fn(T, Leaf<'_>) + Sync + Send,
    ) -> Self {
        let mut occluders: Vec<Occluder> = zeroed_vec(count);
        let mut nodes = vec![KeyTile::NOTHING; levels.tiles()];
        let mut corner_nodes = vec![KeyTile::NOTHING; if corner.is_some() { levels.tiles() } else { 0 }];
        let rooms = occluders.par_chunks_mut(NODE).zip(&mut nodes);
        let leaves = leaves.zip(rooms).with_min_len(LEAVES_A_JOB);
        if let Some(frame) = corner {
            leaves.zip(&mut corner_nodes).for_each(|((leaf, (occluders, keys)), corner_keys)| {
                fill(leaf, Leaf { occluders, keys, corner: Some((frame, corner_keys)) });
            });
        } else {
            leaves.for_each(|(leaf, (occluders, keys))| fill(leaf, Leaf { occluders, keys, corner: None }));
        }
        Self { occluders, nodes, corner_nodes }
    }
}

/// Up to sixteen triangles with their keys; `None` for those that block nothing.
fn keyed(
    mesh: &KeyedMesh<'_>,
    ids: impl ExactSizeIterator<Item = usize>,
) -> impl Iterator<Item = Option<(Keys, Occluder)>> {
    let count = ids.len();
    let tile = mesh.tile(ids);
    let keys = mesh.light_keys(&tile);
    let facings = mesh.facings(&tile, &keys);
    (0..count).map(move |lane| Some((keys.entry(lane), tile.occluder(lane, facings[lane])?)))
}
