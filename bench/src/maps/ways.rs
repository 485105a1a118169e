//! The shadow maps that are measured.

use umbra4_cpu::maps::{
    Technique,
    microquad::{Footprint, HalfSpaces, MapOptions, MicroOccluders, MicroquadOptions},
    stochastic::{Basis, Placement, StochasticOptions},
};

/// A technique by a name.
#[derive(Clone, Debug)]
pub(super) struct Way {
    pub(super) name: &'static str,
    pub(super) technique: Technique,
}

/// The older approximation, with which the paper compares hulls: errors of microquads are relative to its.
pub(super) const OLDER: &str = "quads, rectangles";

/// All ways, by maps of `size` × `size` texels where nothing else is said. Exact masks come first.
pub(super) fn ways(size: u32) -> Vec<Way> {
    let mut ways = vec![Way { name: "exact masks", technique: Technique::Exact }];
    let map = MapOptions { size, ..MapOptions::default() };
    for (name, occluders, footprint) in [
        ("patches, rectangles", MicroOccluders::Micropatches, Footprint::Rectangles),
        (OLDER, MicroOccluders::Microquads, Footprint::Rectangles),
        ("quads, areas", MicroOccluders::Microquads, Footprint::Area),
        ("quads, rows", MicroOccluders::Microquads, Footprint::Rows),
        ("quads, table", MicroOccluders::Microquads, Footprint::Table(HalfSpaces::default())),
        ("quads and triangles, rows", MicroOccluders::Microtris, Footprint::Rows),
        ("quads and triangles, table", MicroOccluders::Microtris, Footprint::Table(HalfSpaces::default())),
    ] {
        ways.push(Way { name, technique: Technique::Microquads(MicroquadOptions { map, occluders, footprint }) });
    }
    let plain = StochasticOptions { size, ..StochasticOptions::default() };
    let exponential = |exponent| Basis::Exponential { exponent };
    for (name, options) in [
        ("stochastic, 4 planes", plain),
        ("half the texels each way", StochasticOptions { size: (size / 2).max(1), ..plain }),
        ("twice the texels each way", StochasticOptions { size: size * 2, ..plain }),
        ("1 plane", StochasticOptions { planes: 1, ..plain }),
        ("16 planes", StochasticOptions { planes: 16, ..plain }),
        ("planes at even steps of depth", StochasticOptions { placement: Placement::Depth, ..plain }),
        ("variance alone", StochasticOptions { basis: Basis::Variance, ..plain }),
        ("exponent 5", StochasticOptions { basis: exponential(5.0), ..plain }),
        ("exponent 35", StochasticOptions { basis: exponential(35.0), ..plain }),
        ("the paper's choices", StochasticOptions { size, ..StochasticOptions::paper() }),
    ] {
        ways.push(Way { name, technique: Technique::Stochastic(options) });
    }
    ways
}
