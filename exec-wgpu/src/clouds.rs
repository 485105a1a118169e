//! The ways to ask about lights that fill a volume.

use umbra4_core::{
    Counts, Facing, IndexKind, SceneFacts,
    cloud::{Cloud, WORD_BITS},
    cloud_order::OrderedCloud,
    cloud_table::{CloudTable, TableSize},
    cloud_tiles::CloudTiles,
    glam::IVec3,
    kernel::resolve_cloud::SampleTile,
    shaft::{around, box_of, meet},
    stage::reduce,
};

use crate::{
    GpuError, LatticeReceivers, LatticeScene, Statistics, WgpuExecutor, checks,
    executor::bounds,
    host::{Asked, Results},
    light_run::{LightRun, RunLight},
    stages::{block, cloud_layout, slice, table_layout},
};

impl WgpuExecutor {
    /// The masks of all receivers before a cloud of samples, receiver-major, [`Cloud::words`] words a receiver: bit k of word w is
    /// sample `32·w + k`, 1 where it is blocked; bits beyond the last sample are 0.
    ///
    /// ```no_run
    /// use umbra4_core::{SphereLight, glam::{DVec3, IVec3, Vec3}, Bounds, Lattice};
    /// use umbra4_wgpu::{Choice, Gpu, LatticeScene, WgpuExecutor};
    ///
    /// let lattice = Lattice::covering(Bounds { min: DVec3::splat(-4.0), max: DVec3::splat(4.0) })?;
    /// let corners = [Vec3::new(-1.0, 1.0, -1.0), Vec3::new(1.0, 1.0, -1.0), Vec3::new(0.0, 1.0, 1.0)];
    /// let vertices = [lattice.snap(corners[0])?, lattice.snap(corners[1])?, lattice.snap(corners[2])?];
    /// let receivers = [lattice.snap(Vec3::ZERO)?, lattice.snap(Vec3::new(3.0, 0.0, 0.0))?];
    /// let lamp = SphereLight { center: DVec3::new(0.0, 3.0, 0.0), radius: 0.5 }.snap(&lattice, [IVec3::ZERO; 256])?;
    ///
    /// let executor = WgpuExecutor::new(Gpu::open(&Choice::Hardware)?);
    /// let scene = LatticeScene { vertices: &vertices, triangles: &[[0, 1, 2]] };
    /// let (masks, _) = executor.cloud_masks(&scene, &lamp, &receivers)?;
    /// assert_eq!(masks[..8], [u32::MAX; 8]); // of the first receiver: 256 samples, all blocked
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// More vertices, triangles or receivers than can be indexed; a buffer that is larger than the device can bind; the device fails.
    pub fn cloud_masks<'a, S: AsRef<[IVec3]>>(
        &self,
        scene: &LatticeScene<'_>,
        cloud: &Cloud<S>,
        receivers: impl Into<LatticeReceivers<'a>>,
    ) -> Result<(Vec<u32>, Statistics), GpuError> {
        let asked = Asked { masks: true, counts: self.counted, ..Asked::default() };
        let (ordered, receivers) = (OrderedCloud::new(cloud.samples()), receivers.into());
        let (results, statistics) = self.run_cloud(scene, ordered.samples(), None, receivers, asked)?;
        let mut masks = vec![0; receivers.points.len() * cloud.words()];
        for (mask, out) in results.masks.chunks(cloud.words()).zip(masks.chunks_mut(cloud.words())) {
            ordered.write(mask, out);
        }
        Ok((masks, statistics))
    }

    /// The fraction of a cloud's samples that every receiver sees, in `0.0..=1.0`. Masks do not leave the device.
    ///
    /// # Errors
    /// As [`WgpuExecutor::cloud_masks`].
    pub fn cloud_visibility<'a, S: AsRef<[IVec3]>>(
        &self,
        scene: &LatticeScene<'_>,
        cloud: &Cloud<S>,
        receivers: impl Into<LatticeReceivers<'a>>,
    ) -> Result<(Vec<f32>, Statistics), GpuError> {
        let (lit, statistics) = self.cloud_lit_counts(scene, cloud, receivers)?;
        Ok((fractions(&lit, cloud), statistics))
    }

    /// How many samples of a cloud every receiver sees. Masks do not leave the device.
    ///
    /// # Errors
    /// As [`WgpuExecutor::cloud_masks`].
    pub fn cloud_lit_counts<'a, S: AsRef<[IVec3]>>(
        &self,
        scene: &LatticeScene<'_>,
        cloud: &Cloud<S>,
        receivers: impl Into<LatticeReceivers<'a>>,
    ) -> Result<(Vec<u32>, Statistics), GpuError> {
        let asked = Asked { counts: self.counted, visibility: true, ..Asked::default() };
        let ordered = OrderedCloud::new(cloud.samples());
        let (results, statistics) = self.run_cloud(scene, ordered.samples(), None, receivers.into(), asked)?;
        Ok((results.lit, statistics))
    }

    /// [`WgpuExecutor::cloud_masks`] by the lookups of a table: not exact, see [`umbra4_core::cloud_table`], but the same bits on
    /// every executor, whatever its precision.
    ///
    /// ```no_run
    /// use umbra4_core::{SphereLight, cloud_table::{CloudTable, TableSize}, glam::{DVec3, IVec3, Vec3}, Bounds, Lattice};
    /// use umbra4_wgpu::{Choice, Gpu, LatticeScene, WgpuExecutor};
    ///
    /// let lattice = Lattice::covering(Bounds { min: DVec3::splat(-4.0), max: DVec3::splat(4.0) })?;
    /// let corners = [Vec3::new(-1.0, 1.0, -1.0), Vec3::new(1.0, 1.0, -1.0), Vec3::new(0.0, 1.0, 1.0)];
    /// let vertices = [lattice.snap(corners[0])?, lattice.snap(corners[1])?, lattice.snap(corners[2])?];
    /// let receivers = [lattice.snap(Vec3::ZERO)?, lattice.snap(Vec3::new(3.0, 0.0, 0.0))?];
    ///
    /// let lamp = SphereLight { center: DVec3::new(0.0, 3.0, 0.0), radius: 0.5 }.snap(&lattice, [IVec3::ZERO; 128])?;
    /// let size = TableSize { directions: 16, distances: 32 };
    /// let table = CloudTable::new(&lamp, size, vec![0; CloudTable::words_of(&lamp, size)?])?;
    /// let executor = WgpuExecutor::new(Gpu::open(&Choice::Hardware)?);
    /// let scene = LatticeScene { vertices: &vertices, triangles: &[[0, 1, 2]] };
    /// let (masks, _) = executor.cloud_masks_by_table(&scene, &table, &receivers)?;
    /// assert_eq!(masks, [[u32::MAX; 4], [0; 4]].concat());
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// As [`WgpuExecutor::cloud_masks`], of the table too.
    pub fn cloud_masks_by_table<'a, C: AsRef<[IVec3]>, S: AsRef<[u32]>>(
        &self,
        scene: &LatticeScene<'_>,
        table: &CloudTable<'_, C, S>,
        receivers: impl Into<LatticeReceivers<'a>>,
    ) -> Result<(Vec<u32>, Statistics), GpuError> {
        let asked = Asked { masks: true, ..self.asked_of(table) };
        // In the table's order, which is the caller's.
        let samples = table.cloud().samples();
        let (results, statistics) = self.run_cloud(scene, samples, Some(table.size()), receivers.into(), asked)?;
        Ok((results.masks, statistics))
    }

    /// [`WgpuExecutor::cloud_visibility`] by the lookups of a table.
    ///
    /// # Errors
    /// As [`WgpuExecutor::cloud_masks_by_table`].
    pub fn cloud_visibility_by_table<'a, C: AsRef<[IVec3]>, S: AsRef<[u32]>>(
        &self,
        scene: &LatticeScene<'_>,
        table: &CloudTable<'_, C, S>,
        receivers: impl Into<LatticeReceivers<'a>>,
    ) -> Result<(Vec<f32>, Statistics), GpuError> {
        let (lit, statistics) = self.cloud_lit_counts_by_table(scene, table, receivers)?;
        Ok((fractions(&lit, table.cloud()), statistics))
    }

    /// [`WgpuExecutor::cloud_lit_counts`] by the lookups of a table.
    ///
    /// # Errors
    /// As [`WgpuExecutor::cloud_masks_by_table`].
    pub fn cloud_lit_counts_by_table<'a, C: AsRef<[IVec3]>, S: AsRef<[u32]>>(
        &self,
        scene: &LatticeScene<'_>,
        table: &CloudTable<'_, C, S>,
        receivers: impl Into<LatticeReceivers<'a>>,
    ) -> Result<(Vec<u32>, Statistics), GpuError> {
        let asked = Asked { visibility: true, ..self.asked_of(table) };
        let samples = table.cloud().samples();
        let (results, statistics) = self.run_cloud(scene, samples, Some(table.size()), receivers.into(), asked)?;
        Ok((results.lit, statistics))
    }

    fn asked_of<'a, C, S: AsRef<[u32]>>(&self, table: &'a CloudTable<'_, C, S>) -> Asked<'a> {
        Asked { counts: self.counted, planes: Some(table.words()), ..Asked::default() }
    }

    /// Masks have their bits in the order of `samples`, which are those of the table of size `table`, if there is one. Where no
    /// triangle lies between receivers and light, the device has nothing to do: the host tells who faces away.
    fn run_cloud(
        &self,
        scene: &LatticeScene<'_>,
        samples: &[IVec3],
        table: Option<TableSize>,
        receivers: LatticeReceivers<'_>,
        asked: Asked<'_>,
    ) -> Result<(Results, Statistics), GpuError> {
        checks::counts_of(scene, receivers)?;
        let tiles = CloudTiles::new(samples);
        let words = samples.len().div_ceil(WORD_BITS);
        if !is_reached(scene, tiles.extent().bounds(), receivers.points) {
            let counts = asked.counts.then(Counts::default);
            return Ok((unreached(&tiles, words, receivers, asked), Statistics { counts, ..Statistics::default() }));
        }
        let slice = slice(self.gpu.software);
        let layout = match table {
            Some(_) => table_layout(words as u32, asked.counts, slice),
            None => cloud_layout(words as u32, self.precision, asked.counts, slice),
        };
        let facts = SceneFacts {
            triangles: scene.triangles.len() as u32,
            receivers: receivers.points.len() as u32,
            visibility: asked.visibility,
            block: block(&layout, self.block),
            index: IndexKind::Shafts,
            facing: !receivers.facings.is_empty(),
            table: table.is_some(),
            ..SceneFacts::default()
        };
        let samples: Vec<SampleTile> = tiles.sample_tiles().collect();
        let bounds = bounds(scene.vertices.iter().chain(receivers.points));
        let run = LightRun { light: RunLight::Cloud(&tiles, table), faces: 1, facts, layout, bounds };
        self.run_light(run, scene, receivers, Asked { samples: &samples, ..asked })
    }
}

