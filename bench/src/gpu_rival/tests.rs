//! The rival's bits against the executor on the processor, which is exact, on the adapter that `UMBRA4_GPU` says.

use umbra4_core::glam::DVec3;
use umbra4_cpu::{CpuExecutor, Occluders};
use umbra4_tests::{gpu::required, rng::Rng};

use super::*;
use crate::{
    gpu_table::Differing,
    image_size::ImageSize,
    primary::hits,
    scene::{Scene, tiny},
};

/// Share of bits that may differ. Rays are rounded to f32, some 1e-7 of the scene's size, and a bit differs where its ray
/// passes an outline as closely: with outlines of some ten scene sizes in all, one bit in a million or so. This is ten
/// times as many, and [`FEW`] where there are few bits.
const GRAZING_SHARE: f64 = 1e-5;
/// Bits that may differ whatever their number.
const FEW: u64 = 2;
/// Triangles beside those of the tiny scene.
const LEAVES: u32 = 300;
/// Edge of the image in pixels.
const EDGE: u32 = 64;

/// The device, which has to be there.
#[expect(clippy::panic, reason = "the device is missing")]
fn gpu() -> Gpu {
    required().unwrap_or_else(|missing| panic!("{missing}"))
}

/// The tiny scene under many small leaves, so that the hierarchy has several levels.
fn wood(samples: u32) -> Scene {
    let mut scene = tiny(samples);
    let mut rng = Rng::new(1);
    for _ in 0..LEAVES {
        let corner = DVec3::new(rng.real(2.0), 1.0 + rng.real(0.9), rng.real(2.0));
        let mut beside = || corner + DVec3::new(rng.real(0.1), rng.real(0.1), rng.real(0.1));
        let corners = [corner, beside(), beside()].map(|v| v.as_vec3());
        let first = scene.model.vertices.len() as u32;
        scene.model.vertices.extend(corners);
        scene.model.triangles.push([first, first + 1, first + 2]);
    }
    assert!(Bvh4::new(&scene.model).depth >= 4);
    scene
}

fn agrees(gpu: &Gpu, samples: u32, loading: Loading) {
    let scene = wood(samples);
    let hits = hits(&scene.model, &scene.camera, ImageSize { width: EDGE, height: EDGE / 2 });
    let problem = Problem::new(&scene, &hits, &hits).unwrap();
    let occluders = Occluders::new(&problem.lattice, &scene.model.vertices, &scene.model.triangles).unwrap();
    let (masks, _) = CpuExecutor::new().masks::<u64>(&occluders, &problem.light, &problem.receivers).unwrap();
    let words = samples.div_ceil(u32::BITS) as usize;
    let exact: Vec<u32> =
        masks.words().iter().flat_map(|&row| [row as u32, (row >> 32) as u32].into_iter().take(words)).collect();
    let blocked: u64 = exact.iter().map(|word| u64::from(word.count_ones())).sum();
    let bits = hits.len() as u64 * u64::from(samples * samples);
    assert!(blocked > bits / 50 && blocked < bits / 2, "{blocked} of {bits} bits are blocked");

    let rival = GpuRival::new(gpu, &scene.model, loading).unwrap();
    let masks = rival.trace(Answer::Masks, &problem).unwrap().words;
    let Differing { differing, .. } = Differing::of_masks(&exact, &masks, bits);
    println!("{samples}², {loading:?}: {differing} of {bits} bits differ");
    let most = FEW + (GRAZING_SHARE * bits as f64) as u64;
    assert!(differing <= most, "{samples}²: {differing} of {bits} bits differ");

    let lit = rival.trace(Answer::Lit, &problem).unwrap().words;
    let of_masks = masks.chunks_exact(words * samples as usize);
    let of_masks = of_masks.map(|mask| samples * samples - mask.iter().map(|word| word.count_ones()).sum::<u32>());
    assert!(of_masks.eq(lit), "{samples}²: lit counts are not those of the masks");
}

#[test]
#[ignore = "needs an adapter: UMBRA4_GPU=software cargo test -p umbra4-bench -- --ignored"]
fn masks_and_lit_counts_agree() {
    let gpu = gpu();
    for samples in [1, 5, 8, 32, 37, 64] {
        agrees(&gpu, samples, Loading::Checked);
    }
    agrees(&gpu, 32, Loading::Passthrough);
}

#[test]
#[ignore = "needs an adapter: UMBRA4_GPU=software cargo test -p umbra4-bench -- --ignored"]
fn nothing_blocks_nothing() {
    let gpu = gpu();
    let mut scene = tiny(8);
    let hits = hits(&scene.model, &scene.camera, ImageSize::square(8));
    scene.model.triangles.clear();
    let problem = Problem::new(&scene, &hits, &hits).unwrap();
    let rival = GpuRival::new(&gpu, &scene.model, Loading::Checked).unwrap();
    let lit = rival.trace(Answer::Lit, &problem).unwrap().words;
    assert!(!lit.is_empty() && lit.iter().all(|&lit| lit == 64), "{lit:?}");
    let nobody = Problem::new(&scene, &hits, &[]).unwrap();
    assert!(rival.trace(Answer::Lit, &nobody).unwrap().words.is_empty());
}
