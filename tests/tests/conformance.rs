//! Every executor against the oracle, for every word width. `UMBRA4_BITS=1e9` compares ten times as many bits.

use umbra4_tests::conformance_suite;

conformance_suite! {
    serial => umbra4_tests::suite::SerialSubject { block: 20 },
    cpu_one_thread => umbra4_tests::suite::Cpu::nth_isa(1, 0),
    cpu_two_threads => umbra4_tests::suite::Cpu::nth_isa(2, 0),
    cpu_second_instruction_set => umbra4_tests::suite::Cpu::nth_isa(1, 1),
    cpu_portable => umbra4_tests::suite::Cpu::new(1, umbra4_cpu::Isa::Portable),
    cpu_grid => umbra4_tests::suite::Cpu::grid(),
    cpu_plain_grid => umbra4_tests::suite::Cpu::plain_grid(),
}
