//! The comparison: every contender on the same receivers and light, interleaved, the best of several runs each.

use std::path::PathBuf;

use thiserror::Error;
use umbra4_core::Counts;

use crate::{
    contender::{ContenderError, Entry, Run, by_name},
    image_size::ImageSize,
    primary::hits,
    problem::{Problem, ProblemError},
    row_word::RowWord,
    scene::{SceneError, scene},
    subset,
    table::{Line, Pairs},
};

/// Why a comparison stops.
#[derive(Debug, Error)]
pub enum CompareError {
    /// A scene cannot be set up.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// A scene does not fit the lattice.
    #[error(transparent)]
    Problem(#[from] ProblemError),
    /// A contender fails.
    #[error(transparent)]
    Contender(#[from] ContenderError),
    /// A file cannot be written.
    #[error("{0}")]
    Io(#[from] std::io::Error),
    /// A curve has no such point.
    #[error("the curve over {curve} has no point {point}; it has {points}")]
    NoPoint {
        /// What is varied.
        curve: &'static str,
        /// The point asked for.
        point: String,
        /// Points that there are.
        points: String,
    },
}

/// What is compared.
#[derive(Clone, Debug)]
pub struct Options {
    /// Where the models are.
    pub scenes: PathBuf,
    /// Names of the contenders.
    pub contenders: Vec<String>,
    /// Rows and columns of the light's samples.
    pub samples: u32,
    /// Edge of the image, pixels.
    pub size: u32,
    /// Threads of every contender.
    pub threads: usize,
    /// Least number of runs of every contender.
    pub repeat: usize,
    /// Seconds that every contender is measured for, at least.
    pub seconds: f64,
    /// The diagonal of the light in the paper's units.
    pub light: f64,
    /// At most about so many receivers for everybody.
    pub receivers: usize,
    /// At most about so many receivers for the rivals.
    pub rival_receivers: usize,
    /// Chooses the subsets.
    pub seed: u64,
    /// Where to write the first contender's visibility, as a grey picture.
    pub picture: Option<PathBuf>,
}

/// What came out for one scene.
#[derive(Clone, Debug)]
pub struct Comparison {
    /// The setting, and what the first contender's masks say about it.
    pub setting: String,
    /// A line a contender.
    pub lines: Vec<Line>,
}

/// Runs all contenders on one scene, and says what is going on on stderr.
///
/// # Errors
/// An unknown scene or contender; whatever a contender refuses.
pub fn compare<W: RowWord>(name: &str, options: &Options) -> Result<Comparison, CompareError> {
    let entries = options.contenders.iter().map(|name| by_name(name)).collect::<Result<Vec<Entry<W>>, _>>()?;
    let scene = scene(name, &options.scenes, options.samples, options.light)?;
    let all = hits(&scene.model, &scene.camera, ImageSize::square(options.size));
    let chosen: Vec<_> = subset::tiles(&all, options.receivers, options.seed).into_iter().map(|i| all[i]).collect();
    let rival_indices = subset::tiles(&chosen, options.rival_receivers, options.seed);
    let rival_hits: Vec<_> = rival_indices.iter().map(|&i| chosen[i]).collect();
    let ours = Problem::new(&scene, &all, &chosen)?;
    let theirs = Problem::new(&scene, &all, &rival_hits)?;
    let problem = |entry: &Entry<W>| if entry.ours { &ours } else { &theirs };
    let results = measure(name, &entries, options, problem)?;

    if let (Some(path), Some(entry), Some(first)) = (&options.picture, entries.first(), results.first()) {
        let hits = if entry.ours { &chosen } else { &rival_hits };
        crate::picture::write(path, options.size, hits, &first.masks, ours.light.sample_count())?;
    }

    let rows = ours.rows();
    let exact = entries.iter().position(|entry| entry.name == "umbra4");
    let micros = |measured: &Measured<W>, receivers: usize| {
        // Building is shared by all receivers, also where only some of them were measured.
        1e6 * (measured.build / chosen.len().max(1) as f64 + measured.masks_seconds / receivers.max(1) as f64)
    };
    let lines = entries.iter().zip(&results).map(|(entry, measured)| {
        let receivers = if entry.ours { chosen.len() } else { rival_hits.len() };
        let differing = exact.map(|exact| {
            let exact = results[exact].masks.chunks_exact(rows);
            let other = measured.masks.chunks_exact(rows);
            if entry.ours {
                differing_bits(exact, other)
            } else {
                let exact: Vec<&[W]> = exact.collect();
                differing_bits(rival_indices.iter().map(|&i| exact[i]), other)
            }
        });
        Line {
            scene: name.to_owned(),
            triangles: scene.model.triangles.len(),
            contender: entry.name.clone(),
            threads: options.threads,
            samples: options.samples,
            receivers,
            all_receivers: chosen.len(),
            runs: measured.runs,
            build_seconds: measured.build,
            masks_seconds: measured.masks_seconds,
            micros: micros(measured, receivers),
            ratio: exact.map(|exact| micros(measured, receivers) / micros(&results[exact], chosen.len())),
            pairs: measured.counts.map(|counts| Pairs::per_receiver(counts, receivers)),
            differing,
        }
    });
    let lines = lines.collect();
    let first = results.first().map_or(&[][..], |first| &first.masks);
    let setting = format!(
        "{name}: {} triangles, {}; {} receivers of {} pixels, {} behind the light; {}",
        scene.model.triangles.len(),
        scene.setting(),
        chosen.len(),
        options.size * options.size,
        ours.count_behind_light(),
        light_and_shadow(first, rows, ours.light.sample_count()),
    );
    Ok(Comparison { setting, lines })
}

/// What is known of one contender: the least time that building and masks took, each over all runs.
struct Measured<W> {
    runs: usize,
    build: f64,
    masks_seconds: f64,
    counts: Option<Counts>,
    masks: Vec<W>,
}

/// Runs all contenders in turn, always the one that was measured for the shortest time, so that whatever disturbs the
/// machine disturbs all of them, and all have about the same time to find their least in.
fn measure<'a, W: RowWord>(
    name: &str,
    entries: &[Entry<W>],
    options: &Options,
    problem: impl Fn(&Entry<W>) -> &'a Problem<'a>,
) -> Result<Vec<Measured<W>>, CompareError> {
    let nothing = |_| Measured { runs: 0, build: f64::MAX, masks_seconds: f64::MAX, counts: None, masks: Vec::new() };
    let mut results: Vec<Measured<W>> = entries.iter().map(nothing).collect();
    let mut spent = vec![0.0; entries.len()];
    loop {
        let unfinished = |&i: &usize| spent[i] < options.seconds || results[i].runs < options.repeat.max(1);
        let next = (0..entries.len()).filter(unfinished).min_by(|&a, &b| f64::total_cmp(&spent[a], &spent[b]));
        let Some(next) = next else { return Ok(results) };
        let (entry, problem) = (&entries[next], problem(&entries[next]));
        let mut masks = vec![W::EMPTY; problem.receivers.len() * problem.rows()];
        let Run { build, masks: masks_seconds, counts } = entry.contender.run(problem, options.threads, &mut masks)?;
        eprintln!("{name}: {} {build:.3} + {masks_seconds:.3} s", entry.name);
        spent[next] += build + masks_seconds;
        let best = &mut results[next];
        *best = Measured {
            runs: best.runs + 1,
            build: best.build.min(build),
            masks_seconds: best.masks_seconds.min(masks_seconds),
            counts,
            masks,
        };
    }
}

/// How much of the light receivers see, in words.
fn light_and_shadow<W: RowWord>(masks: &[W], rows: usize, samples: u32) -> String {
    let (mut blocked, mut penumbra, mut receivers) = (0, 0_u64, 0_u64);
    for mask in masks.chunks_exact(rows.max(1)) {
        let count: u32 = mask.iter().map(|word| word.count()).sum();
        blocked += u64::from(count);
        penumbra += u64::from(count > 0 && count < samples);
        receivers += 1;
    }
    let receivers = receivers.max(1) as f64;
    let visibility = 1.0 - blocked as f64 / (receivers * f64::from(samples));
    format!("mean visibility {visibility:.3}, {:.1} % of the receivers in penumbra", 1e2 * penumbra as f64 / receivers)
}

/// Bits that differ between two equally long sequences of masks.
fn differing_bits<'a, W: RowWord>(
    a: impl ExactSizeIterator<Item = &'a [W]>,
    b: impl ExactSizeIterator<Item = &'a [W]>,
) -> u64 {
    assert_eq!(a.len(), b.len(), "masks of different receivers");
    let words = a.zip(b).flat_map(|(a, b)| a.iter().zip(b));
    words.map(|(&a, &b)| u64::from(a.without(b).count() + b.without(a).count())).sum()
}

#[cfg(test)]
#[expect(clippy::unwrap_used, reason = "a test may panic")]
mod tests {
    use super::*;
    use crate::scene::tiny;

