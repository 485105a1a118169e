//! The plan: which stages run, looking at what the scene has. What it does not call for is not run, not bound and not
//! allocated. A plan prints itself.

use core::fmt;

use crate::{executor::Executor, hierarchy::Levels, layers::Layers, packed_caster::CasterWork, stage::Stage};

/// How triangles and receivers are paired. Decides speed, never a bit.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum IndexKind {
    /// [`crate::hierarchy`], over all triangles.
    #[default]
    Hierarchy,
    /// [`crate::silhouette`]: hierarchies over its edges, and over what triangles it leaves.
    Silhouette,
    /// [`crate::grid`], the paper's.
    Grid,
    /// [`crate::shaft`]: before a light that is a [`crate::cloud`], whose masks come from [`Stage::ResolveCloud`].
    Shafts,
}

/// What a run is to do.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Work {
    /// All of it: index the triangles, and shadow the receivers.
    #[default]
    Whole,
    /// Index the triangles of one caster.
    Index,
    /// Shadow the receivers by casters that are indexed.
    Casters(CasterFacts),
}

/// What kinds of casters there are.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct CasterFacts {
    /// Casters of which every triangle blocks all it covers.
    pub plain: u32,
    /// Alpha-tested ones, and those with an offset.
    pub cutout: u32,
    /// Tinted ones, where light is asked for.
    pub tinted: u32,
    /// Whether receivers, or casters, are on some layers only.
    pub layered: bool,
}

/// Cheap, exact facts about one run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SceneFacts {
    /// Vertices to be snapped in this run; 0 where the scene is on the lattice already.
    pub new_vertices: u32,
    /// Triangles.
    pub triangles: u32,
    /// Receivers.
    pub receivers: u32,
    /// Whether the receivers come as world positions, to be snapped in this run.
    pub world_receivers: bool,
    /// Whether visibility is asked for.
    pub visibility: bool,
    /// Most receivers to be worked on at once: bounds the memory of a run. At least 1.
    pub block: u32,
    /// How triangles and receivers are paired.
    pub index: IndexKind,
    /// Whether the light's samples are jittered.
    pub jittered: bool,
    /// Whether the triangles come in an order that suits every light: then [`Stage::KeyTriangles`] packs them as they lie, for
    /// executors that can.
    pub arranged: bool,
    /// Whether any receiver lies before the light; where none does, all is settled without a triangle.
    pub reached: bool,
    /// Whether it is known which way the receivers' surfaces face: those that face away from the light are settled first.
    pub facing: bool,
    /// Whether the light is one without extent ([`crate::punctual`]): masks have one bit.
    pub punctual: bool,
    /// Whether samples of a cloud are looked up in a [table of planes](crate::cloud_table).
    pub table: bool,
    /// Whether irradiance is asked for: of lights with an area.
    pub irradiance: bool,
    /// What is to be done.
    pub work: Work,
}

impl CasterFacts {
    /// Of casters by the work they make and the layers they are on; `light`: whether tints matter; `layered`: whether receivers are on
    /// some layers only. Casters on no layer matter to none.
    pub fn of(casters: impl Iterator<Item = (CasterWork, Layers)>, light: bool, layered: bool) -> Self {
        let mut facts = Self::default();
        for (work, layers) in casters {
            let count = match work {
                CasterWork::Nothing => continue,
                CasterWork::Tinted if !light => continue,
                CasterWork::Plain => &mut facts.plain,
                CasterWork::Cutout => &mut facts.cutout,
                CasterWork::Tinted => &mut facts.tinted,
            };
            *count += 1;
            facts.layered |= layers == Layers::NONE || layered;
        }
        facts
    }
}

impl Default for SceneFacts {
    /// Nothing to do, for a light with an area that is reached.
    fn default() -> Self {
        Self {
            new_vertices: 0,
            triangles: 0,
            receivers: 0,
            world_receivers: false,
            visibility: false,
            block: u32::MAX,
            index: IndexKind::default(),
            jittered: false,
            arranged: false,
            reached: true,
            facing: false,
            punctual: false,
            table: false,
            irradiance: false,
            work: Work::Whole,
        }
    }
}

