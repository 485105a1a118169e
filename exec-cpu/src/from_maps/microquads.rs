//! Microquad soft shadow mapping on CPU threads.

use std::{
    sync::atomic::{AtomicU32, Ordering},
    time::Instant,
};

use rayon::prelude::*;
use umbra4_core::{LatticeLight, MaskWord, glam::IVec3, light::MAX_SAMPLES, stage::reduce};
use umbra4_maps::{
    draw,
    microquad::{
        Footprint, MicroquadError, MicroquadOptions,
        fit::{self, LightAxes, Tangents},
        gather::{ByArea, ByRectangles, ByRows, ByTable, Gathered, gather, visibility},
        half_spaces::{self, TableWord},
        params::MicroquadParams,
    },
    pyramid::{self, Node},
};

use crate::{CpuExecutor, ExecutorError, Masks, Occluders, Receivers, Statistics};

/// Triangles, or receivers, that are worth a job.
const PART: usize = 1 << 8;

/// A light's shadow map, with what is made of it: its pyramid, and the table of half-spaces where one is used.
#[derive(Clone, Debug)]
pub struct ShadowMap {
    params: MicroquadParams,
    footprint: Footprint,
    texels: Vec<u32>,
    nodes: Vec<Node>,
    table: Vec<u32>,
    beyond: u64,
}

impl ShadowMap {
    /// Texels along each edge.
    pub fn size(&self) -> u32 {
        self.params.frame().size()
    }

    /// Inverse depths, row by row, in units of the inverse near distance: 1 at the near distance, 0 where nothing was drawn.
    pub fn inverse_depths(&self) -> impl Iterator<Item = f32> {
        self.texels.iter().map(|word| f32::from_bits(*word))
    }

    /// Receivers before the light that lie beyond [`umbra4_maps::microquad::MapOptions::widest`]: the map does not show what stands before
    /// them.
    pub fn receivers_beyond(&self) -> u64 {
        self.beyond
    }

    /// What kernels are told.
    pub fn params(&self) -> &MicroquadParams {
        &self.params
    }

    /// The texels' words, the pyramid, and the table: what kernels read.
    pub fn buffers(&self) -> (&[u32], &[Node], &[u32]) {
        (&self.texels, &self.nodes, &self.table)
    }

    /// Draws the map and builds what goes with it. `statistics` get the time of each stage.
    fn new(
        options: &MicroquadOptions,
        occluders: &Occluders,
        light: &LatticeLight,
        receivers: &Receivers,
        statistics: &mut Statistics,
    ) -> Self {
        let start = Instant::now();
        let params = fitted(options, occluders, light, receivers);
        let (params, beyond) = params;
        statistics.add_seconds("fit_map", start.elapsed().as_secs_f64());

        let start = Instant::now();
        let texels = drawn(&params, occluders);
        statistics.add_seconds("draw_map", start.elapsed().as_secs_f64());

        let start = Instant::now();
        let nodes = pyramid_of(&texels, params.frame().size());
        statistics.add_seconds("build_pyramid", start.elapsed().as_secs_f64());

        let start = Instant::now();
        let table = table(options, light);
        if !table.is_empty() {
            statistics.add_seconds("build_table", start.elapsed().as_secs_f64());
        }
        Self { params, footprint: options.footprint, texels, nodes, table, beyond }
    }

    fn gather<G: Gathered>(&self, p: IVec3, out: &mut G) {
        gather(&self.params, &self.texels, &self.nodes, &self.table, p, out);
    }
}

fn fitted(
    options: &MicroquadOptions,
    occluders: &Occluders,
    light: &LatticeLight,
    receivers: &Receivers,
) -> (MicroquadParams, u64) {
    let axes = LightAxes::new(light);
    let with = |tangents: Tangents, p: &IVec3| tangents.with(&axes, options.map.widest, *p);
    let points = receivers.points().par_iter().with_min_len(PART);
    let tangents = points.fold(|| Tangents::NONE, with).reduce(|| Tangents::NONE, Tangents::union);
    let nearest = (0..occluders.triangles().len())
        .into_par_iter()
        .with_min_len(PART)
        .filter_map(|id| Some(tangents.nearest(&axes, occluders.corners(id)?)))
        .reduce(|| f64::INFINITY, f64::min);
    (fit::params(options, light, &tangents, nearest), tangents.beyond)
}

