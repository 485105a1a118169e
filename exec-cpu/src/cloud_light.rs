//! The ways to ask about a cloud.

use rayon::prelude::*;
use umbra4_core::{
    IndexKind, Plan, Precision, SceneFacts,
    cloud::{Cloud, CloudMask},
    cloud_order::OrderedCloud,
    cloud_table::CloudTable,
    cloud_tiles::CloudTiles,
    glam::IVec3,
    shaft::{box_of, meet},
    stage::reduce,
};
use umbra4_cpu_kernels::CloudKernels;

use crate::{
    CloudMasks, CpuExecutor, ExecutorError, Occluders, Receivers, Statistics,
    cloud::{CloudInput, CloudRun},
    executor::BLOCK,
    morton::around,
    scatter::Scatter,
};

/// Triangles that are worth a job.
const PART: usize = 1 << 12;

impl CpuExecutor {
    /// What will run for a cloud.
    pub fn cloud_plan<S: AsRef<[IVec3]>>(
        &self,
        occluders: &Occluders,
        cloud: &Cloud<S>,
        receivers: &Receivers,
        visibility: bool,
    ) -> Plan {
        cloud_plan(occluders, receivers, extent(cloud, receivers), Ask { visibility, table: false })
    }

    /// The same by a table.
    pub fn cloud_plan_by_table<C: AsRef<[IVec3]>, S: AsRef<[u32]>>(
        &self,
        occluders: &Occluders,
        table: &CloudTable<'_, C, S>,
        receivers: &Receivers,
        visibility: bool,
    ) -> Plan {
        cloud_plan(occluders, receivers, extent(table.cloud(), receivers), Ask { visibility, table: true })
    }

    /// The masks of all receivers before a cloud of samples. They are exact, bit by bit, in [`umbra4_core::Precision::Exact`].
    ///
    /// ```
    /// use umbra4_cpu::{CpuExecutor, Occluders, Receivers};
    /// use umbra4_core::{SphereLight, glam::{DVec3, IVec3, Vec3}, Bounds, Lattice};
    ///
    /// let lattice = Lattice::covering(Bounds { min: DVec3::splat(-4.0), max: DVec3::splat(4.0) })?;
    /// let vertices = [Vec3::new(-1.0, 1.0, -1.0), Vec3::new(1.0, 1.0, -1.0), Vec3::new(0.0, 1.0, 1.0)];
    /// let occluders = Occluders::new(&lattice, &vertices, &[[0, 1, 2]])?;
    /// let receivers = Receivers::raw(&lattice, &[Vec3::ZERO, Vec3::new(3.0, 0.0, 0.0)])?;
    ///
    /// let lamp = SphereLight { center: DVec3::new(0.0, 3.0, 0.0), radius: 0.5 }.snap(&lattice, [IVec3::ZERO; 256])?;
    /// let (masks, _) = CpuExecutor::new().cloud_masks(&occluders, &lamp, &receivers)?;
    /// assert_eq!(masks.receiver(0), Some(&[u32::MAX; 8][..])); // 256 samples, all blocked
    /// assert_eq!(masks.receiver(1), Some(&[0; 8][..]));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// Masks that would not fit the address space.
    pub fn cloud_masks<S: AsRef<[IVec3]>>(
        &self,
        occluders: &Occluders,
        cloud: &Cloud<S>,
        receivers: &Receivers,
    ) -> Result<(CloudMasks, Statistics), ExecutorError> {
        let arranged = OrderedCloud::new(cloud.samples());
        let tiles = CloudTiles::new(arranged.samples());
        let light = CloudLight { cloud, tiles: &tiles, test: &tiles, precision: self.precision, table: false };
        self.stored(occluders, light, receivers, |mask, out| arranged.write(mask, out))
    }

