//! What the paper's optimisations pay: tables 2, 6 and 7 of Wang et al. 2016 as ratios, on the reference grid, with the
//! default hierarchy beside it.

use std::{fmt::Write, path::PathBuf};

use umbra4_cpu::{Binning, CpuExecutor, GridOptions, Index, Occluders, Rows, Statistics};

use crate::{
    compare::CompareError,
    contender::ContenderError,
    image_size::ImageSize,
    primary::hits,
    problem::Problem,
    row_word::RowWord,
    scene::{PAPER_LIGHT, scene},
    subset,
};

/// What is measured.
#[derive(Clone, Debug)]
pub struct Options {
    /// Where the models are.
    pub scenes: PathBuf,
    /// Rows and columns of the light's samples.
    pub samples: u32,
    /// Edge of the image, pixels.
    pub size: u32,
    /// At most about so many receivers.
    pub receivers: usize,
    /// Chooses the receivers.
    pub seed: u64,
    /// Threads of every run.
    pub threads: usize,
    /// Runs of every variant, interleaved; the fastest counts.
    pub repeat: usize,
    /// Cells along each edge of the frame, for table 2 and 7.
    pub cells: u32,
    /// Cells along each edge of the frame, for table 6.
    pub frame: Vec<u32>,
}

/// One run of one variant: the fastest.
#[derive(Clone, Debug)]
struct Measured {
    variant: String,
    seconds: f64,
    statistics: Statistics,
}

impl Measured {
    fn stage(&self, name: &str) -> f64 {
        self.statistics.seconds_by_stage.iter().filter(|(n, _)| *n == name).map(|(_, seconds)| seconds).sum()
    }

    /// Relevant pairs over those tested, and over those kept, in per cent.
    fn efficiency(&self) -> [f64; 2] {
        let counts = self.statistics.counts;
        [counts.pairs_tested, counts.pairs_kept].map(|n| 100.0 * counts.pairs_relevant as f64 / (n as f64).max(1.0))
    }
}

/// All variants on one scene.
#[derive(Clone, Debug)]
pub struct SceneLine {
    scene: String,
    triangles: usize,
    receivers: usize,
    all_receivers: usize,
    bits: u64,
    grid: Measured,
    all_cells: Measured,
    no_rejection: Measured,
    one_sample: Measured,
    hierarchy: Measured,
    frame: Vec<(u32, Measured)>,
}

/// Measures all variants on one scene, on the same receivers, and checks that their masks are the same.
///
/// # Errors
/// An unknown scene; whatever umbra4 refuses.
///
/// # Panics
/// Two variants' masks differ.
pub fn optimisations<W: RowWord>(name: &str, options: &Options) -> Result<SceneLine, CompareError> {
    let scene = scene(name, &options.scenes, options.samples, PAPER_LIGHT)?;
    let all = hits(&scene.model, &scene.camera, ImageSize::square(options.size));
    let chosen: Vec<_> = subset::tiles(&all, options.receivers, options.seed).into_iter().map(|i| all[i]).collect();
    let problem = Problem::new(&scene, &all, &chosen)?;
    let occluders = Occluders::new(&problem.lattice, &problem.model.vertices, &problem.model.triangles)
        .map_err(ContenderError::from)?;
    eprintln!("{name}: {} triangles, {} of {} receivers", occluders.triangles().len(), chosen.len(), all.len());

    let grid = GridOptions { cells: [options.cells; 2], ..GridOptions::default() };
    let mut variants = vec![
        ("grid", Index::Grid(grid)),
        ("without Algorithm 2", Index::Grid(GridOptions { binning: Binning::AllCells, ..grid })),
        ("without rejection", Index::Grid(GridOptions { early_rejection: false, ..grid })),
        ("one sample at a time", Index::Grid(GridOptions { rows: Rows::Bits, ..grid })),
        ("hierarchy", Index::Hierarchy),
    ];
    variants
        .extend(options.frame.iter().map(|&cells| ("frame", Index::Grid(GridOptions { cells: [cells; 2], ..grid }))));
    let mut results: Vec<Measured> = Vec::new();
    let mut expected: Option<Vec<W>> = None;
    for round in 0..options.repeat.max(1) {
        for (index, (variant, how)) in variants.iter().enumerate() {
            let executor = CpuExecutor::new().with_threads(options.threads).map_err(ContenderError::from)?;
            let (masks, statistics) = executor
                .with_index(*how)
                .masks::<W>(&occluders, &problem.light, &problem.receivers)
                .map_err(ContenderError::from)?;
            let measured = Measured { variant: (*variant).to_owned(), seconds: statistics.seconds(), statistics };
            eprintln!("{name}: {variant} {:.3} s", measured.seconds);
            match &expected {
                None => expected = Some(masks.into_words()),
                Some(expected) => assert!(expected == masks.words(), "{variant} has other masks than the grid"),
            }
            if round == 0 {
                results.push(measured);
            } else if measured.seconds < results[index].seconds {
                results[index] = measured;
            }
        }
    }
    let frame = options.frame.iter().copied().zip(results.split_off(5)).collect();
    let mut results = results.into_iter();
    let mut next = || results.next().unwrap_or_else(|| unreachable!("five variants are measured"));
    Ok(SceneLine {
        scene: name.to_owned(),
        triangles: occluders.triangles().len(),
        receivers: chosen.len(),
        all_receivers: all.len(),
        bits: chosen.len() as u64 * u64::from(problem.light.sample_count()),
        grid: next(),
        all_cells: next(),
        no_rejection: next(),
        one_sample: next(),
        hierarchy: next(),
        frame,
    })
}

