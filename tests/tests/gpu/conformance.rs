//! The executor on a GPU against the oracle, for every word width and both ways to load kernels.

use std::sync::{Arc, OnceLock};

use libtest_mimic::{Completion, Failed};
use umbra4_core::PairWord;
use umbra4_cpu::CpuWord;
use umbra4_tests::{
    budget,
    gpu::{Test, Wgpu},
    ledger::Ledger,
    scenes::GENERATORS,
    suite,
};
use umbra4_wgpu::{Gpu, Loading};

/// Bits compared at least: a device is slower to ask than a processor, and the software one slower still.
const BITS: u64 = 3_000_000;
/// Receivers of a block: fewer than most scenes have, so that blocks are tested as well.
const BLOCK: u32 = 200;
/// Ways to load kernels.
pub const LOADINGS: [(&str, Loading); 2] = [("checked", Loading::Checked), ("passthrough", Loading::Passthrough)];
const WORDS: usize = 4;

/// What becomes of a test where a device refuses a way to load kernels. Not every GPU loads them as they are; a software
/// driver on Vulkan does.
pub fn refused(gpu: &Gpu, loading: Loading, reason: &str) -> Result<Completion, Failed> {
    if loading == Loading::Passthrough && !gpu.software {
        return Ok(Completion::ignored_with(reason));
    }
    Err(reason.into())
}

/// What all tests of one way to load kernels share.
struct Shared {
    loading: Loading,
    subject: OnceLock<Result<Wgpu, String>>,
    ledger: Ledger,
    bits: u64,
}

impl Shared {
    fn run(&self, gpu: &Gpu, test: impl FnOnce(&Wgpu)) -> Result<Completion, Failed> {
        let open = || Wgpu::new(gpu.clone(), BLOCK, self.loading).map_err(|error| error.to_string());
        match self.subject.get_or_init(open) {
            Ok(subject) => test(subject),
            Err(reason) => return refused(gpu, self.loading, reason),
        }
        Ok(Completion::Completed)
    }
}

fn of_word<W: CpuWord>(prefix: &str, word: &'static str, shared: &Arc<Shared>) -> Vec<Test> {
    let name = |test: &str| format!("{prefix}::{word}::{test}");
    let mut tests: Vec<Test> = Vec::new();
    for (generator, _) in GENERATORS {
        let own = shared.clone();
        let test = move |gpu: &Gpu| {
            own.run(gpu, |subject| suite::property::<W>(subject, word, generator, own.bits, &own.ledger))
        };
        tests.push((name(generator), Box::new(test)));
    }
    // Kernels have words of 32 bits and pairs of them; the other two are what the host makes of these.
    let every = if matches!(word, "u32" | "pair") { 1 } else { 8 };
    let own = shared.clone();
    let test = move |gpu: &Gpu| own.run(gpu, |subject| suite::hard_cases::<W>(subject, word, every, &own.ledger));
    tests.push((name("hard_cases"), Box::new(test)));
    tests
}

pub fn tests() -> Vec<Test> {
    let bits = budget::of(BITS);
    let of_loading = |(prefix, loading)| {
        let shared = Arc::new(Shared {
            loading,
            subject: OnceLock::new(),
            ledger: Ledger::new(WORDS * (GENERATORS.len() + 1), bits),
            bits: bits.div_ceil((WORDS * GENERATORS.len()) as u64),
        });
        [
            of_word::<u16>(prefix, "u16", &shared),
            of_word::<u32>(prefix, "u32", &shared),
            of_word::<u64>(prefix, "u64", &shared),
            of_word::<PairWord>(prefix, "pair", &shared),
        ]
    };
    LOADINGS.into_iter().flat_map(of_loading).flatten().collect()
}