/// One dispatch of one stage.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Pass {
    /// The stage.
    pub stage: Stage,
    /// Ids it runs for: `0..count`.
    pub count: u32,
    /// First receiver of the block, for the stages that run once a block; the level, for [`Stage::BuildLevel`]; else 0.
    pub first: u32,
}

/// The passes of one run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Plan {
    facts: SceneFacts,
    levels: Levels,
}

impl Plan {
    /// Decides what runs.
    pub fn new(facts: SceneFacts) -> Self {
        let facts = SceneFacts { triangles: if facts.reached { facts.triangles } else { 0 }, ..facts };
        let levels = match facts.index {
            IndexKind::Grid if !facts.punctual => Levels::default(),
            _ => Levels::of(facts.triangles),
        };
        Self { facts, levels }
    }

    /// The facts it was made from.
    pub fn facts(&self) -> &SceneFacts {
        &self.facts
    }

    /// Layout of the hierarchy; no levels where there is none.
    pub fn levels(&self) -> &Levels {
        &self.levels
    }

    /// Hands every pass to the executor, in order.
    ///
    /// # Errors
    /// The first that the executor reports; no later pass is run.
    pub fn run<E: Executor>(&self, executor: &mut E) -> Result<(), E::Error> {
        let facts = &self.facts;
        match facts.work {
            Work::Whole => {}
            Work::Index => return self.run_index(executor),
            Work::Casters(casters) => return self.run_casters(&casters, executor),
        }
        let index = self.index();
        // Before a cloud, every receiver is in full light where nothing lies between.
        if facts.receivers == 0 || (index == IndexKind::Shafts && facts.triangles == 0 && !facts.facing) {
            return Ok(());
        }
        let mut once = |stage, count, first| {
            if count > 0 { executor.dispatch(&Pass { stage, count, first }) } else { Ok(()) }
        };
        once(Stage::SnapVertices, facts.new_vertices, 0)?;
        once(Stage::KeyTriangles, facts.triangles, 0)?;
        if index != IndexKind::Grid && !facts.arranged {
            once(Stage::OrderTriangles, facts.triangles, 0)?;
        }
        for level in 1..self.levels.count() {
            once(Stage::BuildLevel, self.levels.range(level).len() as u32, level as u32)?;
        }
        if index == IndexKind::Silhouette {
            once(Stage::FindSilhouette, facts.triangles, 0)?;
        }
        let mut first = 0;
        while first < facts.receivers {
            let count = facts.block.max(1).min(facts.receivers - first);
            once(Stage::SnapReceivers, if facts.world_receivers { count } else { 0 }, first)?;
            once(Stage::KeyReceivers, count, first)?;
            once(Stage::SettleReceivers, if facts.facing { count } else { 0 }, first)?;
            match index {
                IndexKind::Hierarchy | IndexKind::Silhouette => {
                    once(Stage::OrderReceivers, count, first)?;
                    let resolve = if facts.punctual { Stage::ResolvePunctual } else { Stage::Resolve };
                    once(resolve, count.div_ceil(crate::lanes::TILE as u32), first)?;
                }
                IndexKind::Shafts => {
                    once(Stage::OrderReceivers, count, first)?;
                    once(Stage::ResolveCloud, count.div_ceil(crate::lanes::TILE as u32), first)?;
                }
                IndexKind::Grid => {
                    once(Stage::DefineFrame, count, first)?;
                    once(Stage::BinReceivers, count, first)?;
                    once(Stage::BinTriangles, facts.triangles, first)?;
                    once(Stage::ResolveCells, count, first)?;
                }
            }
            once(Stage::Reduce, if facts.visibility && !facts.punctual { count } else { 0 }, first)?;
            let lit = facts.irradiance && !facts.punctual && index != IndexKind::Shafts;
            once(Stage::Illuminate, if lit { count } else { 0 }, first)?;
            first += count;
        }
        // The masks of all receivers, of a bit each, are kept: a light may have several frames.
        once(Stage::Reduce, if facts.visibility && facts.punctual { facts.receivers } else { 0 }, 0)
    }

    /// The last stage of every block, of a plan for casters that are indexed.
    pub fn last_of_block(&self) -> Option<Stage> {
        let Work::Casters(casters) = self.facts.work else { return None };
        Some(if self.facts.visibility {
            Stage::Reduce
        } else if casters.tinted > 0 {
            Stage::AddTint
        } else if casters.cutout > 0 {
            Stage::ResolveCutout
        } else if casters.plain > 0 {
            Stage::Resolve
        } else if casters.layered {
            Stage::SelectReceivers
        } else {
            Stage::OrderReceivers
        })
    }

