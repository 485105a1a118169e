//! The bits on whole scenes: random receivers, all triangles, against both oracles.
//!
//! Three kinds of receivers: surface points that the camera sees, lifted off their surface as a renderer asks for them;
//! the same points raw, in the very planes of their triangles but for rounding; and points anywhere in the scene's box.
//!
//! Oracles are slow, and what goes wrong once in ten million bits is not met by a few receivers. So all points of a whole
//! image are also compared with the planes' own masks, one sample at a time: integers decide there too, but none of what
//! makes rows fast takes part.

use std::{fmt::Write, path::PathBuf, time::Instant};

use thiserror::Error;
use umbra4_core::{
    Bounds, LatticeLight,
    glam::{DVec3, IVec3, Vec3},
};
use umbra4_cpu::{CpuExecutor, ExecutorError, GridOptions, Index, Occluders, Precision, Receivers, Rows};
use umbra4_tests::{
    compare::{Amount, Mismatch, bits_of, compare_masks},
    oracle,
    rng::Rng,
};
use umbra4_wgpu::{Choice, Gpu, GpuError, LatticeScene, WgpuExecutor};

use crate::{
    image_size::ImageSize,
    primary::{Hit, hits},
    problem::{Problem, ProblemError},
    row_word::RowWord,
    scene::{self, Scene, SceneError, scene},
    unsnapped::{Moved, Unsnapped},
};

/// Edge of the image whose pixels are the surface points to choose from.
const IMAGE: u32 = 256;

/// Random points of either kind among which those in penumbra are looked for.
const CANDIDATES: usize = 4096;

/// One in so many points of the box may lie behind the light, where there is not much to get wrong.
const BEHIND: usize = 8;

