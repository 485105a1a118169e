//! The executor on a GPU against the oracle, for every word width and both ways to load kernels. `UMBRA4_GPU` says which
//! adapter must be there, see [`umbra4_tests::gpu::required`].

use std::sync::Arc;

use libtest_mimic::{Arguments, Failed, Trial};
use umbra4_core::PairWord;
use umbra4_cpu::CpuWord;
use umbra4_tests::{
    gpu::{Wgpu, announced},
    ledger::Ledger,
    scenes::GENERATORS,
    suite,
};
use umbra4_wgpu::Loading;

/// Bits compared at least: a device is slower to ask than a processor, and the software one slower still.
const BITS: u64 = 12_000_000;
/// Receivers of a block: fewer than most scenes have, so that blocks are tested as well.
const BLOCK: u32 = 200;
const LOADINGS: [(&str, Loading); 2] = [("checked", Loading::Checked), ("passthrough", Loading::Passthrough)];
const WORDS: usize = 4;

/// An executor, or why there is none.
type Subject = Arc<Result<Wgpu, String>>;

/// What all tests of one way to load kernels share.
#[derive(Clone)]
struct Shared {
    prefix: &'static str,
    subject: Subject,
    ledger: Arc<Ledger>,
    bits: u64,
}

impl Shared {
    fn trials<W: CpuWord>(&self, word: &'static str) -> Vec<Trial> {
        let name = |test: &str| format!("{}::{word}::{test}", self.prefix);
        let mut trials = Vec::new();
        for (test, _) in GENERATORS {
            let shared = self.clone();
            trials.push(Trial::test(name(test), move || {
                suite::property::<W>(shared.there()?, word, test, shared.bits, &shared.ledger);
                Ok(())
            }));
        }
        let shared = self.clone();
        trials.push(Trial::test(name("hard_cases"), move || {
            suite::hard_cases::<W>(shared.there()?, word, &shared.ledger);
            Ok(())
        }));
        trials
    }

    fn there(&self) -> Result<&Wgpu, Failed> {
        self.subject.as_ref().as_ref().map_err(|reason| Failed::from(reason.as_str()))
    }
}

fn main() {
    let arguments = Arguments::from_args();
    let (gpu, missing) = announced();
    let mut trials = Vec::new();
    for (prefix, loading) in LOADINGS {
        let subject = gpu.clone().and_then(|gpu| Wgpu::new(gpu, BLOCK, loading).map_err(|error| error.to_string()));
        // Not every device loads kernels as they are; a software driver on Vulkan does.
        let unable = loading == Loading::Passthrough && subject.is_err() && gpu.as_ref().is_ok_and(|gpu| !gpu.software);
        if let (true, Err(reason)) = (unable, &subject) {
            println!("SKIPPED: {prefix}: {reason}");
        }
        let tests = WORDS * (GENERATORS.len() + 1);
        let shared = Shared {
            prefix,
            subject: Arc::new(subject),
            ledger: Arc::new(Ledger::new(tests, BITS)),
            bits: BITS.div_ceil((WORDS * GENERATORS.len()) as u64),
        };
        let own = [
            shared.trials::<u16>("u16"),
            shared.trials::<u32>("u32"),
            shared.trials::<u64>("u64"),
            shared.trials::<PairWord>("pair"),
        ];
        trials.extend(own.into_iter().flatten().map(|trial| trial.with_ignored_flag(missing || unable)));
    }
    libtest_mimic::run(&arguments, trials).exit();
}