    /// Rays in f32 may miss the true answer on bits where a ray grazes an edge; more than this is a mistake.
    const GRAZING_SHARE: f64 = 1e-3;

    fn agrees<W: RowWord>(samples: u32, name: &str) {
        let scene = tiny(samples);
        let hits: Vec<_> = hits(&scene.model, &scene.camera, ImageSize::square(24));
        let problem = Problem::new(&scene, &hits, &hits).unwrap();
        let masks = |name: &str, threads: usize| {
            let mut masks = vec![W::EMPTY; problem.receivers.len() * problem.rows()];
            by_name(name).unwrap().contender.run(&problem, threads, &mut masks).unwrap();
            masks
        };
        let exact = masks("umbra4", 1);
        let blocked: u64 = exact.iter().map(|word| u64::from(word.count())).sum();
        let bits = (exact.len() as u64) * u64::from(samples);
        assert!(blocked > bits / 50 && blocked < bits / 2, "{blocked} of {bits} bits are blocked");
        for threads in [1, 2] {
            let other = masks(name, threads);
            let rows = problem.rows();
            let differing = differing_bits(exact.chunks_exact(rows), other.chunks_exact(rows));
            assert!(
                (differing as f64) < GRAZING_SHARE * bits as f64,
                "{name}, {samples}², {threads} threads: {differing} of {bits} bits differ"
            );
        }
    }

