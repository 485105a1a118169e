//! The ways to ask about lights that fill a volume.

use umbra4_core::{
    Counts, Facing, IndexKind, SceneFacts,
    cloud::Cloud,
    cloud_order::OrderedCloud,
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
    stages::{block, cloud_layout, slice},
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
        let (results, statistics) = self.run_cloud(scene, cloud, &ordered, receivers, asked)?;
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
        let samples = cloud.samples().len() as u32;
        Ok((lit.iter().map(|&lit| reduce::visibility(lit, samples)).collect(), statistics))
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
        let (ordered, receivers) = (OrderedCloud::new(cloud.samples()), receivers.into());
        let (results, statistics) = self.run_cloud(scene, cloud, &ordered, receivers, asked)?;
        Ok((results.lit, statistics))
    }

    /// Masks have their bits in the order of `ordered`. Where no triangle lies between receivers and light, the device has nothing
    /// to do: the host tells who faces away.
    fn run_cloud<S: AsRef<[IVec3]>>(
        &self,
        scene: &LatticeScene<'_>,
        cloud: &Cloud<S>,
        ordered: &OrderedCloud,
        receivers: LatticeReceivers<'_>,
        asked: Asked<'_>,
    ) -> Result<(Results, Statistics), GpuError> {
        checks::counts_of(scene, receivers)?;
        let tiles = CloudTiles::new(ordered.samples());
        if !is_reached(scene, cloud, receivers.points) {
            let counts = asked.counts.then(Counts::default);
            return Ok((
                unreached(&tiles, cloud.words(), receivers, asked),
                Statistics { counts, ..Statistics::default() },
            ));
        }
        let layout = cloud_layout(cloud.words() as u32, self.precision, asked.counts, slice(self.gpu.software));
        let facts = SceneFacts {
            triangles: scene.triangles.len() as u32,
            receivers: receivers.points.len() as u32,
            visibility: asked.visibility,
            block: block(&layout, self.block),
            index: IndexKind::Shafts,
            facing: !receivers.facings.is_empty(),
            ..SceneFacts::default()
        };
        let samples: Vec<SampleTile> = tiles.sample_tiles().collect();
        let bounds = bounds(scene.vertices.iter().chain(receivers.points));
        let run = LightRun { light: RunLight::Cloud(&tiles), faces: 1, facts, layout, bounds };
        self.run_light(run, scene, receivers, Asked { samples: &samples, ..asked })
    }
}

/// What receivers get of a cloud where no triangle lies between: all of it, but those that face away.
fn unreached(tiles: &CloudTiles<'_>, words: usize, receivers: LatticeReceivers<'_>, asked: Asked<'_>) -> Results {
    let LatticeReceivers { points, facings } = receivers;
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
fn is_reached<S: AsRef<[IVec3]>>(scene: &LatticeScene<'_>, cloud: &Cloud<S>, receivers: &[IVec3]) -> bool {
    if receivers.is_empty() {
        return false;
    }
    let ([low, high], of_receivers) = (cloud.bounds(), around(receivers));
    let extent = [low.min(of_receivers[0]), high.max(of_receivers[1])];
    let corner = |index: u32| scene.vertices.get(index as usize).copied();
    scene.triangles.iter().any(|[a, b, c]| match (corner(*a), corner(*b), corner(*c)) {
        (Some(a), Some(b), Some(c)) => meet(box_of([a, b, c]), extent),
        _ => false,
    })
}