    /// The fraction of a cloud's samples that every receiver sees, in `0.0..=1.0`. Masks are never stored.
    ///
    /// ```
    /// use umbra4_cpu::{CpuExecutor, Occluders, Receivers};
    /// use umbra4_core::{TubeLight, glam::{DVec3, IVec3, Vec3}, Bounds, Lattice};
    ///
    /// let lattice = Lattice::covering(Bounds { min: DVec3::splat(-4.0), max: DVec3::splat(4.0) })?;
    /// let vertices = [Vec3::new(-9.0, 1.0, -3.0), Vec3::new(0.0, 1.0, -3.0), Vec3::new(0.0, 1.0, 3.0)].map(|v| v * 0.4);
    /// let occluders = Occluders::new(&lattice, &vertices, &[[0, 1, 2]])?;
    /// let receivers = Receivers::raw(&lattice, &[Vec3::ZERO, Vec3::new(3.0, 0.0, 0.0)])?;
    ///
    /// let tube = TubeLight { from: DVec3::new(-2.0, 3.0, 0.0), to: DVec3::new(2.0, 3.0, 0.0), radius: 0.1 };
    /// let tube = tube.snap(&lattice, vec![IVec3::ZERO; 100])?;
    /// let (visibility, _) = CpuExecutor::new().cloud_visibility(&occluders, &tube, &receivers)?;
    /// assert!(visibility[0] > 0.4 && visibility[0] < 0.6); // half of it stands behind the triangle
    /// assert_eq!(visibility[1], 1.0);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// None yet.
    pub fn cloud_visibility<S: AsRef<[IVec3]>>(
        &self,
        occluders: &Occluders,
        cloud: &Cloud<S>,
        receivers: &Receivers,
    ) -> Result<(Vec<f32>, Statistics), ExecutorError> {
        let fractions = fractions(cloud);
        self.per_receiver_of_cloud(occluders, cloud, receivers, |lit| fractions[lit as usize])
    }

    /// How many samples of a cloud every receiver sees. Masks are never stored.
    ///
    /// ```
    /// use umbra4_cpu::{CpuExecutor, Occluders, Receivers};
    /// use umbra4_core::{cloud::Cloud, glam::{DVec3, IVec3, Vec3}, Bounds, Lattice};
    ///
    /// let lattice = Lattice::covering(Bounds { min: DVec3::splat(-4.0), max: DVec3::splat(4.0) })?;
    /// let vertices = [Vec3::new(-1.0, 1.0, -1.0), Vec3::new(1.0, 1.0, -1.0), Vec3::new(0.0, 1.0, 1.0)];
    /// let occluders = Occluders::new(&lattice, &vertices, &[[0, 1, 2]])?;
    /// let receivers = Receivers::raw(&lattice, &[Vec3::ZERO])?;
    ///
    /// let samples = [DVec3::new(0.0, 2.0, 0.0), DVec3::new(3.0, 2.0, 0.0)].map(|p| lattice.snap_f64(p));
    /// let samples: Vec<IVec3> = samples.into_iter().collect::<Result<_, _>>()?;
    /// let (lit, _) = CpuExecutor::new().cloud_lit_counts(&occluders, &Cloud::new(samples)?, &receivers)?;
    /// assert_eq!(lit, [1]);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// None yet.
    pub fn cloud_lit_counts<S: AsRef<[IVec3]>>(
        &self,
        occluders: &Occluders,
        cloud: &Cloud<S>,
        receivers: &Receivers,
    ) -> Result<(Vec<u32>, Statistics), ExecutorError> {
        self.per_receiver_of_cloud(occluders, cloud, receivers, |lit| lit)
    }