fn drawn(params: &MicroquadParams, occluders: &Occluders) -> Vec<u32> {
    let size = params.frame().size();
    let map: Vec<AtomicU32> = (0..size * size).into_par_iter().map(|_| AtomicU32::new(0)).collect();
    let a = params.arithmetic();
    (0..occluders.triangles().len()).into_par_iter().with_min_len(PART).for_each(|id| {
        let Some(corners) = occluders.corners(id) else { return };
        let drawing = draw::set_up(a, params.frame(), corners);
        for y in drawing.rows[0]..drawing.rows[1] {
            for x in drawing.columns[0]..drawing.columns[1] {
                let word = drawing.texel(a, x, y);
                if word != 0 {
                    // The greatest of all words: the same whatever comes first.
                    map[(y * size + x) as usize].fetch_max(word, Ordering::Relaxed);
                }
            }
        }
    });
    map.into_iter().map(AtomicU32::into_inner).collect()
}

fn pyramid_of(map: &[u32], size: u32) -> Vec<Node> {
    let mut nodes = vec![Node::default(); pyramid::start(size, pyramid::levels(size)) as usize];
    let tiles = pyramid::start(size, 1) as usize;
    nodes[..tiles].par_iter_mut().with_min_len(PART).enumerate().for_each(|(index, node)| {
        *node = pyramid::tile(map, size, index as u32);
    });
    for level in 1..pyramid::levels(size) {
        let (first, end) = (pyramid::start(size, level), pyramid::start(size, level + 1));
        let (below, level_nodes) = nodes.split_at_mut(first as usize);
        level_nodes[..(end - first) as usize].par_iter_mut().with_min_len(PART).enumerate().for_each(
            |(index, node)| {
                *node = pyramid::parent(below, size, level, index as u32);
            },
        );
    }
    nodes
}

fn table(options: &MicroquadOptions, light: &LatticeLight) -> Vec<u32> {
    let Footprint::Table(fineness) = options.footprint else { return Vec::new() };
    let mut words = vec![0; half_spaces::table_length(light, fineness)];
    let entries = (fineness.directions * fineness.distances) as usize;
    let entry = words.len() / entries;
    words.par_chunks_exact_mut(entry.max(1)).with_min_len(64).enumerate().for_each(|(index, rows)| {
        half_spaces::write_entry(light, fineness, index, rows);
    });
    words
}

impl CpuExecutor {
    /// The shadow map that [`CpuExecutor::microquad_masks`] would use: where it looks, what it shows, and the time of its stages.
    ///
    /// # Errors
    /// Options that are refused: [`MicroquadOptions::check`].
    pub fn shadow_map(
        &self,
        options: &MicroquadOptions,
        occluders: &Occluders,
        light: &LatticeLight,
        receivers: &Receivers,
    ) -> Result<(ShadowMap, Statistics), ExecutorError> {
        options.check(light)?;
        let mut statistics = Statistics::default();
        let map = self.install(|| ShadowMap::new(options, occluders, light, receivers, &mut statistics));
        Ok((map, statistics))
    }