    /// The passes that index one caster.
    fn run_index<E: Executor>(&self, executor: &mut E) -> Result<(), E::Error> {
        let mut once = |stage, count, first| {
            if count > 0 { executor.dispatch(&Pass { stage, count, first }) } else { Ok(()) }
        };
        once(Stage::KeyTriangles, self.facts.triangles, 0)?;
        once(Stage::OrderTriangles, self.facts.triangles, 0)?;
        for level in 1..self.levels.count() {
            once(Stage::BuildLevel, self.levels.range(level).len() as u32, level as u32)?;
        }
        Ok(())
    }

    /// The passes that shadow receivers by casters which are indexed.
    fn run_casters<E: Executor>(&self, casters: &CasterFacts, executor: &mut E) -> Result<(), E::Error> {
        let facts = &self.facts;
        let mut once = |stage, runs: bool, count, first| {
            if runs && count > 0 { executor.dispatch(&Pass { stage, count, first }) } else { Ok(()) }
        };
        let mut first = 0;
        while first < facts.receivers {
            let count = facts.block.max(1).min(facts.receivers - first);
            let groups = count.div_ceil(crate::lanes::TILE as u32);
            once(Stage::KeyReceivers, true, count, first)?;
            once(Stage::SettleReceivers, facts.facing, count, first)?;
            once(Stage::OrderReceivers, true, count, first)?;
            once(Stage::SelectReceivers, casters.layered, count, first)?;
            once(Stage::Resolve, casters.plain > 0, groups, first)?;
            once(Stage::ResolveCutout, casters.cutout > 0, groups, first)?;
            once(Stage::AddTint, casters.tinted > 0, groups, first)?;
            once(Stage::Reduce, facts.visibility, count, first)?;
            first += count;
        }
        Ok(())
    }

    /// How triangles and receivers are paired: before a light without extent, always by the hierarchy.
    fn index(&self) -> IndexKind {
        if self.facts.punctual { IndexKind::Hierarchy } else { self.facts.index }
    }

