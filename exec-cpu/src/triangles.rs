//! Triangles of one light: keyed, put in order and packed under their hierarchy.

use std::iter::once;

use bytemuck::allocation::zeroed_vec;
use rayon::prelude::*;
use umbra4_core::{
    corner::corner_light,
    edge_plane::LightGrid,
    frame::LightFrame,
    hierarchy::Levels,
    keyed_mesh::{KeyedMesh, VertexKeys},
    occluder::{Facing, Occluder},
    order::{Entry, code},
    proj4::{KeyTile, Keys, NODE, NOTHING},
};

use crate::{
    Occluders,
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

    /// Puts them in order, and packs them; `corner`: by their keys for the light's first sample, too.
    pub(crate) fn pack(
        &mut self,
        grid: &LightGrid,
        scene: &Occluders,
        levels: &Levels,
        corner: bool,
    ) -> PackedTriangles {
        sort(&mut self.order);
        // Those that take no part come last.
        self.order.truncate(self.order.partition_point(|entry| entry.code != Entry::ABSENT));
        let mesh = self.mesh(grid, scene);
        let corner_frame = LightFrame::new(&corner_light(&grid.light));
        let leaf = |occluders: &mut [Occluder], entries: &[Entry], keys: &mut KeyTile, corner: Option<&mut KeyTile>| {
            let tile = mesh.tile(entries.iter().map(|entry| entry.index as usize));
            let facing = |entry: &Entry| self.facings[entry.index as usize];
            for (lane, (occluder, entry)) in occluders.iter_mut().zip(entries).enumerate() {
                *occluder = tile.occluder(lane, facing(entry)).unwrap_or(Occluder::NONE);
            }
            *keys = mesh.light_keys(&tile);
            if let Some(corner) = corner {
                *corner = mesh.corner_keys(&tile, &corner_frame);
                for (lane, _) in entries.iter().enumerate().filter(|(_, entry)| facing(entry) == Facing::Mixed) {
                    corner.set(lane, &NOTHING);
                }
            }
        };
        let mut occluders: Vec<Occluder> = zeroed_vec(self.order.len());
        let mut nodes = vec![KeyTile::NOTHING; levels.tiles()];
        let mut corner_nodes = vec![KeyTile::NOTHING; if corner { levels.tiles() } else { 0 }];
        let things = occluders.par_chunks_mut(NODE).zip(self.order.par_chunks(NODE)).with_min_len(LEAVES_A_JOB);
        let leaves = things.zip(&mut nodes);
        if corner {
            leaves.zip(&mut corner_nodes).for_each(|(((occluders, entries), keys), corner)| {
                leaf(occluders, entries, keys, Some(corner));
            });
        } else {
            leaves.for_each(|((occluders, entries), keys)| leaf(occluders, entries, keys, None));
        }
        PackedTriangles { occluders, nodes, corner_nodes }
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
