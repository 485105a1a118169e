//! Microquad soft shadow mapping on CPU threads.

use std::{
    sync::atomic::{AtomicU32, Ordering},
    time::Instant,
};

use rayon::prelude::*;
use umbra4_core::{LatticeLight, MaskWord, glam::IVec3, light::MAX_SAMPLES, stage::reduce};
use umbra4_maps::{
    draw::set_up,
    kernel::{BUILD_PYRAMID, DRAW_MAP, GATHER},
    microquad::{
        DrawnMap, Footprint, MicroquadError, MicroquadOptions,
        fit::{self, LightAxes, Tangents},
        gather::{ByArea, ByMask, Gathered, InMask, Rectangles, Rows, Table, gather_facing, visibility},
        half_spaces::{self, TableWord},
        params::MicroquadParams,
        rows::Mask,
    },
    pyramid::{self, Node},
};

use crate::{CpuExecutor, ExecutorError, Masks, Occluders, Receivers, Statistics};

/// Triangles, or receivers, that are worth a job.
const PART: usize = 1 << 8;

/// A light's shadow map, as it was drawn.
pub type ShadowMap = DrawnMap<Vec<u32>, Vec<Node>>;

/// Draws the map and builds what goes with it. `statistics` get the time of each stage.
fn draw(
    options: &MicroquadOptions,
    occluders: &Occluders,
    light: &LatticeLight,
    receivers: &Receivers,
    statistics: &mut Statistics,
) -> ShadowMap {
    let start = Instant::now();
    let (params, beyond) = fitted(options, occluders, light, receivers);
    statistics.add_seconds("fit_map", start.elapsed().as_secs_f64());

    let start = Instant::now();
    let texels = drawn(&params, occluders);
    statistics.add_seconds(DRAW_MAP, start.elapsed().as_secs_f64());

    let start = Instant::now();
    let nodes = pyramid_of(&texels, params.frame().size());
    statistics.add_seconds(BUILD_PYRAMID, start.elapsed().as_secs_f64());

    let start = Instant::now();
    let table = table(options, light);
    if !table.is_empty() {
        statistics.add_seconds("build_table", start.elapsed().as_secs_f64());
    }
    ShadowMap::new(params, texels, nodes, table, beyond)
}

/// Adds what blocks a receiver, or, where it faces away, everything.
fn add<G: Gathered>(map: &ShadowMap, receivers: &Receivers, index: usize, out: &mut G) {
    let (texels, nodes, table) = map.buffers();
    let (p, facing) = (receivers.points()[index], receivers.facing_of(index));
    gather_facing(map.params(), texels, nodes, table, p, facing, out);
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
        let drawing = set_up(a, params.frame(), corners);
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
        let map = self.install(|| draw(options, occluders, light, receivers, &mut statistics));
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
        let rows = light.rows as usize;
        let too_many = || ExecutorError::TooManyWords { receivers: receivers.len(), rows: light.rows };
        let count = receivers.len().checked_mul(rows).ok_or_else(too_many)?;
        let words = bytemuck::allocation::try_zeroed_vec::<W>(count).map_err(|()| too_many())?;
        let mut masks = Masks { rows, words };
        let statistics = self.add_microquad_masks(options, occluders, light, receivers, &mut masks)?;
        Ok((masks, statistics))
    }

    /// Adds the bits of [`CpuExecutor::microquad_masks`] to masks that are there: those of the exact system for other occluders, for example.
    ///
    /// # Errors
    /// Those of [`CpuExecutor::microquad_masks`]; masks of other receivers, or of another light.
    pub fn add_microquad_masks<W: TableWord>(
        &self,
        options: &MicroquadOptions,
        occluders: &Occluders,
        light: &LatticeLight,
        receivers: &Receivers,
        masks: &mut Masks<W>,
    ) -> Result<Statistics, ExecutorError> {
        if light.columns > W::BITS {
            return Err(ExecutorError::WordTooNarrow { columns: light.columns, bits: W::BITS });
        }
        if options.footprint == Footprint::Area {
            return Err(MicroquadError::NoMasks.into());
        }
        let (rows, words) = (light.rows as usize, masks.words.len());
        if masks.rows != rows || words != receivers.len() * rows {
            return Err(ExecutorError::MaskCount { words, receivers: receivers.len(), rows: light.rows });
        }
        let (map, mut statistics) = self.shadow_map(options, occluders, light, receivers)?;
        let start = Instant::now();
        self.install(|| {
            masks.words.par_chunks_exact_mut(rows).enumerate().with_min_len(PART).for_each(|(index, own)| {
                let mut mask = [W::EMPTY; MAX_SAMPLES as usize];
                mask[..rows].copy_from_slice(own);
                own.copy_from_slice(&masked(options.footprint, &map, receivers, index, mask)[..rows]);
            });
        });
        statistics.add_seconds(GATHER, start.elapsed().as_secs_f64());
        Ok(statistics)
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
        let footprint = options.footprint;
        let seen = |index: usize| match light.columns {
            _ if footprint == Footprint::Area => {
                let mut area = ByArea::default();
                add(&map, receivers, index, &mut area);
                visibility(map.params().arithmetic(), map.params(), area.0)
            }
            0..=16 => lit::<u16>(light, &masked(footprint, &map, receivers, index, [0; MAX_SAMPLES as usize])),
            17..=32 => lit::<u32>(light, &masked(footprint, &map, receivers, index, [0; MAX_SAMPLES as usize])),
            _ => lit::<u64>(light, &masked(footprint, &map, receivers, index, [0; MAX_SAMPLES as usize])),
        };
        let visibility = self.install(|| (0..receivers.len()).into_par_iter().with_min_len(PART).map(seen).collect());
        statistics.add_seconds(GATHER, start.elapsed().as_secs_f64());
        Ok((visibility, statistics))
    }
}

/// A receiver's mask, with what is in it already.
fn masked<W: TableWord>(
    footprint: Footprint,
    map: &ShadowMap,
    receivers: &Receivers,
    index: usize,
    mask: Mask<W>,
) -> Mask<W> {
    fn with<W: MaskWord, F: InMask<W>>(map: &ShadowMap, receivers: &Receivers, index: usize, mask: Mask<W>) -> Mask<W> {
        let mut out = ByMask::<W, F>::of(mask);
        add(map, receivers, index, &mut out);
        out.mask
    }
    match footprint {
        Footprint::Rows => with::<W, Rows>(map, receivers, index, mask),
        Footprint::Table(_) => with::<W, Table>(map, receivers, index, mask),
        // Areas have none, and are not asked.
        Footprint::Rectangles | Footprint::Area => with::<W, Rectangles>(map, receivers, index, mask),
    }
}

fn lit<W: MaskWord>(light: &LatticeLight, mask: &Mask<W>) -> f32 {
    let lit = reduce::lit_count(&mask[..light.rows as usize], light.columns);
    reduce::visibility(lit, light.sample_count())
}
