//! Measures all ways to fill masks on the pairs of one scene and light.

use std::{path::Path, time::Instant};

use umbra4_core::{Exact, Fast, MaskWord, stage::resolve::Group};
use umbra4_cpu::{Isa, Occluders};

use super::{
    cells::Cells,
    fill::{Fill, GroupMasks, PlaceOnly, Plain, Repaired, Rows},
    isa::run,
    pairs::{GroupPairs, offered},
    table::{Bounds, Nearest, Table},
};
use crate::{
    compare::CompareError,
    contender::ContenderError,
    image_size::ImageSize,
    primary::{Hit, hits},
    problem::Problem,
    scene::{PAPER_LIGHT, Scene, scene},
    subset,
    timing::{Budget, Progress, Subject, least},
};

/// Groups with fewer pairs are left out: the clock would take part in their times.
const LEAST_PAIRS: usize = 128;
/// So many triangles are filled in one go.
const CHUNK: usize = 32;

/// What is measured.
pub struct Options<'a> {
    /// Where the models are.
    pub scenes: &'a Path,
    /// Rows and columns of the light: 16, 32 or 64, one after the other.
    pub samples: &'a [u32],
    /// Angles, and distances, of the tables.
    pub cells: &'a [u32],
    /// Edge of the image, pixels.
    pub size: u32,
    /// About so many of its receivers are looked at.
    pub receivers: usize,
    /// Chooses them.
    pub seed: u64,
    /// Time for every way to fill masks.
    pub budget: Budget,
}

/// A table and its light on the pairs of one scene.
#[derive(Clone, Debug)]
pub struct Line {
    /// Name of the scene.
    pub scene: String,
    /// Rows and columns of the light.
    pub samples: u32,
    /// Angles, and distances, of the table.
    pub cells: u32,
    /// Pairs.
    pub pairs: usize,
    /// Rows that a pair may change, mean.
    pub rows: f64,
    /// Bytes of the plain table; the one with bounds has twice as many.
    pub bytes: usize,
    /// Times, ÷ that of core's rows, exact.
    pub ratios: Ratios,
    /// Samples that bounds leave open, a pair.
    pub open: f64,
    /// Bits of whole masks that the exact table has otherwise.
    pub differing: u64,
    /// Bits of whole masks that the plain table has otherwise, ÷ bits that the triangles block.
    pub wrong: f64,
}

/// Times, ÷ that of core's rows, exact.
#[derive(Clone, Copy, Debug)]
pub struct Ratios {
    /// Core's rows, without certainty.
    pub fast: f64,
    /// Of the table: finding the cells alone.
    pub place: f64,
    /// Plain table.
    pub plain: f64,
    /// Bounds, and the samples they leave open decided.
    pub repaired: f64,
}

/// Measures one scene, with all lights and tables.
///
/// # Errors
/// No such scene.
pub fn measure(name: &str, options: &Options<'_>) -> Result<Vec<Line>, CompareError> {
    let base = scene(name, options.scenes, 1, PAPER_LIGHT)?;
    let all = hits(&base.model, &base.camera, ImageSize::square(options.size));
    let mut lines = Vec::new();
    for &samples in options.samples {
        let scene = base.clone().with_samples(samples)?;
        lines.extend(match samples {
            ..=16 => of_light::<u16, 16>(name, &scene, &all, options)?,
            17..=32 => of_light::<u32, 32>(name, &scene, &all, options)?,
            _ => of_light::<u64, 64>(name, &scene, &all, options)?,
        });
    }
    Ok(lines)
}

fn of_light<W: MaskWord, const N: usize>(
    name: &str,
    scene: &Scene,
    all: &[Hit],
    options: &Options<'_>,
) -> Result<Vec<Line>, CompareError> {
    let chosen: Vec<Hit> =
        subset::tiles(all, options.receivers, options.seed).into_iter().map(|index| all[index]).collect();
    let problem = Problem::new(scene, all, &chosen)?;
    let occluders = Occluders::new(&problem.lattice, &scene.model.vertices, &scene.model.triangles)
        .map_err(ContenderError::from)?;
    let groups = groups_of(&problem, &occluders);
    let bench = Bench { isa: Isa::best(), problem: &problem, groups: &groups };

    let cells = || options.cells.iter().map(|&cells| cells as usize);
    let plain: Vec<_> = cells().map(|n| Table::<W, Nearest<W, N>, N>::new(n, n)).collect();
    let bounds: Vec<_> = cells().map(|n| Table::<W, Bounds<W, N>, N>::new(n, n)).collect();
    let mut subjects = vec![
        bench.subject::<W, _>("rows", Rows::<Exact>::NEW),
        bench.subject::<W, _>("rows, fast", Rows::<Fast>::NEW),
        bench.subject::<W, _>("cells", PlaceOnly(Cells::new(N, 4, 4))),
    ];
    subjects.extend(plain.iter().map(|table| bench.subject("plain table", Plain(table))));
    subjects.extend(bounds.iter().map(|table| bench.subject("table", Repaired::<W, N, false>(table))));
    let times = least(&subjects, options.budget, &Progress::new(&format!("{name}, {N}² samples")))?;
    drop(subjects);

    let pairs: usize = groups.iter().map(GroupPairs::count).sum();
    let a_pair = |count: u64| count as f64 / pairs.max(1) as f64;
    let rows = a_pair(groups.iter().map(GroupPairs::rows).sum());
    let ratio = |subject: usize| times[subject].seconds / times[0].seconds;
    let lines =
        options.cells.iter().zip(plain.iter().zip(&bounds)).enumerate().map(|(k, (&cells, (plain, bounds)))| {
            let of_plain = bench.differing(&Plain(plain));
            let of_bounds = bench.differing(&Repaired::<W, N, true>(bounds));
            Line {
                scene: name.to_owned(),
                samples: N as u32,
                cells,
                pairs,
                rows,
                bytes: plain.bytes(),
                ratios: Ratios {
                    fast: ratio(1),
                    place: ratio(2),
                    plain: ratio(3 + k),
                    repaired: ratio(3 + options.cells.len() + k),
                },
                open: a_pair(of_bounds.open),
                differing: of_bounds.bits,
                wrong: of_plain.bits as f64 / of_plain.blocked.max(1) as f64,
            }
        });
    Ok(lines.collect())
}