/// Visibility, of lit samples of a cloud.
fn fractions<C: AsRef<[IVec3]>>(lit: &[u32], cloud: &Cloud<C>) -> Vec<f32> {
    let samples = cloud.samples().len() as u32;
    lit.iter().map(|&lit| reduce::visibility(lit, samples)).collect()
}

/// What receivers get of a cloud where no triangle lies between: all of it, but those that face away.
fn unreached(tiles: &CloudTiles<'_>, words: usize, receivers: LatticeReceivers<'_>, asked: Asked<'_>) -> Results {
    let LatticeReceivers { points, facings, .. } = receivers;
    let mut results = Results::default();
    for (index, p) in points.iter().enumerate() {
        let facing = facings.get(index).copied().unwrap_or(Facing::UNKNOWN);
        let is_away = facing.is_away_from_box(tiles.extent().bounds(), *p);
        if asked.masks {
            results.masks.extend(tiles.full().iter().take(words).map(|all| if is_away { *all } else { 0 }));
        }
        if asked.visibility {
            results.lit.push(if is_away { 0 } else { tiles.len() as u32 });
        }
    }
    results
}

/// Whether any triangle reaches into the box around a cloud and all receivers: nothing outside of it blocks anything.
fn is_reached(scene: &LatticeScene<'_>, [low, high]: [IVec3; 2], receivers: &[IVec3]) -> bool {
    if receivers.is_empty() {
        return false;
    }
    let of_receivers = around(receivers);
    let extent = [low.min(of_receivers[0]), high.max(of_receivers[1])];
    let corner = |index: u32| scene.vertices.get(index as usize).copied();
    scene.triangles.iter().any(|[a, b, c]| match (corner(*a), corner(*b), corner(*c)) {
        (Some(a), Some(b), Some(c)) => meet(box_of([a, b, c]), extent),
        _ => false,
    })
}
