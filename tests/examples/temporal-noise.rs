//! A table of temporal noise under a moving light: difference images of successive frames of a stochastic soft shadow map against those of exact
//! visibility, with the same seed in all frames, and with a new one in each.
//!
//! `cargo run --release -p umbra4-tests --example temporal-noise [FRAMES [FOLDER]]`: with a folder, the difference images of the first two frames
//! are written there.

use std::{env, error::Error, fs, path::PathBuf};

use umbra4_cpu::CpuExecutor;
use umbra4_maps::stochastic::{Basis, StochasticOptions};
use umbra4_tests::{
    flicker::{difference_image, flicker, moved},
    grids::two_grids,
    scene::WorldScene,
    slab::slab_and_wall,
};

/// Receivers each way.
const ACROSS: usize = 64;
/// Difference images show differences so many times as large.
const GAIN: f32 = 8.0;

fn main() -> Result<(), Box<dyn Error>> {
    let frames: u32 = env::args().nth(1).map_or(Ok(8), |frames| frames.parse())?;
    let folder = env::args().nth(2).map(PathBuf::from);
    let scenes: [(&str, WorldScene); 2] =
        [("two grids", two_grids(0.3, ACROSS as u32, 16)), ("slab and wall", slab_and_wall(ACROSS as u32))];
    let bases = [("variance", Basis::Variance), ("exponential 20", Basis::Exponential { exponent: 20.0 })];
    println!("Change of visibility between {frames} successive frames, thousandths:");
    println!();
    println!("| scene | texels | basis | seed | exact | map | difference, mean | root mean square | largest |");
    println!("|---|--:|---|---|--:|--:|--:|--:|--:|");
    for (name, scene) in &scenes {
        let moved = (0..frames).map(|frame| moved(scene, frame).inputs());
        let exact = moved.map(|inputs| {
            let (visibility, _) = CpuExecutor::new().visibility(&inputs.occluders, &inputs.light, &inputs.receivers)?;
            Ok((inputs, visibility))
        });
        let exact = exact.collect::<Result<Vec<_>, Box<dyn Error>>>()?;
        for size in [128, 256, 512] {
            for (basis_name, basis) in bases {
                for new_seeds in [false, true] {
                    let mut pairs = Vec::new();
                    for (frame, (inputs, visibility)) in (0..).zip(&exact) {
                        let seed = if new_seeds { frame } else { 0 };
                        let options = StochasticOptions { size, basis, seed, ..StochasticOptions::default() };
                        let done = CpuExecutor::new().stochastic_shadows(
                            &inputs.occluders,
                            &inputs.light,
                            &inputs.receivers,
                            &options,
                        )?;
                        pairs.push((done.visibility, visibility.clone()));
                    }
                    let found = flicker(&pairs);
                    let seed = if new_seeds { "new" } else { "same" };
                    if let (Some(folder), [(map, exact), (next_map, next_exact), ..]) = (&folder, &pairs[..]) {
                        let name = format!("{name}-{size}-{basis_name}-{seed}").replace(' ', "-");
                        fs::create_dir_all(folder)?;
                        fs::write(
                            folder.join(format!("{name}-map.pgm")),
                            difference_image(map, next_map, ACROSS, GAIN),
                        )?;
                        fs::write(
                            folder.join(format!("{name}-exact.pgm")),
                            difference_image(exact, next_exact, ACROSS, GAIN),
                        )?;
                    }
                    let numbers =
                        [found.exact, found.filtered, found.noise, found.root_mean_square, found.most].map(|x| x * 1e3);
                    let [a, b, c, d, e] = numbers;
                    println!(
                        "| {name} | {size}² | {basis_name} | {seed} | {a:.2} | {b:.2} | {c:.2} | {d:.2} | {e:.0} |"
                    );
                }
            }
        }
    }
    Ok(())
}