/// Seconds that core's rows take for a pair where nothing is certified, and edges are at hand: with the pairs that matter and
/// no others, masks could be had no sooner. NaN where no receiver has enough of them.
///
/// # Errors
/// A vertex that is refused.
pub fn seconds_a_pair<W: MaskWord>(problem: &Problem<'_>, budget: Budget) -> Result<f64, ContenderError> {
    let occluders = Occluders::new(&problem.lattice, &problem.model.vertices, &problem.model.triangles)?;
    let groups = groups_of(problem, &occluders);
    let bench = Bench { isa: Isa::best(), problem, groups: &groups };
    let times = least(&[bench.subject::<W, _>("rows", Rows::<Fast>::NEW)], budget, &Progress::new("rows alone"))?;
    let pairs: usize = groups.iter().map(GroupPairs::count).sum();
    Ok(times.first().map_or(f64::NAN, |time| time.seconds / pairs as f64))
}

/// Groups of a problem's receivers that have enough pairs.
fn groups_of(problem: &Problem<'_>, occluders: &Occluders) -> Vec<GroupPairs> {
    let corners = (0..occluders.triangles().len()).filter_map(|index| occluders.corners(index));
    let offered = offered(&problem.light, corners);
    let groups = problem.receivers.points().chunks(umbra4_core::lanes::TILE);
    let groups = groups.map(|points| GroupPairs::new(&problem.light, points, &offered));
    groups.filter(|group| group.count() >= LEAST_PAIRS).collect()
}

/// The pairs that everything is measured on.
struct Bench<'a> {
    isa: Isa,
    problem: &'a Problem<'a>,
    groups: &'a [GroupPairs],
}

/// What a way to fill masks does otherwise than core's rows.
#[derive(Clone, Copy, Debug, Default)]
struct Difference {
    bits: u64,
    blocked: u64,
    open: u64,
}

impl<'a> Bench<'a> {
    fn subject<'s, W: MaskWord, F: Fill<W> + 's>(&'s self, name: &str, fill: F) -> Subject<'s>
    where
        'a: 's,
    {
        Subject { name: name.to_owned(), run: Box::new(move || Ok(self.seconds::<W, F>(&fill))) }
    }

    /// Seconds that the masks of all groups take. Lines are put into the cache before the clock starts, where core has just
    /// written them; a table has to come by itself.
    fn seconds<W: MaskWord, F: Fill<W>>(&self, fill: &F) -> f64 {
        let light = &self.problem.light;
        let empty: GroupMasks<W> = Group::empty(light.rows).masks;
        let (mut masks, mut sum) = (empty, 0.0);
        let mut hot = GroupPairs::EMPTY;
        for group in self.groups {
            masks.clone_from(&empty);
            for first in (0..group.lanes.len()).step_by(CHUNK) {
                hot.take(group, first..group.lanes.len().min(first + CHUNK));
                let start = Instant::now();
                run(self.isa, fill, light, &hot, &mut masks);
                sum += start.elapsed().as_secs_f64();
            }
            std::hint::black_box(&mut masks);
        }
        sum
    }

    fn differing<W: MaskWord, F: Fill<W>>(&self, fill: &F) -> Difference {
        let light = &self.problem.light;
        let empty: GroupMasks<W> = Group::empty(light.rows).masks;
        let mut difference = Difference::default();
        for group in self.groups {
            let (mut expected, mut found) = (empty, empty);
            run(self.isa, &Rows::<Exact>::NEW, light, group, &mut expected);
            difference.open += run(self.isa, fill, light, group, &mut found);
            for (expected, found) in expected.iter().zip(&found) {
                for (&expected, &found) in expected.iter().zip(found).take(light.rows as usize) {
                    difference.bits += u64::from(expected.xor(found).count());
                    difference.blocked += u64::from(expected.count());
                }
            }
        }
        difference
    }
}
