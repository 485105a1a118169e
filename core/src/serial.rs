//! The reference executor: one stage after the other, one id after the other, one lane, over slices that the caller
//! owns. The simplest thing that runs the pipeline; the others are held against it.

use glam::{IVec3, Vec3};

use crate::{
    edge_plane::LightGrid,
    executor::Executor,
    jitter::{Pattern, Regular},
    lanes::TILE,
    light::LatticeLight,
    mask_word::MaskWord,
    occluder::Occluder,
    order::{CodeFrame, Entry, code, sort},
    plan::{Pass, Plan},
    precision::PrecisionMode,
    proj4::{KeyTile, Keys, NODE, NOTHING},
    snap::SnapParams,
    stage::{
        Stage,
        build_level::build_level,
        key_receivers::key_receivers,
        key_triangles::key_triangles,
        reduce,
        resolve::{Group, Occlusion, resolve},
        snap_receivers::snap_receivers,
        snap_vertices::snap_vertices,
    },
    statistics::Counts,
    surface::Lift,
};

/// The buffers of a [`Serial`] executor: what stages read and write, by name. Lengths are checked when it is made.
#[derive(Debug)]
pub struct Buffers<'a, W> {
    /// World vertices; empty where `vertices` are on the lattice already.
    pub world_vertices: &'a [Vec3],
    /// Lattice vertices.
    pub vertices: &'a mut [IVec3],
    /// Vertex indices.
    pub triangles: &'a [[u32; 3]],
    /// One a triangle.
    pub triangle_keys: &'a mut [Keys],
    /// One a triangle.
    pub triangle_order: &'a mut [Entry],
    /// One a triangle.
    pub occluders: &'a mut [Occluder],
    /// [`crate::hierarchy::Levels::tiles`] of the plan's levels.
    pub nodes: &'a mut [KeyTile],
    /// World receivers; empty where `receivers` are on the lattice already.
    pub world_receivers: &'a [Vec3],
    /// Normals of the receivers' surfaces; as many as world receivers.
    pub normals: &'a [Vec3],
    /// Lattice receivers.
    pub receivers: &'a mut [IVec3],
    /// One a receiver of a block.
    pub receiver_keys: &'a mut [Keys],
    /// One a receiver of a block.
    pub receiver_order: &'a mut [Entry],
    /// Light rows a receiver.
    pub masks: &'a mut [W],
    /// One a receiver; empty where visibility is not asked for.
    pub visibility: &'a mut [f32],
}

/// Why a pass of the serial executor stopped.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum SerialError {
    /// A buffer is shorter than the plan calls for.
    #[error("buffer {buffer} is too short for {stage:?}")]
    TooShort {
        /// Name of the buffer.
        buffer: &'static str,
        /// The stage that needs it.
        stage: Stage,
    },
    /// An element is not finite or outside the lattice, or its normal points nowhere.
    #[error("{stage:?} refuses element {index}")]
    Element {
        /// The stage.
        stage: Stage,
        /// Index of the element.
        index: u32,
    },
    /// The plan asks for another index, for a light without extent, for irradiance, or for a mesh to be packed as it lies: the serial
    /// executor knows masks of lights with an area, and a hierarchy that is made anew.
    #[error("the serial executor does not run {stage:?}")]
    OtherIndex {
        /// The stage.
        stage: Stage,
    },
}

/// See the module.
#[derive(Debug)]
pub struct Serial<'a, W, P> {
    plan: Plan,
    snap: SnapParams,
    lift: Lift,
    grid: LightGrid,
    buffers: Buffers<'a, W>,
    /// What was done so far.
    pub counts: Counts,
    precision: core::marker::PhantomData<P>,
}

impl<'a, W: MaskWord, P: PrecisionMode> Serial<'a, W, P> {
    /// An executor over `buffers`. `snap` and `lift` matter only where world positions are given.
    pub fn new(plan: &Plan, light: LatticeLight, snap: SnapParams, lift: Lift, buffers: Buffers<'a, W>) -> Self {
        Self {
            plan: *plan,
            snap,
            lift,
            grid: LightGrid::new(light),
            buffers,
            counts: Counts::default(),
            precision: core::marker::PhantomData,
        }
    }

    fn codes(&self) -> CodeFrame {
        CodeFrame::new(self.grid.frame.scale, [0.0; 2], 1.0)
    }

    fn key_triangles(&mut self, pass: &Pass) -> Option<()> {
        let codes = self.codes();
        let b = &mut self.buffers;
        for id in 0..pass.count {
            let found = key_triangles(id as usize, &self.grid.frame, &self.grid.light, b.vertices, b.triangles);
            let keys = found.map_or(NOTHING, |(keys, _)| keys);
            let code = if found.is_some() { code(&codes, &keys) } else { Entry::ABSENT };
            *b.triangle_keys.get_mut(id as usize)? = keys;
            *b.triangle_order.get_mut(id as usize)? = Entry { code, index: id };
        }
        Some(())
    }

    fn order_triangles(&mut self, pass: &Pass) -> Option<()> {
        let b = &mut self.buffers;
        let order = b.triangle_order.get_mut(..pass.count as usize)?;
        sort(order);
        let tiles = b.nodes.get_mut(self.plan.levels().range(0))?;
        tiles.fill(KeyTile::NOTHING);
        for (place, entry) in order.iter().enumerate() {
            let id = entry.index as usize;
            if let Some((_, occluder)) = key_triangles(id, &self.grid.frame, &self.grid.light, b.vertices, b.triangles)
            {
                *b.occluders.get_mut(place)? = occluder;
                tiles.get_mut(place / NODE)?.set(place % NODE, b.triangle_keys.get(id)?);
            }
        }
        Some(())
    }