    /// Approximate masks of all receivers, from micro-occluders: bits as those of [`CpuExecutor::masks`], and where they go.
    ///
    /// ```
    /// use umbra4_cpu::{CpuExecutor, Occluders, Receivers, maps::microquad::MicroquadOptions};
    /// use umbra4_core::{glam::{DVec3, Vec3}, AreaLight, Bounds, Lattice, Lift};
    ///
    /// let vertices = [Vec3::new(-1.0, 1.0, -1.0), Vec3::new(1.0, 1.0, -1.0), Vec3::new(0.0, 1.0, 1.0)];
    /// let light = AreaLight::new(DVec3::new(-0.5, 3.0, -0.5), DVec3::X, DVec3::Z, 16, 16)?; // X × Z = −Y: shines down
    /// let lattice = Lattice::covering(Bounds { min: DVec3::splat(-4.0), max: DVec3::splat(4.0) })?;
    /// let occluders = Occluders::new(&lattice, &vertices, &[[0, 1, 2]])?;
    /// let receivers = Receivers::raw(&lattice, &[Vec3::ZERO, Vec3::new(3.0, 0.0, 0.0)])?;
    /// let light = light.snap(&lattice, Lift::NONE)?;
    ///
    /// let options = MicroquadOptions::default();
    /// let (masks, _) = CpuExecutor::new().microquad_masks::<u16>(&options, &occluders, &light, &receivers)?;
    /// let blocked = |receiver: &[u16]| receiver.iter().map(|row| row.count_ones()).sum::<u32>();
    /// assert!(masks.receiver(0).map(blocked) > Some(128) && masks.receiver(1).map(blocked) == Some(0));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// Options that are refused: [`MicroquadOptions::check`], and areas, of which there are no masks; a word that is too narrow; masks that would not fit
    /// the memory.
    pub fn microquad_masks<W: TableWord>(
        &self,
        options: &MicroquadOptions,
        occluders: &Occluders,
        light: &LatticeLight,
        receivers: &Receivers,
    ) -> Result<(Masks<W>, Statistics), ExecutorError> {
        if light.columns > W::BITS {
            return Err(ExecutorError::WordTooNarrow { columns: light.columns, bits: W::BITS });
        }
        if options.footprint == Footprint::Area {
            return Err(MicroquadError::NoMasks.into());
        }
        let rows = light.rows as usize;
        let too_many = || ExecutorError::TooManyWords { receivers: receivers.len(), rows: light.rows };
        let count = receivers.len().checked_mul(rows).ok_or_else(too_many)?;
        let mut words = bytemuck::allocation::try_zeroed_vec::<W>(count).map_err(|()| too_many())?;
        let (map, mut statistics) = self.shadow_map(options, occluders, light, receivers)?;
        let start = Instant::now();
        self.install(|| {
            words.par_chunks_exact_mut(rows).enumerate().with_min_len(PART).for_each(|(index, out)| {
                if receivers.facing_of(index).is_away_from(light, receivers.points()[index]) {
                    out.fill(W::below(light.columns));
                } else {
                    out.copy_from_slice(&map.mask::<W>(receivers.points()[index])[..rows]);
                }
            });
        });
        statistics.add_seconds("gather", start.elapsed().as_secs_f64());
        Ok((Masks { rows, words }, statistics))
    }

    /// The approximate fraction of the light that every receiver sees, from micro-occluders: of its samples, or, by
    /// [`Footprint::Area`], of its area. In `0.0..=1.0`. Masks are never stored.
    ///
    /// # Errors
    /// Options that are refused: [`MicroquadOptions::check`].
    pub fn microquad_visibility(
        &self,
        options: &MicroquadOptions,
        occluders: &Occluders,
        light: &LatticeLight,
        receivers: &Receivers,
    ) -> Result<(Vec<f32>, Statistics), ExecutorError> {
        let (map, mut statistics) = self.shadow_map(options, occluders, light, receivers)?;
        let start = Instant::now();
        let seen = |(index, p): (usize, &IVec3)| match light.columns {
            _ if receivers.facing_of(index).is_away_from(light, *p) => 0.0,
            _ if options.footprint == Footprint::Area => {
                let mut area = ByArea::default();
                map.gather(*p, &mut area);
                visibility(map.params.arithmetic(), &map.params, area.0)
            }
            0..=16 => lit::<u16>(light, &map.mask(*p)),
            17..=32 => lit::<u32>(light, &map.mask(*p)),
            _ => lit::<u64>(light, &map.mask(*p)),
        };
        let visibility =
            self.install(|| receivers.points().par_iter().enumerate().with_min_len(PART).map(seen).collect());
        statistics.add_seconds("gather", start.elapsed().as_secs_f64());
        Ok((visibility, statistics))
    }

    /// On this executor's threads.
    fn install<T: Send>(&self, work: impl FnOnce() -> T + Send) -> T {
        match &self.pool {
            Some(pool) => pool.install(work),
            None => work(),
        }
    }
}

impl ShadowMap {
    /// The mask of a receiver.
    fn mask<W: TableWord>(&self, p: IVec3) -> [W; MAX_SAMPLES as usize] {
        let empty = [W::EMPTY; MAX_SAMPLES as usize];
        match self.footprint {
            Footprint::Rows => {
                let mut mask = ByRows(empty);
                self.gather(p, &mut mask);
                mask.0
            }
            Footprint::Table(_) => {
                let mut mask = ByTable(empty);
                self.gather(p, &mut mask);
                mask.0
            }
            // Areas have none, and are not asked.
            Footprint::Rectangles | Footprint::Area => {
                let mut mask = ByRectangles(empty);
                self.gather(p, &mut mask);
                mask.0
            }
        }
    }
}

fn lit<W: MaskWord>(light: &LatticeLight, mask: &[W; MAX_SAMPLES as usize]) -> f32 {
    let lit = reduce::lit_count(&mask[..light.rows as usize], light.columns);
    reduce::visibility(lit, light.sample_count())
}