/// Why a verification stops. That bits differ is not among it: that is a result.
#[derive(Debug, Error)]
pub enum VerifyError {
    /// A scene cannot be set up.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// A scene does not fit the lattice.
    #[error(transparent)]
    Problem(#[from] ProblemError),
    /// Occluders or receivers are refused.
    #[error(transparent)]
    Occluders(#[from] umbra4_cpu::SceneError),
    /// The executor refuses to run.
    #[error(transparent)]
    Executor(#[from] ExecutorError),
    /// The GPU refuses to run.
    #[error(transparent)]
    Gpu(#[from] GpuError),
    /// The masks cannot even be compared.
    #[error("{scene}: {source}")]
    Masks {
        /// Name of the scene.
        scene: String,
        /// Why not.
        source: Mismatch,
    },
    /// None of the scenes is there.
    #[error("none of the scenes is in {}: bench/fetch-scenes.sh fetches them", .0.display())]
    NoScenes(PathBuf),
    /// A scene that has to be verified is not there.
    #[error("{name} is required but not in {}", directory.display())]
    Missing {
        /// Name of the scene.
        name: String,
        /// Where it was looked for.
        directory: PathBuf,
    },
    /// The camera sees nothing.
    #[error("{0}: there are no surface points")]
    NoSurface(String),
    /// No receiver is partly lit, so that hardly anything was put to the test.
    #[error("{0}: no receiver is in penumbra")]
    NoPenumbra(String),
}

/// What is verified.
#[derive(Clone, Debug)]
pub struct Options {
    /// Where the models are.
    pub scenes: PathBuf,
    /// Names of the scenes to verify, where they are there.
    pub names: Vec<String>,
    /// Names of the scenes that have to be there.
    pub require: Vec<String>,
    /// Receivers anywhere: half of them surface points, half points of the box. As many come from penumbrae.
    pub receivers: usize,
    /// Receivers of each kind that the second oracle is asked about.
    pub unsnapped: usize,
    /// Edge of the image whose receivers are compared with one sample at a time, pixels.
    pub image: u32,
    /// The diagonal of the light in the paper's units.
    pub light: f64,
    /// Chooses the receivers.
    pub seed: u64,
    /// The adapter whose masks are compared with the oracle too.
    pub gpu: Option<Choice>,
}

/// Verifies all scenes that are there.
///
/// # Errors
/// No scene, or not one that is required; whatever cannot be set up or run.
pub fn verify(options: &Options) -> Result<Report, VerifyError> {
    let is_there = |name: &String| scene::is_there(name, &options.scenes);
    for name in &options.require {
        if !is_there(name)? {
            return Err(VerifyError::Missing { name: name.clone(), directory: options.scenes.clone() });
        }
    }
    let open = |choice: &Choice| Gpu::open(choice).map(WgpuExecutor::new);
    let mut report = Report { gpu: options.gpu.as_ref().map(open).transpose()?, ..Report::default() };
    let optional = options.names.iter().filter(|name| !options.require.contains(name));
    for name in options.require.iter().chain(optional) {
        if is_there(name)? {
            report.add(name, options)?;
        } else {
            report.missing.push(name.clone());
        }
    }
    if report.oracle.is_empty() { Err(VerifyError::NoScenes(options.scenes.clone())) } else { Ok(report) }
}

/// All results.
#[derive(Debug, Default)]
pub struct Report {
    gpu: Option<WgpuExecutor>,
    missing: Vec<String>,
    oracle: Vec<OracleLine>,
    unsnapped: Vec<UnsnappedLine>,
    rows: Vec<RowsLine>,
}

/// One scene and resolution of the light, against the oracle on the lattice.
#[derive(Debug)]
struct OracleLine {
    scene: String,
    triangles: usize,
    samples: u32,
    receivers: usize,
    penumbra: usize,
    bits: u64,
    blocked: u64,
    exact: u64,
    fast: u64,
    /// Bits of the GPU that differ, where one is asked.
    gpu: Option<u64>,
}

/// One scene and kind of receiver, against the oracle on the original coordinates.
#[derive(Debug)]
struct UnsnappedLine {
    scene: String,
    kind: &'static str,
    moved: Moved,
}

/// One scene and resolution of the light: rows at once, by the hierarchy, against one sample at a time, by the grid.
#[derive(Debug)]
struct RowsLine {
    scene: String,
    samples: u32,
    receivers: usize,
    bits: u64,
    differing: u64,
}

/// Receivers of one kind.
struct Kind {
    name: &'static str,
    receivers: Receivers,
    /// The coordinates they were snapped from, where they were not moved then.
    world: Vec<Vec3>,
}

impl Report {
    /// True where all bits are the oracle's, the snap explains all that the second oracle says otherwise, and one sample at
    /// a time gives the same masks.
    pub fn holds(&self) -> bool {
        self.oracle.iter().all(|line| line.exact == 0 && line.gpu.is_none_or(|differing| differing == 0))
            && self.unsnapped.iter().all(|line| line.moved.unexplained == 0)
            && self.rows.iter().all(|line| line.differing == 0)
    }

    fn add(&mut self, name: &str, options: &Options) -> Result<(), VerifyError> {
        let start = Instant::now();
        let scene = scene(name, &options.scenes, 32, options.light)?;
        let image = hits(&scene.model, &scene.camera, ImageSize::square(options.image));
        let hits = hits(&scene.model, &scene.camera, ImageSize::square(IMAGE));
        let mut rng = Rng::named(options.seed, name);
        let (surface, free) = random_receivers(&scene, &hits, options.receivers, &mut rng)?;
        if surface.is_empty() {
            return Err(VerifyError::NoSurface(name.to_owned()));
        }
        self.check::<u32>(name, &scene, &surface, &free, options, true)?;
        self.compare_rows::<u32>(name, &scene, &image)?;
        let scene = scene.with_samples(64)?;
        self.check::<u64>(name, &scene, &surface, &free, options, false)?;
        self.compare_rows::<u64>(name, &scene, &image)?;
        eprintln!("{name}: {:.1} s", start.elapsed().as_secs_f64());
        Ok(())
    }

    /// Checks one resolution of the light, the second oracle included where `unsnapped` is set.
    fn check<W: RowWord>(
        &mut self,
        name: &str,
        scene: &Scene,
        surface: &[Hit],
        free: &[Vec3],
        options: &Options,
        unsnapped: bool,
    ) -> Result<(), VerifyError> {
        let problem = Problem::new(scene, surface, surface)?;
        let (lattice, light) = (&problem.lattice, &problem.light);
        let occluders = Occluders::new(lattice, &scene.model.vertices, &scene.model.triangles)?;
        let triangles: Vec<[IVec3; 3]> =
            (0..scene.model.triangles.len()).filter_map(|t| occluders.corners(t)).collect();
        let masks = |precision, receivers: &Receivers| -> Result<Vec<W>, VerifyError> {
            let executor = CpuExecutor::new().with_precision(precision);
            Ok(executor.masks::<W>(&occluders, light, receivers)?.0.into_words())
        };
        let raw = |name, world: Vec<Vec3>| -> Result<Kind, VerifyError> {
            Ok(Kind { name, receivers: Receivers::raw(lattice, &world)?, world })
        };
        let positions: Vec<Vec3> = surface.iter().map(|hit| hit.position).collect();
        let kinds = [raw("on surfaces, raw", positions)?, raw("in the box", free.to_vec())?];

        let (mut expected, mut exact, mut fast, mut receivers) = (Vec::new(), Vec::new(), Vec::new(), 0);
        let mut on_gpu: Vec<W> = Vec::new();
        let on_lattice = LatticeScene { vertices: occluders.vertices(), triangles: occluders.triangles() };
        for points in [&problem.receivers, &kinds[0].receivers, &kinds[1].receivers] {
            receivers += points.len();
            expected.extend(oracle::oracle_masks(light, points.points(), &triangles));
            exact.extend(masks(Precision::Exact, points)?);
            fast.extend(masks(Precision::Fast, points)?);
            if let Some(gpu) = &self.gpu {
                on_gpu.extend(gpu.masks::<W>(&on_lattice, light, points.points())?.0);
            }
        }
        let penumbra = expected.chunks_exact(light.rows as usize).filter(|mask| in_penumbra(mask, light)).count();
        if penumbra == 0 {
            return Err(VerifyError::NoPenumbra(name.to_owned()));
        }
        self.oracle.push(OracleLine {
            scene: name.to_owned(),
            triangles: triangles.len(),
            samples: light.rows,
            receivers,
            penumbra,
            bits: expected.len() as u64 * u64::from(light.columns),
            blocked: expected.iter().map(|word| u64::from(word.count_ones())).sum(),
            exact: differing(name, "exact", &expected, &exact, light)?,
            fast: differing(name, "fast", &expected, &fast, light)?,
            gpu: self.gpu.as_ref().map(|_| differing(name, "on the GPU", &expected, &on_gpu, light)).transpose()?,
        });

        if unsnapped {
            // The lifted points as a ray tracer starts from them: rounded to f32, and raw from there on.
            let lifted = raw("lifted off surfaces", problem.origins.clone())?;
            let oracle = Unsnapped::new(scene, &problem, &triangles);
            for Kind { name: kind, receivers, world } in [lifted].iter().chain(&kinds) {
                let masks: Vec<u64> = masks(Precision::Exact, receivers)?.into_iter().map(bits_of).collect();
                let chosen = penumbra_first(&masks, light, options.unsnapped);
                let moved = oracle.moved(&chosen, world, receivers.points(), &masks);
                self.unsnapped.push(UnsnappedLine { scene: name.to_owned(), kind, moved });
            }
        }
        Ok(())
    }

    /// Compares the masks of all `hits` with those that are filled one sample at a time.
    fn compare_rows<W: RowWord>(&mut self, name: &str, scene: &Scene, hits: &[Hit]) -> Result<(), VerifyError> {
        if hits.is_empty() {
            return Err(VerifyError::NoSurface(name.to_owned()));
        }
        let problem = Problem::new(scene, hits, hits)?;
        let light = &problem.light;
        let occluders = Occluders::new(&problem.lattice, &scene.model.vertices, &scene.model.triangles)?;
        let masks = |index| -> Result<Vec<W>, VerifyError> {
            let executor = CpuExecutor::new().with_index(index);
            Ok(executor.masks::<W>(&occluders, light, &problem.receivers)?.0.into_words())
        };
        let one_at_a_time = Index::Grid(GridOptions { rows: Rows::Bits, ..GridOptions::default() });
        let expected: Vec<u64> = masks(one_at_a_time)?.into_iter().map(bits_of).collect();
        self.rows.push(RowsLine {
            scene: name.to_owned(),
            samples: light.rows,
            receivers: hits.len(),
            bits: expected.len() as u64 * u64::from(light.columns),
            differing: differing(name, "rows at once", &expected, &masks(Index::default())?, light)?,
        });
        Ok(())
    }

    /// The tables that a reader reads.
    pub fn markdown(&self) -> String {
        let mut out = String::from(
            "| scene | triangles | samples | receivers | in penumbra | bits | blocked | exact: differing | \
             fast: differing | GPU: differing |\n|---|--:|--:|--:|--:|--:|--:|--:|--:|--:|\n",
        );
        // Writing to a string cannot fail.
        for line in &self.oracle {
            let OracleLine { scene, triangles, samples, receivers, penumbra, bits, .. } = line;
            let (blocked, exact, fast) = (1e2 * line.blocked as f64 / *bits as f64, line.exact, line.fast);
            let gpu = line.gpu.map_or_else(|| "not asked".to_owned(), |differing| differing.to_string());
            let _ = writeln!(
                out,
                "| {scene} | {triangles} | {samples}² | {receivers} | {penumbra} | {bits} | {blocked:.1} % | {exact} | \
                 {fast} | {gpu} |",
            );
        }
        out.push_str(
            "\nAll triangles against random receivers: surface points lifted, the same raw, and points of the scene's \
             box, half of each chosen from penumbrae; against determinants of the lattice coordinates in 128-bit integers.",
        );
        if let Some(gpu) = &self.gpu {
            let _ = write!(out, " The GPU is {}.", gpu.gpu().name);
        }
        out.push_str(
            "\n\n\
             | scene | receivers | of them | bits | moved by the snap | not explained by it |\n\
             |---|---|--:|--:|--:|--:|\n",
        );
        for UnsnappedLine { scene, kind, moved: Moved { receivers, bits, moved, unexplained } } in &self.unsnapped {
            let _ = writeln!(out, "| {scene} | {kind} | {receivers} | {bits} | {moved} | {unexplained} |");
        }
        out.push_str(
            "\nThe same masks against exact rational arithmetic on the original f32 coordinates. Raw points lie in their \
             triangles' planes but for rounding: there, the snap may decide on which side.\n",
        );
        out.push_str("\n| scene | samples | receivers | bits | differing |\n|---|--:|--:|--:|--:|\n");
        for RowsLine { scene, samples, receivers, bits, differing } in &self.rows {
            let _ = writeln!(out, "| {scene} | {samples}² | {receivers} | {bits} | {differing} |");
        }
        let bits: u64 = self.rows.iter().map(|line| line.bits).sum();
        let _ = writeln!(out, "\nAll points of an image: rows at once against one sample at a time, {bits} bits.");
        for name in &self.missing {
            let _ = writeln!(out, "\n**{name} is not there and was not verified.**");
        }
        out
    }
}

/// Half of `wanted` as surface points that the camera sees, half as points of the box around the model; then as many of
/// both again, from those in penumbra alone, where there are so many: there, bits are decided by edges.
fn random_receivers(
    scene: &Scene,
    hits: &[Hit],
    wanted: usize,
    rng: &mut Rng,
) -> Result<(Vec<Hit>, Vec<Vec3>), VerifyError> {
    let half = wanted.div_ceil(2);
    let any: Vec<Hit> = (0..half).filter_map(|_| Some(*hits.get(rng.below(hits.len().max(1)))?)).collect();
    let normal = scene.lamp.edge_u.cross(scene.lamp.edge_v);
    let Bounds { min, max } = scene.extent;
    let mut free: Vec<Vec3> = Vec::new();
    while free.len() < half + CANDIDATES {
        let point = min + (max - min) * DVec3::new(rng.unit(), rng.unit(), rng.unit());
        if normal.dot(point - scene.lamp.corner) > 0.0 || rng.one_in(BEHIND) {
            free.push(point.as_vec3());
        }
    }
    let candidates: Vec<Hit> = (0..CANDIDATES).filter_map(|_| Some(*hits.get(rng.below(hits.len().max(1)))?)).collect();

    let problem = Problem::new(scene, &candidates, &candidates)?;
    let occluders = Occluders::new(&problem.lattice, &scene.model.vertices, &scene.model.triangles)?;
    let is_penumbra = |receivers: &Receivers| -> Result<Vec<bool>, VerifyError> {
        let (visibility, _) = CpuExecutor::new().visibility(&occluders, &problem.light, receivers)?;
        Ok(visibility.into_iter().map(|lit| lit > 0.0 && lit < 1.0).collect())
    };
    let in_the_box = is_penumbra(&Receivers::raw(&problem.lattice, &free)?)?;
    let on_surfaces = is_penumbra(&problem.receivers)?;
    let surface = any.into_iter().chain(chosen(&candidates, &on_surfaces, half)).collect();
    let free = free[..half].iter().copied().chain(chosen(&free[half..], &in_the_box[half..], half)).collect();
    Ok((surface, free))
}

/// The first `most` items whose flag is set.
fn chosen<T: Copy>(items: &[T], flags: &[bool], most: usize) -> impl Iterator<Item = T> {
    items.iter().zip(flags).filter(|(_, flag)| **flag).map(|(item, _)| *item).take(most)
}

fn in_penumbra(mask: &[u64], light: &LatticeLight) -> bool {
    let blocked: u32 = mask.iter().map(|word| word.count_ones()).sum();
    blocked > 0 && blocked < light.sample_count()
}

/// Up to `wanted` receivers, those in penumbra first: elsewhere there is little that could be moved.
fn penumbra_first(masks: &[u64], light: &LatticeLight, wanted: usize) -> Vec<usize> {
    let masks: Vec<&[u64]> = masks.chunks_exact(light.rows as usize).collect();
    let (mut chosen, others): (Vec<usize>, Vec<usize>) = (0..masks.len()).partition(|&i| in_penumbra(masks[i], light));
    chosen.extend(others);
    chosen.truncate(wanted);
    chosen
}

/// How many bits differ from the oracle's; the first is named on stderr.
fn differing<W: RowWord>(
    scene: &str,
    how: &str,
    expected: &[u64],
    got: &[W],
    light: &LatticeLight,
) -> Result<u64, VerifyError> {
    match compare_masks(expected, got, light.rows, light.columns, Amount::Some) {
        Ok(_) => Ok(0),
        Err(mismatch @ Mismatch::Bit { differing, .. }) => {
            eprintln!("{scene}, {how}: {mismatch}");
            Ok(differing)
        }
        Err(source) => Err(VerifyError::Masks { scene: scene.to_owned(), source }),
    }
}

#[cfg(test)]
#[expect(clippy::unwrap_used, reason = "a test may panic")]
mod tests {
    use super::*;
    use crate::scene::tiny;

    fn options() -> Options {
        let names = ["dragon48k", "sponza"].map(str::to_owned).to_vec();
        let (scenes, require) = (std::env::temp_dir().join("umbra4-bench-no-scenes"), Vec::new());
        Options { scenes, names, require, receivers: 64, unsnapped: 8, image: 48, light: 3.0, seed: 1, gpu: None }
    }

    #[test]
    fn a_scene_made_by_code_holds() {
        let scene = tiny(32);
        let hits = hits(&scene.model, &scene.camera, ImageSize::square(IMAGE));
        let (surface, free) = random_receivers(&scene, &hits, 64, &mut Rng::new(1)).unwrap();
        let mut report = Report::default();
        report.check::<u32>("tiny", &scene, &surface, &free, &options(), true).unwrap();
        report.check::<u64>("tiny", &scene.with_samples(64).unwrap(), &surface, &free, &options(), false).unwrap();
        report.compare_rows::<u64>("tiny", &tiny(64), &hits).unwrap();
        assert!(report.holds(), "{}", report.markdown());
        assert_eq!(report.rows[0].bits, hits.len() as u64 * 64 * 64);
        assert_eq!(report.oracle[1].bits, 192 * 64 * 64);
        assert_eq!(report.unsnapped.iter().map(|line| line.moved.receivers).sum::<usize>(), 24);
    }

    #[test]
    fn a_wrong_bit_fails() {
        let line = |exact, gpu| OracleLine {
            scene: String::new(),
            triangles: 1,
            samples: 1,
            receivers: 1,
            penumbra: 1,
            bits: 1,
            blocked: 0,
            exact,
            fast: 0,
            gpu,
        };
        let holds = |line| Report { oracle: vec![line], ..Report::default() }.holds();
        assert!(holds(line(0, None)) && holds(line(0, Some(0))));
        assert!(!holds(line(1, None)) && !holds(line(0, Some(1))));
        let line = RowsLine { scene: String::new(), samples: 1, receivers: 1, bits: 1, differing: 1 };
        assert!(!Report { rows: vec![line], ..Report::default() }.holds());
        let light = tiny(2).light;
        let lattice = umbra4_core::Lattice::covering(Bounds::of(light.corners())).unwrap();
        let light = light.snap(&lattice, umbra4_core::Lift::NONE).unwrap();
        assert_eq!(differing("", "", &[3, 0], &[1_u32, 2], &light).unwrap(), 2);
    }

    #[test]
    fn missing_scenes_are_told() {
        assert!(matches!(verify(&options()), Err(VerifyError::NoScenes(_))));
        let require = vec!["sponza".to_owned()];
        assert!(matches!(verify(&Options { require, ..options() }), Err(VerifyError::Missing { .. })));
        let names = vec!["spnza".to_owned()];
        assert!(matches!(verify(&Options { names, ..options() }), Err(VerifyError::Scene(SceneError::Unknown { .. }))));
    }
}
