//! The paper's index as rayon jobs: the reference that its ratios are measured on.
//!
//! Seed: Wang et al. 2016, Algorithms 1 to 3. Cells' lists come from counting, a scan and scattering: none has a fixed
//! size. Receivers that the frame buffer has no place for (they touch the light plane, or nearly) share a list of their
//! own, with all triangles; receivers behind the light need none.

use std::sync::{
    Mutex, PoisonError,
    atomic::{AtomicUsize, Ordering},
};

use rayon::prelude::*;
use umbra4_core::{
    Counts, Precision,
    edge_plane::LightGrid,
    glam::IVec3,
    grid::{CellRange, Extent, FrameBuffer, FramePlane, MAX_CELLS},
    lanes::TILE,
    occluder::Occluder,
    proj4::Keys,
    stage::{
        resolve::Group,
        resolve_cells::{CellScene, Rows},
    },
};
use umbra4_cpu_kernels::{Detected, Kernels};

use crate::{
    ExecutorError, block,
    executor::{Answer, Visit},
    scatter::Scatter,
};

/// How triangles and receivers are paired: the masks are the same bits, the time is not.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Index {
    /// [`Index::Silhouette`] where the silhouette has few edges for its triangles, else [`Index::Hierarchy`].
    #[default]
    Auto,
    /// A hierarchy over the triangles, walked by groups of receivers.
    Hierarchy,
    /// The same over the edges at which triangles end that face the light: for meshes, whose triangles share their edges.
    Silhouette,
    /// The paper's frame buffer: the reference. Memory and time grow with what its cells hold.
    Grid(GridOptions),
}

/// Which cells a receiver goes to.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Binning {
    /// The one of its projection from a light corner (Algorithm 2).
    #[default]
    OneCell,
    /// All of its generalised projection (Algorithm 1): a pair is met, and counted, once in each common cell.
    AllCells,
}

/// The paper's optimisations, each of which can be left out.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct GridOptions {
    /// Columns and rows of cells, each in `1..=4096`.
    pub cells: [u32; 2],
    /// Which cells a receiver goes to.
    pub binning: Binning,
    /// Whether pairs are held to the full-coverage test (Algorithm 3, lines 5 and 6).
    pub early_rejection: bool,
    /// How masks are filled.
    pub rows: Rows,
}

impl Default for GridOptions {
    /// The paper's best: 128 × 128 cells (table 6), and all optimisations.
    fn default() -> Self {
        Self { cells: [128; 2], binning: Binning::OneCell, early_rejection: true, rows: Rows::Words }
    }
}

impl GridOptions {
    pub(crate) fn check(&self) -> Result<(), ExecutorError> {
        for (field, value) in [("cells[0]", self.cells[0]), ("cells[1]", self.cells[1])] {
            if !(1..=MAX_CELLS).contains(&value) {
                return Err(ExecutorError::GridCells { field, value });
            }
        }
        Ok(())
    }
}

/// One block of receivers, and the triangles.
pub(crate) struct CellsInput<'a> {
    pub(crate) options: GridOptions,
    pub(crate) isa: Detected,
    pub(crate) precision: Precision,
    pub(crate) light: &'a LightGrid,
    pub(crate) triangles: &'a [Option<(Keys, Occluder)>],
    /// The block's receivers.
    pub(crate) points: &'a [IVec3],
    /// Their keys; `None` behind the light.
    pub(crate) keys: &'a [Option<Keys>],
    /// Index of the block's first receiver.
    pub(crate) first: usize,
}

/// Lists of indices, cell by cell.
#[derive(Default)]
struct Bins {
    /// Where each cell's list starts; one more at the end.
    starts: Vec<usize>,
    entries: Vec<u32>,
}