    /// The masks of all receivers before the cloud of a table, by its lookups: not exact, see [`umbra4_core::cloud_table`], but
    /// the same bits on every executor, whatever its precision. For a few hundred samples that saves no time.
    ///
    /// ```
    /// use umbra4_cpu::{CpuExecutor, Occluders, Receivers};
    /// use umbra4_core::{SphereLight, cloud_table::{CloudTable, TableSize}, glam::{DVec3, IVec3, Vec3}, Bounds, Lattice};
    ///
    /// let lattice = Lattice::covering(Bounds { min: DVec3::splat(-4.0), max: DVec3::splat(4.0) })?;
    /// let vertices = [Vec3::new(-1.0, 1.0, -1.0), Vec3::new(1.0, 1.0, -1.0), Vec3::new(0.0, 1.0, 1.0)];
    /// let occluders = Occluders::new(&lattice, &vertices, &[[0, 1, 2]])?;
    /// let receivers = Receivers::raw(&lattice, &[Vec3::ZERO, Vec3::new(3.0, 0.0, 0.0)])?;
    ///
    /// let lamp = SphereLight { center: DVec3::new(0.0, 3.0, 0.0), radius: 0.5 }.snap(&lattice, [IVec3::ZERO; 128])?;
    /// let size = TableSize { directions: 16, distances: 32 };
    /// let table = CloudTable::new(&lamp, size, vec![0; CloudTable::words_of(&lamp, size)?])?;
    /// let (masks, _) = CpuExecutor::new().cloud_masks_by_table(&occluders, &table, &receivers)?;
    /// assert_eq!((masks.receiver(0), masks.receiver(1)), (Some(&[u32::MAX; 4][..]), Some(&[0; 4][..])));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// Masks that would not fit the address space.
    pub fn cloud_masks_by_table<C: AsRef<[IVec3]> + Sync, S: AsRef<[u32]> + Sync>(
        &self,
        occluders: &Occluders,
        table: &CloudTable<'_, C, S>,
        receivers: &Receivers,
    ) -> Result<(CloudMasks, Statistics), ExecutorError> {
        let tiles = CloudTiles::new(table.cloud().samples());
        self.stored(occluders, CloudLight::by_table(table, &tiles, &table.planes()), receivers, |mask, out| {
            // In the table's order, which is the caller's.
            out.copy_from_slice(&mask[..out.len()]);
        })
    }

    /// [`CpuExecutor::cloud_visibility`] by the lookups of a table.
    ///
    /// # Errors
    /// None yet.
    pub fn cloud_visibility_by_table<C: AsRef<[IVec3]> + Sync, S: AsRef<[u32]> + Sync>(
        &self,
        occluders: &Occluders,
        table: &CloudTable<'_, C, S>,
        receivers: &Receivers,
    ) -> Result<(Vec<f32>, Statistics), ExecutorError> {
        let (fractions, tiles) = (fractions(table.cloud()), CloudTiles::new(table.cloud().samples()));
        let planes = table.planes();
        let light = CloudLight::by_table(table, &tiles, &planes);
        self.per_receiver_of(occluders, light, receivers, |lit| fractions[lit as usize])
    }

    /// [`CpuExecutor::cloud_lit_counts`] by the lookups of a table.
    ///
    /// # Errors
    /// None yet.
    pub fn cloud_lit_counts_by_table<C: AsRef<[IVec3]> + Sync, S: AsRef<[u32]> + Sync>(
        &self,
        occluders: &Occluders,
        table: &CloudTable<'_, C, S>,
        receivers: &Receivers,
    ) -> Result<(Vec<u32>, Statistics), ExecutorError> {
        let tiles = CloudTiles::new(table.cloud().samples());
        self.per_receiver_of(occluders, CloudLight::by_table(table, &tiles, &table.planes()), receivers, |lit| lit)
    }

    fn per_receiver_of_cloud<S: AsRef<[IVec3]>, V: Copy + Send>(
        &self,
        occluders: &Occluders,
        cloud: &Cloud<S>,
        receivers: &Receivers,
        value: impl Fn(u32) -> V + Sync,
    ) -> Result<(Vec<V>, Statistics), ExecutorError> {
        let arranged = OrderedCloud::new(cloud.samples());
        let tiles = CloudTiles::new(arranged.samples());
        let light = CloudLight { cloud, tiles: &tiles, test: &tiles, precision: self.precision, table: false };
        self.per_receiver_of(occluders, light, receivers, value)
    }

    fn per_receiver_of<S: AsRef<[IVec3]>, T: CloudKernels, V: Copy + Send>(
        &self,
        occluders: &Occluders,
        light: CloudLight<'_, S, T>,
        receivers: &Receivers,
        value: impl Fn(u32) -> V + Sync,
    ) -> Result<(Vec<V>, Statistics), ExecutorError> {
        let mut values = vec![value(light.tiles.len() as u32); receivers.len()];
        let out = Scatter::new(&mut values);
        let statistics = self.run_cloud(occluders, light, receivers, true, |receiver, _, lit| {
            // SAFETY: every receiver is visited once, and its element is its own.
            unsafe { out.part(receiver, 1) }.fill(value(lit));
        })?;
        Ok((values, statistics))
    }