    #[test]
    fn bvh_rivals_agree() {
        for name in ["obvhs", "obvhs-cwbvh", "obvhs-fast", "obvhs-cwbvh-medium"] {
            agrees::<u32>(32, name);
        }
        agrees::<u64>(37, "obvhs");
        agrees::<u16>(13, "obvhs");
    }

    #[cfg(feature = "embree")]
    #[test]
    fn embree_agrees() {
        let names = ["embree1", "embree8", "embree16", "embree8-square-robust", "embree16-square-high"];
        for name in names {
            agrees::<u32>(32, name);
            agrees::<u64>(37, name);
            agrees::<u32>(5, name);
            agrees::<u16>(16, name);
        }
    }

    #[cfg(all(feature = "tinybvh", target_feature = "avx2"))]
    #[test]
    fn tinybvh_agrees() {
        agrees::<u32>(32, "tinybvh");
        agrees::<u64>(37, "tinybvh-high");
    }

    #[test]
    fn a_differing_bit_is_counted() {
        let (a, b) = ([5_u32, 0], [4_u32, 8]);
        assert_eq!(differing_bits(a.chunks_exact(1), b.chunks_exact(1)), 2);
    }

    #[test]
    fn unknown_names_are_refused() {
        for name in ["", "umbra", "obvhs-", "embree", "embree4", "embree8-low"] {
            assert!(by_name::<u32>(name).is_err(), "{name}");
        }
    }
}