impl Bins {
    /// Counts, scans and scatters `count` elements that fall in the cells that `ranges` names, of a frame with `columns`
    /// columns and `cells` cells.
    fn new(
        field: &'static str,
        count: usize,
        columns: usize,
        cells: usize,
        ranges: impl Fn(usize) -> Option<CellRange> + Sync,
    ) -> Result<Self, ExecutorError> {
        let cursors: Vec<AtomicUsize> = (0..cells).map(|_| AtomicUsize::new(0)).collect();
        let for_cells = |index: usize, action: &dyn Fn(&AtomicUsize)| {
            let Some(range) = ranges(index) else { return };
            for row in range.first[1]..range.end[1] {
                let start = row as usize * columns;
                cursors[start + range.first[0] as usize..start + range.end[0] as usize].iter().for_each(action);
            }
        };
        (0..count).into_par_iter().for_each(|index| {
            for_cells(index, &|cursor| {
                cursor.fetch_add(1, Ordering::Relaxed);
            });
        });
        let mut starts = Vec::with_capacity(cells + 1);
        let mut total = 0;
        for cursor in &cursors {
            starts.push(total);
            total += cursor.swap(total, Ordering::Relaxed);
        }
        starts.push(total);
        let mut entries: Vec<u32> = Vec::new();
        entries.try_reserve_exact(total).map_err(|_| ExecutorError::GridTooLarge { field, entries: total })?;
        entries.resize(total, 0);
        let out = Scatter::new(&mut entries);
        (0..count).into_par_iter().for_each(|index| {
            for_cells(index, &|cursor| {
                // SAFETY: the cursor hands out each place once.
                unsafe { out.part(cursor.fetch_add(1, Ordering::Relaxed), 1) }.fill(index as u32);
            });
        });
        // Several threads scatter in any order; lists are the same for any number of threads.
        if rayon::current_num_threads() > 1 {
            let lists = Scatter::new(&mut entries);
            starts.par_windows(2).for_each(|ends| {
                // SAFETY: the lists of different cells do not overlap.
                unsafe { lists.part(ends[0], ends[1] - ends[0]) }.sort_unstable();
            });
        }
        Ok(Self { starts, entries })
    }

    fn list(&self, cell: usize) -> &[u32] {
        &self.entries[self.starts[cell]..self.starts[cell + 1]]
    }
}

/// The grid of one block of receivers.
#[derive(Default)]
pub(crate) struct Cells {
    buffer: Option<FrameBuffer>,
    receivers: Bins,
    triangles: Bins,
    /// Receivers without a cell, in front of the light.
    apart: Vec<u32>,
}

/// Receivers that share a lock while masks are put together.
const SHARED: usize = 64;

/// What the cells of [`SHARED`] receivers have found so far.
struct SharedMasks<W> {
    words: Vec<W>,
    /// Relevant pairs of each.
    pairs: [u32; SHARED],
    /// Bit k: receiver k was in a cell.
    met: u64,
}

impl Cells {
    /// Algorithm 1, lines 3 to 6.
    pub(crate) fn define_frame(&mut self, input: &CellsInput<'_>) {
        let highest = input.keys.par_iter().flatten().map(|keys| -keys[4]).reduce(|| 0.0, f32::max);
        let plane = FramePlane::new(&input.light.frame, highest);
        let extent =
            input.keys.par_iter().flatten().map(|keys| plane.stretch(keys)).reduce(|| Extent::EMPTY, Extent::union);
        self.buffer = Some(FrameBuffer::new(plane, extent, input.options.cells));
    }

    /// Algorithm 1, lines 7 to 11, or Algorithm 2. Returns the number of entries.
    pub(crate) fn bin_receivers(&mut self, input: &CellsInput<'_>) -> Result<u64, ExecutorError> {
        let Some(buffer) = &self.buffer else { return Ok(0) };
        let [columns, rows] = buffer.size().map(|n| n as usize);
        let place = |index: usize| {
            let keys = input.keys[index].as_ref()?;
            match input.options.binning {
                Binning::OneCell => buffer.receiver_cell(keys),
                Binning::AllCells => buffer.receiver_cells(keys),
            }
        };
        self.receivers = Bins::new("receivers", input.keys.len(), columns, columns * rows, place)?;
        self.apart = (0..input.keys.len() as u32)
            .into_par_iter()
            .filter(|&index| input.keys[index as usize].is_some_and(|keys| buffer.receiver_cells(&keys).is_none()))
            .collect();
        Ok((self.receivers.entries.len() + self.apart.len()) as u64)
    }

    /// Algorithm 1, lines 12 to 17. Returns the number of entries.
    pub(crate) fn bin_triangles(&mut self, input: &CellsInput<'_>) -> Result<u64, ExecutorError> {
        let Some(buffer) = &self.buffer else { return Ok(0) };
        let [columns, rows] = buffer.size().map(|n| n as usize);
        let place = |index: usize| input.triangles[index].as_ref().map(|(keys, _)| buffer.triangle_cells(keys));
        self.triangles = Bins::new("triangles", input.triangles.len(), columns, columns * rows, place)?;
        Ok(self.triangles.entries.len() as u64)
    }

