//! Every executor against the oracle, for every word width. `UMBRA4_BITS=1e9` compares ten times as many bits.

use umbra4_tests::conformance_suite;

conformance_suite! {
    cpu_one_thread => umbra4_tests::suite::Cpu::new(1, umbra4_cpu::Index::default()),
    cpu_two_threads => umbra4_tests::suite::Cpu::new(2, umbra4_cpu::Index::default()),
}