/// The tables that a reader reads.
pub fn markdown(lines: &[SceneLine], cells: u32) -> String {
    let mut out = String::from(
        "| scene | receivers | receiver redundancy without Algorithm 2 | time without Algorithm 2 ÷ with | early rejection | \
         rows instead of bits | efficiency before → after rejection | grid s | hierarchy: efficiency before → after | \
         hierarchy s |\n|---|--:|--:|--:|--:|--:|--:|--:|--:|--:|\n",
    );
    // Writing to a string cannot fail.
    for line in lines {
        let redundancy = line.all_cells.statistics.receiver_entries as f64 / line.receivers.max(1) as f64;
        let ratio = |other: &Measured| other.stage("resolve_cells") / line.grid.stage("resolve_cells");
        let ([before, after], [above, below]) = (line.grid.efficiency(), line.hierarchy.efficiency());
        let _ = writeln!(
            out,
            "| {} | {} of {} | {redundancy:.1} | {:.1}× | {:.1}× | {:.1}× | {before:.1} % → {after:.1} % | {:.3} | \
             {above:.1} % → {below:.1} % | {:.3} |",
            line.scene,
            line.receivers,
            line.all_receivers,
            ratio(&line.all_cells),
            ratio(&line.no_rejection),
            ratio(&line.one_sample),
            line.grid.seconds,
            line.hierarchy.seconds,
        );
    }
    let bits: u64 = lines.iter().map(|line| line.bits).sum();
    let _ = writeln!(
        out,
        "\nGrid of {cells} × {cells} cells; all variants of a line on the same receivers, with the same masks ({bits} bits). \
         Ratios are of the time to resolve cells (step 5); binning triangles (step 4) is the same in all of them, and does \
         not shrink with the number of receivers.\n"
    );
    out.push_str(
        "| scene | frame | total s | bin triangles s | resolve s | triangles' entries | efficiency before |\n",
    );
    out.push_str("|---|--:|--:|--:|--:|--:|--:|\n");
    for line in lines {
        for (cells, measured) in &line.frame {
            let _ = writeln!(
                out,
                "| {} | {cells}² | {:.3} | {:.3} | {:.3} | {} | {:.1} % |",
                line.scene,
                measured.seconds,
                measured.stage("bin_triangles"),
                measured.stage("resolve_cells"),
                measured.statistics.triangle_entries,
                measured.efficiency()[0],
            );
        }
    }
    out
}

/// The table that a program reads: every variant's own figures.
pub fn csv(lines: &[SceneLine], cells: u32) -> String {
    let mut out = String::from(
        "scene,triangles,receivers,all_receivers,variant,cells,seconds,bin_triangles_seconds,resolve_seconds,\
         receiver_entries,triangle_entries,pairs_tested,pairs_kept,pairs_relevant\n",
    );
    for line in lines {
        let variants = [&line.grid, &line.all_cells, &line.no_rejection, &line.one_sample, &line.hierarchy];
        let variants = variants.into_iter().map(|measured| (cells, measured));
        for (cells, measured) in variants.chain(line.frame.iter().map(|(cells, measured)| (*cells, measured))) {
            let counts = measured.statistics.counts;
            let _ = writeln!(
                out,
                "{},{},{},{},{},{},{},{},{},{},{},{},{},{}",
                line.scene,
                line.triangles,
                line.receivers,
                line.all_receivers,
                measured.variant,
                if measured.variant == "hierarchy" { 0 } else { cells },
                measured.seconds,
                measured.stage("bin_triangles"),
                measured.stage("resolve_cells") + measured.stage("resolve"),
                measured.statistics.receiver_entries,
                measured.statistics.triangle_entries,
                counts.pairs_tested,
                counts.pairs_kept,
                counts.pairs_relevant,
            );
        }
    }
    out
}