    /// Why a stage runs or does not, in a few words.
    pub fn reason(&self, stage: Stage) -> (bool, &'static str) {
        let facts = &self.facts;
        let (work, triangles) = (facts.receivers > 0, facts.triangles > 0);
        let (grid, cloud) = (self.index() == IndexKind::Grid, self.index() == IndexKind::Shafts);
        match facts.work {
            Work::Whole => {}
            Work::Index => return self.reason_of_index(stage),
            Work::Casters(casters) => return self.reason_of_casters(&casters, stage),
        }
        match stage {
            _ if !work => (false, "no receivers"),
            Stage::Illuminate if !facts.irradiance => (false, "irradiance is not asked for"),
            Stage::Illuminate if facts.punctual || cloud => (false, "the light has no area"),
            Stage::Illuminate => (true, "irradiance is asked for"),
            Stage::SnapVertices if facts.new_vertices == 0 => (false, "the scene is on the lattice already"),
            Stage::SnapVertices => (true, "new vertices"),
            Stage::SnapReceivers if !facts.world_receivers => (false, "the receivers are on the lattice already"),
            Stage::SnapReceivers => (true, "receivers in world space"),
            Stage::SelectReceivers => (false, "every triangle matters to every receiver"),
            Stage::ResolveCutout => (false, "no texture cuts triangles"),
            Stage::AddTint => (false, "no triangle is tinted"),
            Stage::Resolve | Stage::FindSilhouette if facts.punctual => {
                (false, "the light has no extent: a mask is one bit")
            }
            Stage::Resolve | Stage::ResolvePunctual | Stage::FindSilhouette if cloud => {
                (false, "the light is a cloud of samples")
            }
            Stage::ResolvePunctual if !facts.punctual => (false, "the light has an area"),
            Stage::ResolveCloud if !cloud => (false, "the light is no cloud"),
            Stage::ResolveCloud if facts.table && (triangles || facts.facing) => {
                (true, "receivers to shadow, by a table of planes")
            }
            _ if cloud && !triangles && !facts.facing => {
                (false, if facts.reached { "no triangles" } else { "no triangle lies between receivers and light" })
            }
            Stage::OrderTriangles
            | Stage::BuildLevel
            | Stage::FindSilhouette
            | Stage::OrderReceivers
            | Stage::Resolve
                if grid =>
            {
                (false, "the grid is the index")
            }
            Stage::DefineFrame | Stage::BinReceivers | Stage::BinTriangles | Stage::ResolveCells if !grid => {
                (false, "the hierarchy is the index")
            }
            Stage::OrderTriangles if facts.arranged => (false, "the mesh is arranged"),
            Stage::FindSilhouette if facts.index != IndexKind::Silhouette => (false, "triangles are taken one by one"),
            Stage::FindSilhouette if triangles => (true, "edges inside a surface change nothing"),
            Stage::KeyTriangles | Stage::OrderTriangles | Stage::FindSilhouette | Stage::BinTriangles if !triangles => {
                (false, if facts.reached { "no triangles" } else { "no receiver lies before the light" })
            }
            Stage::KeyTriangles | Stage::OrderTriangles | Stage::FindSilhouette | Stage::BinTriangles => {
                (true, "triangles to index")
            }
            Stage::BuildLevel if self.levels.count() < 2 => (false, "one node holds all triangles"),
            Stage::BuildLevel => (true, "more triangles than a node holds"),
            Stage::SettleReceivers if !facts.facing => (false, "receivers may look to any side"),
            Stage::SettleReceivers => (true, "receivers with normals: some may face away"),
            Stage::DefineFrame | Stage::BinReceivers => (true, "receivers to index"),
            Stage::KeyReceivers
            | Stage::OrderReceivers
            | Stage::Resolve
            | Stage::ResolvePunctual
            | Stage::ResolveCloud
            | Stage::ResolveCells => (true, "receivers to shadow"),
            Stage::Reduce if !facts.visibility => (false, "masks only"),
            Stage::Reduce => (true, "visibility is asked for"),
        }
    }
}

impl Plan {
    fn reason_of_index(&self, stage: Stage) -> (bool, &'static str) {
        match stage {
            Stage::KeyTriangles | Stage::OrderTriangles if self.facts.triangles > 0 => (true, "triangles to index"),
            Stage::KeyTriangles | Stage::OrderTriangles => (false, "no triangles"),
            Stage::BuildLevel if self.levels.count() < 2 => (false, "one node holds all triangles"),
            Stage::BuildLevel => (true, "more triangles than a node holds"),
            _ => (false, "one caster is indexed"),
        }
    }

    fn reason_of_casters(&self, casters: &CasterFacts, stage: Stage) -> (bool, &'static str) {
        let facts = &self.facts;
        match stage {
            _ if facts.receivers == 0 => (false, "no receivers"),
            Stage::KeyReceivers | Stage::OrderReceivers => (true, "receivers to shadow"),
            Stage::SettleReceivers if facts.facing => (true, "receivers with normals: some may face away"),
            Stage::SettleReceivers => (false, "receivers may look to any side"),
            Stage::SelectReceivers if casters.layered => (true, "casters or receivers on some layers only"),
            Stage::SelectReceivers => (false, "every caster matters to every receiver"),
            Stage::Resolve if casters.plain > 0 => (true, "casters that block all they cover"),
            Stage::Resolve => (false, "no caster blocks all it covers"),
            Stage::ResolveCutout if casters.cutout > 0 => (true, "casters cut out by a texture, or with an offset"),
            Stage::ResolveCutout => (false, "no caster is cut out by a texture"),
            Stage::AddTint if casters.tinted > 0 => (true, "tinted casters, and light is asked for"),
            Stage::AddTint => (false, "no caster is tinted, or masks only are asked for"),
            Stage::Reduce if facts.visibility => (true, "visibility, or light, is asked for"),
            Stage::Reduce => (false, "masks only"),
            _ => (false, "the casters are indexed"),
        }
    }
}

impl fmt::Display for Plan {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for info in &crate::stage::TABLE {
            let (runs, reason) = self.reason(info.stage);
            writeln!(f, "{} {:<16} {reason}", if runs { "+" } else { "-" }, info.name)?;
        }
        Ok(())
    }
}