    /// Algorithm 1, lines 18 to 24, or Algorithm 3. Every receiver of the block is visited once.
    pub(crate) fn resolve<W: Kernels<S>, S>(&self, input: &CellsInput<'_>, visit: Visit<'_, W>) -> Counts {
        let light = &input.light.light;
        let rows = light.rows as usize;
        let full = vec![W::below(light.columns); rows];
        input.keys.par_iter().enumerate().filter(|(_, keys)| keys.is_none()).for_each(|(index, _)| {
            visit(Answer { receiver: input.first + index, rows: &full, lit: false, pairs: 0 });
        });
        let all: Vec<u32> =
            if self.apart.is_empty() { Vec::new() } else { (0..input.triangles.len() as u32).collect() };
        let apart = self.resolve_lists::<W, S>(input, &[(&self.apart, &all)], &|index, group, lane| {
            let pairs = group.relevant[lane];
            visit(Answer { receiver: input.first + index, rows: &group.masks[lane][..rows], lit: false, pairs });
        });
        let lists: Vec<(&[u32], &[u32])> = (0..self.receivers.starts.len().saturating_sub(1))
            .map(|cell| (self.receivers.list(cell), self.triangles_of(cell)))
            .filter(|(receivers, _)| !receivers.is_empty())
            .collect();
        let counts = match input.options.binning {
            Binning::OneCell => self.resolve_lists::<W, S>(input, &lists, &|index, group, lane| {
                let pairs = group.relevant[lane];
                visit(Answer { receiver: input.first + index, rows: &group.masks[lane][..rows], lit: false, pairs });
            }),
            Binning::AllCells => self.resolve_shared::<W, S>(input, &lists, visit),
        };
        apart.plus(counts)
    }

    /// The triangles of a cell; none where there are no triangles at all, and so no pass that bins them.
    fn triangles_of(&self, cell: usize) -> &[u32] {
        if self.triangles.starts.is_empty() { &[] } else { self.triangles.list(cell) }
    }

    /// Lists of receivers, each against its list of triangles. Calls `done(index, group, lane)` for every entry.
    fn resolve_lists<W: Kernels<S>, S>(
        &self,
        input: &CellsInput<'_>,
        lists: &[(&[u32], &[u32])],
        done: &(impl Fn(usize, &Group<W>, usize) + Sync),
    ) -> Counts {
        let light = &input.light.light;
        let scene = CellScene {
            grid: input.light,
            triangles: input.triangles,
            early_rejection: input.options.early_rejection,
            rows: input.options.rows,
        };
        let jobs: Vec<(&[u32], &[u32])> =
            lists.iter().flat_map(|&(receivers, list)| receivers.chunks(TILE).map(move |tile| (tile, list))).collect();
        let empty = Group::<W>::empty(light.rows);
        jobs.par_iter()
            .map_init(
                || Box::new(empty.clone()),
                |group, (tile, list)| {
                    (**group).clone_from(&empty);
                    block::gather(group, light, input.points, input.keys, tile.iter().copied());
                    W::resolve_cell(input.isa, input.precision, &scene, list, group);
                    for (lane, &index) in tile.iter().enumerate() {
                        done(index as usize, group, lane);
                    }
                    group.counts
                },
            )
            .reduce(Counts::default, Counts::plus)
    }

    /// As [`Cells::resolve_lists`], where a receiver is in several cells: its masks are put together, then visited.
    fn resolve_shared<W: Kernels<S>, S>(
        &self,
        input: &CellsInput<'_>,
        lists: &[(&[u32], &[u32])],
        visit: Visit<'_, W>,
    ) -> Counts {
        let rows = input.light.light.rows as usize;
        let count = input.keys.len();
        let empty = || SharedMasks { words: vec![W::EMPTY; SHARED * rows], pairs: [0; SHARED], met: 0 };
        let blocks: Vec<_> = (0..count.div_ceil(SHARED)).map(|_| Mutex::new(empty())).collect();
        let counts = self.resolve_lists::<W, S>(input, lists, &|index, group, lane| {
            let mut block = blocks[index / SHARED].lock().unwrap_or_else(PoisonError::into_inner);
            let SharedMasks { words, pairs, met } = &mut *block;
            let k = index % SHARED;
            for (word, more) in words[k * rows..(k + 1) * rows].iter_mut().zip(&group.masks[lane]) {
                *word = word.or(*more);
            }
            pairs[k] += group.relevant[lane];
            *met |= 1 << k;
        });
        blocks.into_par_iter().enumerate().for_each(|(block, found)| {
            let SharedMasks { words, pairs, met } = found.into_inner().unwrap_or_else(PoisonError::into_inner);
            for k in (0..SHARED).filter(|k| met >> k & 1 == 1) {
                let receiver = input.first + block * SHARED + k;
                visit(Answer { receiver, rows: &words[k * rows..(k + 1) * rows], lit: false, pairs: pairs[k] });
            }
        });
        counts
    }
}
