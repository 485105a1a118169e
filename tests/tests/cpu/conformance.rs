//! Every executor against the oracle, for every word width. `UMBRA4_BITS=1e9` compares many times as many bits.

use umbra4_tests::conformance_suite;

conformance_suite! {
    serial => umbra4_tests::suite::SerialSubject { block: 20 },
    cpu_by_default => umbra4_tests::suite::Cpu::nth_isa(2, 0),
    cpu => umbra4_tests::suite::Cpu::nth_isa(1, 0).by_triangles(),
    cpu_second_instruction_set => umbra4_tests::suite::Cpu::nth_isa(1, 1).by_triangles(),
    cpu_portable => umbra4_tests::suite::Cpu::new(1, umbra4_cpu::Isa::Portable).by_triangles(),
    cpu_silhouette => umbra4_tests::suite::Cpu::nth_isa(2, 0).by_silhouette(),
    cpu_silhouette_second_instruction_set => umbra4_tests::suite::Cpu::nth_isa(1, 1).by_silhouette(),
    cpu_silhouette_portable => umbra4_tests::suite::Cpu::new(1, umbra4_cpu::Isa::Portable).by_silhouette(),
    cpu_arranged => umbra4_tests::suite::Cpu::nth_isa(2, 0).by_triangles().arranged(),
    cpu_arranged_silhouette => umbra4_tests::suite::Cpu::nth_isa(2, 0).by_silhouette().arranged(),
    cpu_grid => umbra4_tests::suite::Cpu::grid(),
    cpu_plain_grid => umbra4_tests::suite::Cpu::plain_grid(),
}
