//! The executor on a GPU against the oracle, for every word width. `UMBRA4_GPU` says which adapter must be there:
//! `hardware`, `software`, or a part of its name; without it, the best there is, and none is a visible skip.

use std::sync::{Arc, OnceLock};

use libtest_mimic::{Arguments, Failed, Trial};
use umbra4_core::PairWord;
use umbra4_cpu::CpuWord;
use umbra4_tests::{
    gpu::{Wgpu, required},
    ledger::Ledger,
    scenes::GENERATORS,
    suite,
};
use umbra4_wgpu::{GpuError, Loading};

/// Bits compared at least: a device is slower to ask than a processor, and the software one slower still.
const BITS: u64 = 12_000_000;
/// Receivers of a block: fewer than most scenes have, so that blocks are tested as well.
const BLOCK: u32 = 200;
const WORDS: [&str; 4] = ["u16", "u32", "u64", "pair"];

type Device = Arc<OnceLock<Wgpu>>;

fn open() -> Result<Option<Wgpu>, GpuError> {
    required()?.map(|gpu| Wgpu::new(gpu, BLOCK, Loading::Checked)).transpose()
}

fn trial<W: CpuWord>(word: &'static str, device: &Device, ledger: &Arc<Ledger>, bits: u64) -> Vec<Trial> {
    let each = GENERATORS.map(|(name, _)| {
        let (device, ledger) = (device.clone(), ledger.clone());
        Trial::test(format!("{word}::{name}"), move || {
            suite::property::<W>(subject(&device)?, word, name, bits, &ledger);
            Ok(())
        })
    });
    let (device, ledger) = (device.clone(), ledger.clone());
    let hard = Trial::test(format!("{word}::hard_cases"), move || {
        suite::hard_cases::<W>(subject(&device)?, word, &ledger);
        Ok(())
    });
    each.into_iter().chain([hard]).collect()
}

fn subject(device: &Device) -> Result<&Wgpu, Failed> {
    device.get().ok_or_else(|| "there is no adapter".into())
}

fn main() {
    let arguments = Arguments::from_args();
    let device = Device::default();
    let mut missing = false;
    match open() {
        Ok(Some(wgpu)) => {
            println!("tested on: {}", suite::Subject::name(&wgpu));
            let _ = device.set(wgpu);
        }
        Ok(None) => {
            println!("SKIPPED: there is no adapter, and UMBRA4_GPU asks for none");
            missing = true;
        }
        // Every test fails.
        Err(error) => println!("{error}"),
    }
    let tests = WORDS.len() * (GENERATORS.len() + 1);
    let ledger = Arc::new(Ledger::new(tests, BITS));
    let bits = BITS.div_ceil((WORDS.len() * GENERATORS.len()) as u64);
    let mut trials = Vec::new();
    trials.extend(trial::<u16>("u16", &device, &ledger, bits));
    trials.extend(trial::<u32>("u32", &device, &ledger, bits));
    trials.extend(trial::<u64>("u64", &device, &ledger, bits));
    trials.extend(trial::<PairWord>("pair", &device, &ledger, bits));
    let trials = trials.into_iter().map(|trial| trial.with_ignored_flag(missing)).collect();
    libtest_mimic::run(&arguments, trials).exit();
}
