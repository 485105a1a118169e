//! Casters, indexed for one light: each by itself.

use std::{convert::Infallible, iter::empty, sync::Arc, time::Instant};

use rayon::prelude::*;
use umbra4_core::{
    CasterFacts, CasterWork, Executor, LatticeLight, Layers, PackedCaster, Pass, Plan, SceneFacts, Work,
    edge_plane::LightGrid,
    occluder::Occluder,
    proj4::Keys,
    stage::{
        Stage, add_tint::TintScene, key_triangles::keys_of_caster, resolve::Occlusion, resolve_cutout::CutoutScene,
        resolve_silhouette::Indexed,
    },
    surface_words::SurfaceLayout,
};

use crate::{Caster, Statistics, hierarchy::Hierarchy, order::ordered};

/// Casters as one light sees them: made by [`crate::CpuExecutor::index_casters`], good for any receivers, for as long as neither light
/// nor casters change. Where one caster changes, [`crate::CpuExecutor::index_caster`] makes its part anew, and that alone.
#[derive(Debug)]
pub struct CasterIndex {
    pub(crate) grid: LightGrid,
    pub(crate) casters: Vec<IndexedCaster>,
    statistics: Statistics,
}

/// One caster's part.
#[derive(Debug)]
pub(crate) struct IndexedCaster {
    hierarchy: Hierarchy<Occluder>,
    work: CasterWork,
    surface: Arc<[u32]>,
    layout: SurfaceLayout,
    offset: u32,
    pub(crate) layers: Layers,
    triangles: u32,
}

impl CasterIndex {
    pub(crate) fn new(casters: &[Caster], light: &LatticeLight) -> Self {
        let mut index = Self { grid: LightGrid::new(*light), casters: Vec::new(), statistics: Statistics::default() };
        for caster in casters {
            let indexed = index.indexed(caster);
            index.casters.push(indexed);
        }
        index.statistics.sort();
        index
    }

    /// Indexes one caster.
    pub(crate) fn indexed(&mut self, caster: &Caster) -> IndexedCaster {
        let packed = caster.packed();
        let triangles = packed.triangles.len() as u32;
        let plan = Plan::new(SceneFacts { triangles, work: Work::Index, ..SceneFacts::default() });
        let mut run = IndexRun {
            grid: &self.grid,
            caster: &packed,
            statistics: &mut self.statistics,
            keyed: Vec::new(),
            hierarchy: Hierarchy::lowest(empty()),
        };
        // Clear casters have no triangle that matters.
        if packed.work() != CasterWork::Nothing {
            let Ok(()) = plan.run(&mut run);
        }
        IndexedCaster {
            hierarchy: run.hierarchy,
            work: packed.work(),
            surface: caster.words(),
            layout: packed.layout(),
            offset: packed.casting.offset,
            layers: packed.layers,
            triangles,
        }
    }

    /// The light it is made for.
    pub fn light(&self) -> &LatticeLight {
        &self.grid.light
    }

    /// Casters.
    pub fn len(&self) -> usize {
        self.casters.len()
    }

    /// Whether there is no caster.
    pub fn is_empty(&self) -> bool {
        self.casters.is_empty()
    }

    /// What was done to make it, and to make parts of it anew.
    pub fn statistics(&self) -> &Statistics {
        &self.statistics
    }

    /// What kinds of casters there are, for runs that ask for light, or do not.
    pub(crate) fn facts(&self, light: bool, receivers_layered: bool) -> CasterFacts {
        let casters = self.casters.iter().map(|caster| (caster.work(), caster.layers));
        CasterFacts::of(casters, light, receivers_layered)
    }
}

impl IndexedCaster {
    /// Which stage it is for: none, where no triangle of it faces the light.
    pub(crate) fn work(&self) -> CasterWork {
        if self.hierarchy.is_empty() { CasterWork::Nothing } else { self.work }
    }

    /// Triangles of the caster.
    pub(crate) fn triangles(&self) -> u32 {
        self.triangles
    }

    pub(crate) fn occlusion<'a>(&'a self, grid: &'a LightGrid) -> Occlusion<'a> {
        let Indexed { levels, nodes, things: occluders } = self.hierarchy.indexed();
        Occlusion { grid, levels, nodes, occluders }
    }

    pub(crate) fn cutout<'a>(&'a self, grid: &'a LightGrid) -> CutoutScene<'a> {
        let (occlusion, Self { surface, layout, offset, .. }) = (self.occlusion(grid), self);
        CutoutScene { occlusion, surface, layout: *layout, offset: *offset }
    }

    pub(crate) fn tint<'a>(&'a self, grid: &'a LightGrid) -> TintScene<'a> {
        TintScene { occlusion: self.occlusion(grid), surface: &self.surface, layout: self.layout }
    }
}

/// The stages that index a caster.
struct IndexRun<'a> {
    grid: &'a LightGrid,
    caster: &'a PackedCaster<'a>,
    statistics: &'a mut Statistics,
    keyed: Vec<Option<(Keys, Occluder)>>,
    hierarchy: Hierarchy<Occluder>,
}

impl IndexRun<'_> {
    fn key_triangles(&mut self) {
        let PackedCaster { vertices, triangles, casting, .. } = *self.caster;
        (0..triangles.len())
            .into_par_iter()
            .map(|id| {
                let corners = triangles[id].map(|vertex| vertices[vertex as usize]);
                let (keys, occluder) = keys_of_caster(self.grid, corners, casting)?;
                Some((keys, occluder.numbered(id as u32)))
            })
            .collect_into_vec(&mut self.keyed);
    }

    fn order_triangles(&mut self) {
        let order = ordered(&self.grid.frame, &self.keyed, |keyed| keyed.map(|(keys, _)| keys));
        let packed = order.iter().filter_map(|entry| self.keyed[entry.index as usize]);
        self.hierarchy = Hierarchy::lowest(packed.map(|(keys, occluder)| (occluder, keys)));
        self.keyed = Vec::new();
    }
}

impl Executor for IndexRun<'_> {
    type Error = Infallible;

    fn dispatch(&mut self, pass: &Pass) -> Result<(), Infallible> {
        let start = Instant::now();
        match pass.stage {
            Stage::KeyTriangles => self.key_triangles(),
            Stage::OrderTriangles => self.order_triangles(),
            // Triangles that face away from all samples are not there any more: levels may be fewer than planned.
            Stage::BuildLevel => self.hierarchy.build_level(pass.first as usize),
            _ => return Ok(()),
        }
        self.statistics.add(pass.stage, start.elapsed());
        Ok(())
    }
}