    /// The masks, as `write` puts each of them over zeros.
    fn stored<S: AsRef<[IVec3]>, T: CloudKernels>(
        &self,
        occluders: &Occluders,
        light: CloudLight<'_, S, T>,
        receivers: &Receivers,
        write: impl Fn(&CloudMask, &mut [u32]) + Sync,
    ) -> Result<(CloudMasks, Statistics), ExecutorError> {
        let width = light.cloud.words();
        let too_many = ExecutorError::TooManyWords { receivers: receivers.len(), rows: width as u32 };
        let count = receivers.len().checked_mul(width).ok_or_else(|| too_many.clone())?;
        // The system's zero pages: those of receivers in full light are never touched.
        let mut words = bytemuck::allocation::try_zeroed_vec::<u32>(count).map_err(|()| too_many)?;
        let out = Scatter::new(&mut words);
        let samples = light.tiles.len() as u32;
        let statistics = self.run_cloud(occluders, light, receivers, false, |receiver, mask, lit| {
            if lit < samples {
                // SAFETY: every receiver is visited once, and its part is its own.
                write(mask, unsafe { out.part(receiver * width, width) });
            }
        })?;
        Ok((CloudMasks { width, words }, statistics))
    }

    fn run_cloud<S: AsRef<[IVec3]>, T: CloudKernels>(
        &self,
        scene: &Occluders,
        light: CloudLight<'_, S, T>,
        receivers: &Receivers,
        visibility: bool,
        visit: impl Fn(usize, &CloudMask, u32) + Sync,
    ) -> Result<Statistics, ExecutorError> {
        let CloudLight { cloud, tiles, test, precision, table } = light;
        let (isa, extent) = (self.isa, extent(cloud, receivers));
        let work = || {
            let plan = cloud_plan(scene, receivers, extent, Ask { visibility, table });
            let input = CloudInput { plan: &plan, isa, precision, cloud: tiles, test, scene, receivers, extent };
            CloudRun::new(input, &visit).finish()
        };
        self.install(work)
    }
}

/// A cloud, and how its samples are told apart.
struct CloudLight<'a, S, T> {
    cloud: &'a Cloud<S>,
    /// In the order of a mask's bits.
    tiles: &'a CloudTiles<'a>,
    test: &'a T,
    precision: Precision,
    /// Whether `test` is a table.
    table: bool,
}

impl<'a, C, T> CloudLight<'a, C, T> {
    /// By a table: certified always, since what is found in floats before a lookup has to be right.
    fn by_table<S: AsRef<[u32]>>(table: &CloudTable<'a, C, S>, tiles: &'a CloudTiles<'a>, test: &'a T) -> Self {
        Self { cloud: table.cloud(), tiles, test, precision: Precision::Exact, table: true }
    }
}

/// What is asked for, as a plan says it.
struct Ask {
    visibility: bool,
    table: bool,
}

/// Visibility, by the samples that are lit.
fn fractions<S: AsRef<[IVec3]>>(cloud: &Cloud<S>) -> Vec<f32> {
    let samples = cloud.samples().len() as u32;
    (0..=samples).map(|lit| reduce::visibility(lit, samples)).collect()
}

/// The box around a cloud and all receivers: nothing outside of it blocks anything.
fn extent<S: AsRef<[IVec3]>>(cloud: &Cloud<S>, receivers: &Receivers) -> [IVec3; 2] {
    let [low, high] = cloud.bounds();
    if receivers.is_empty() {
        return [low, high];
    }
    let of_receivers = around(receivers.points());
    [low.min(of_receivers[0]), high.max(of_receivers[1])]
}

/// Where no triangle reaches into `extent` there is nothing to do for any receiver.
fn cloud_plan(occluders: &Occluders, receivers: &Receivers, extent: [IVec3; 2], ask: Ask) -> Plan {
    let ids = (0..occluders.triangles().len()).into_par_iter().with_min_len(PART);
    let reached = ids.any(|id| occluders.corners(id).is_some_and(|corners| meet(box_of(corners), extent)));
    Plan::new(SceneFacts {
        triangles: occluders.triangles().len() as u32,
        receivers: receivers.len() as u32,
        visibility: ask.visibility,
        table: ask.table,
        block: BLOCK,
        index: IndexKind::Shafts,
        arranged: occluders.arrangement().is_some(),
        reached,
        facing: !receivers.facings().is_empty(),
        ..SceneFacts::default()
    })
}
