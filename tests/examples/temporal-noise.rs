//! A table of temporal noise under a moving light: difference images of successive frames of a stochastic soft shadow map against those of exact
//! visibility, with the same seed in all frames, and with a new one in each.
//!
//! `cargo run --release -p umbra4-tests --example temporal-noise [FRAMES]`

use std::{env, error::Error};

use umbra4_cpu::CpuExecutor;
use umbra4_maps::stochastic::{Basis, StochasticOptions};
use umbra4_tests::{
    flicker::{flicker, moved},
    grids::two_grids,
    scene::WorldScene,
    slab::slab_and_wall,
};

fn main() -> Result<(), Box<dyn Error>> {
    let frames: u32 = env::args().nth(1).map_or(Ok(8), |frames| frames.parse())?;
    let scenes: [(&str, WorldScene); 2] = [("two grids", two_grids(0.3, 64, 16)), ("slab and wall", slab_and_wall(64))];
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