    fn build_level(&mut self, pass: &Pass) -> Option<()> {
        let level = pass.first as usize;
        let levels = self.plan.levels();
        let (below, above) = self.buffers.nodes.split_at_mut_checked(levels.range(level).start)?;
        let below = below.get(levels.range(level.checked_sub(1)?))?;
        for id in 0..pass.count as usize {
            *above.get_mut(id)? = build_level(id, below);
        }
        Some(())
    }

    fn key_receivers(&mut self, pass: &Pass) -> Option<()> {
        let codes = self.codes();
        let b = &mut self.buffers;
        for id in 0..pass.count {
            let index = pass.first + id;
            let keys = key_receivers(index as usize, &self.grid.frame, &self.grid.light, b.receivers);
            *b.receiver_keys.get_mut(id as usize)? = keys.unwrap_or(NOTHING);
            let code = keys.map_or(Entry::ABSENT, |keys| code(&codes, &keys));
            *b.receiver_order.get_mut(id as usize)? = Entry { code, index: id };
        }
        Some(())
    }

    fn resolve(&mut self, pass: &Pass) -> Option<()> {
        let light = self.grid.light;
        let pattern = light.jitter.is_some().then(|| Pattern::of(&light));
        let b = &mut self.buffers;
        let scene = Occlusion { grid: &self.grid, levels: self.plan.levels(), nodes: b.nodes, occluders: b.occluders };
        let block = self.plan.facts().block.min(self.plan.facts().receivers - pass.first) as usize;
        for entries in b.receiver_order.get(..block)?.chunks(TILE) {
            let mut group = Group::<W>::empty(light.rows);
            for (lane, entry) in entries.iter().enumerate() {
                let point = *b.receivers.get((pass.first + entry.index) as usize)?;
                let keys = b.receiver_keys.get(entry.index as usize)?;
                if entry.code == Entry::ABSENT {
                    group.set_behind(lane, &light);
                } else {
                    group.set(lane, point, keys);
                }
            }
            match &pattern {
                Some(pattern) => resolve::<f32, W, P, _>(&scene, pattern, &mut group),
                None => resolve::<f32, W, P, _>(&scene, &Regular, &mut group),
            }
            self.counts = self.counts.plus(group.counts);
            for (mask, entry) in group.masks.iter().zip(entries) {
                let rows = light.rows as usize;
                let start = (pass.first + entry.index) as usize * rows;
                b.masks.get_mut(start..start + rows)?.copy_from_slice(mask.get(..rows)?);
            }
        }
        Some(())
    }

    fn reduce(&mut self, pass: &Pass) -> Option<()> {
        let light = self.grid.light;
        let b = &mut self.buffers;
        for index in pass.first as usize..(pass.first + pass.count) as usize {
            let rows = light.rows as usize;
            let lit = reduce::lit_count(b.masks.get(index * rows..(index + 1) * rows)?, light.columns);
            *b.visibility.get_mut(index)? = reduce::visibility(lit, light.sample_count());
        }
        Some(())
    }

    fn snap(&mut self, pass: &Pass) -> Result<Option<()>, SerialError> {
        let b = &mut self.buffers;
        for index in pass.first..pass.first + pass.count {
            let (point, out) = match pass.stage {
                Stage::SnapVertices => {
                    (snap_vertices(index as usize, &self.snap, b.world_vertices), b.vertices.get_mut(index as usize))
                }
                _ => (
                    snap_receivers(index as usize, &self.snap, self.lift, b.world_receivers, b.normals),
                    b.receivers.get_mut(index as usize),
                ),
            };
            let Some(out) = out else { return Ok(None) };
            *out = point.ok_or(SerialError::Element { stage: pass.stage, index })?;
        }
        Ok(Some(()))
    }
}

impl<W: MaskWord, P: PrecisionMode> Executor for Serial<'_, W, P> {
    type Error = SerialError;

    fn dispatch(&mut self, pass: &Pass) -> Result<(), SerialError> {
        let (done, buffer) = match pass.stage {
            Stage::SnapVertices => (self.snap(pass)?, "vertices"),
            Stage::SnapReceivers => (self.snap(pass)?, "receivers"),
            Stage::KeyTriangles if self.plan.facts().arranged => {
                return Err(SerialError::OtherIndex { stage: pass.stage });
            }
            Stage::KeyTriangles => (self.key_triangles(pass), "triangle_keys or triangle_order"),
            Stage::OrderTriangles => (self.order_triangles(pass), "nodes or occluders"),
            Stage::BuildLevel => (self.build_level(pass), "nodes"),
            Stage::KeyReceivers => (self.key_receivers(pass), "receiver_keys or receiver_order"),
            Stage::OrderReceivers => {
                let order = self.buffers.receiver_order.get_mut(..pass.count as usize);
                (order.map(sort), "receiver_order")
            }
            Stage::Resolve => (self.resolve(pass), "masks or receiver_order"),
            Stage::FindSilhouette
            | Stage::SettleReceivers
            | Stage::SelectReceivers
            | Stage::ResolveCutout
            | Stage::AddTint
            | Stage::ResolvePunctual
            | Stage::ResolveCloud
            | Stage::DefineFrame
            | Stage::BinReceivers
            | Stage::BinTriangles
            | Stage::ResolveCells
            | Stage::Illuminate => {
                return Err(SerialError::OtherIndex { stage: pass.stage });
            }
            Stage::Reduce => (self.reduce(pass), "masks or visibility"),
        };
        done.ok_or(SerialError::TooShort { buffer, stage: pass.stage })
    }
}
