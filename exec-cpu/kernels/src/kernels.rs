//! What is compiled: which words, samples and precisions.

use umbra4_core::{
    Exact, Fast, MaskWord, Precision,
    cloud_pair::SampleTest,
    cloud_table::PlaneTable,
    cloud_tiles::CloudTiles,
    jitter::{Pattern, Regular},
    stage::{
        add_tint::TintScene,
        resolve::{Group, Occlusion},
        resolve_cells::CellScene,
        resolve_cloud::{CloudGroup, CloudScene},
        resolve_cutout::CutoutScene,
        resolve_punctual::{PunctualGroup, PunctualScene},
        resolve_silhouette::{SilhouetteRoom, SilhouetteScene},
    },
    tint::Depth,
};

use crate::{Detected, compiled};

/// The kernels of a word, for samples that lie as `S` says.
pub trait Kernels<S>: MaskWord {
    /// Fills the masks of a group.
    fn resolve(isa: Detected, precision: Precision, scene: &Occlusion<'_>, samples: &S, group: &mut Group<Self>);
    /// The same, by the silhouette.
    fn resolve_silhouette(
        isa: Detected,
        precision: Precision,
        scene: &SilhouetteScene<'_>,
        samples: &S,
        group: &mut Group<Self>,
        room: &mut SilhouetteRoom<Self>,
    );
    /// The same, with the triangles `list` of its cell. The grid takes regular samples only, and is given no others.
    fn resolve_cell(_: Detected, _: Precision, _: &CellScene<'_>, _: &[u32], _: &mut Group<Self>) {}
}

macro_rules! kernels {
    ($($word:ty, $samples:ty, $fast:ty $(, with $cells:ident)?;)*) => {
        $(
            impl Kernels<$samples> for $word {
                fn resolve(
                    isa: Detected,
                    precision: Precision,
                    scene: &Occlusion<'_>,
                    samples: &$samples,
                    group: &mut Group<Self>,
                ) {
                    match precision {
                        Precision::Exact => compiled::resolve::run::<Self, Exact, _>(isa, scene, samples, group),
                        Precision::Fast => compiled::resolve::run::<Self, $fast, _>(isa, scene, samples, group),
                    }
                }

                fn resolve_silhouette(
                    isa: Detected,
                    precision: Precision,
                    scene: &SilhouetteScene<'_>,
                    samples: &$samples,
                    group: &mut Group<Self>,
                    room: &mut SilhouetteRoom<Self>,
                ) {
                    match precision {
                        Precision::Exact => compiled::resolve_silhouette::run::<Self, Exact, _>(isa, scene, samples, group, room),
                        Precision::Fast => compiled::resolve_silhouette::run::<Self, $fast, _>(isa, scene, samples, group, room),
                    }
                }

                $(kernels!(@ $cells);)?
            }
        )*
    };
    (@ cells) => {
        fn resolve_cell(isa: Detected, precision: Precision, scene: &CellScene<'_>, list: &[u32], group: &mut Group<Self>) {
            match precision {
                Precision::Exact => compiled::resolve_cells::run::<Self, Exact>(isa, scene, list, group),
                Precision::Fast => compiled::resolve_cells::run::<Self, Fast>(isa, scene, list, group),
            }
        }
    };
}

// Jittered samples are certified either way: what that saves is not worth twice the kernels.
kernels! {
    u32, Regular, Fast, with cells;
    u64, Regular, Fast, with cells;
    u32, Pattern, Exact;
    u64, Pattern, Exact;
}

/// The kernels of special casters, which are certified always.
pub trait CasterKernels<S>: Kernels<S> {
    /// Adds what an alpha-tested caster blocks, or one whose planes are offset, to the masks of a group.
    fn resolve_cutout(
        isa: Detected,
        scene: &CutoutScene<'_>,
        samples: &S,
        group: &mut Group<Self>,
        room: &mut Group<Self>,
    );
    /// Adds what the panes of a tinted caster take to the depths of a group; see [`umbra4_core::stage::add_tint`].
    fn add_tint(
        isa: Detected,
        scene: &TintScene<'_>,
        samples: &S,
        group: &mut Group<Self>,
        room: &mut Group<Self>,
        depths: &mut [Depth],
        tinted: &mut u32,
    );
}

macro_rules! caster_kernels {
    ($($word:ty, $samples:ty;)*) => {
        $(
            impl CasterKernels<$samples> for $word {
                fn resolve_cutout(
                    isa: Detected,
                    scene: &CutoutScene<'_>,
                    samples: &$samples,
                    group: &mut Group<Self>,
                    room: &mut Group<Self>,
                ) {
                    compiled::resolve_cutout::run::<Self, _>(isa, scene, samples, group, room);
                }

                fn add_tint(
                    isa: Detected,
                    scene: &TintScene<'_>,
                    samples: &$samples,
                    group: &mut Group<Self>,
                    room: &mut Group<Self>,
                    depths: &mut [Depth],
                    tinted: &mut u32,
                ) {
                    compiled::add_tint::run::<Self, _>(isa, scene, samples, group, room, depths, tinted);
                }
            }
        )*
    };
}

// Words of 64 bits alone: what is done to single samples costs more than wide rows.
caster_kernels! {
    u64, Regular;
    u64, Pattern;
}

/// Finds the receivers of a group that a light without extent does not reach.
pub fn resolve_punctual(isa: Detected, precision: Precision, scene: &PunctualScene<'_>, group: &mut PunctualGroup) {
    match precision {
        Precision::Exact => compiled::resolve_punctual::run::<Exact>(isa, scene, group),
        Precision::Fast => compiled::resolve_punctual::run::<Fast>(isa, scene, group),
    }
}

/// What tells the samples of a cloud that are blocked from others: with kernels of its own.
pub trait CloudKernels: SampleTest {
    /// Fills the masks of a group before a cloud.
    fn resolve(isa: Detected, precision: Precision, scene: &CloudScene<'_, Self>, group: &mut CloudGroup)
    where
        Self: Sized;
}

macro_rules! cloud_kernels {
    ($($test:ty, $fast:ty;)*) => {
        $(
            impl CloudKernels for $test {
                fn resolve(
                    isa: Detected,
                    precision: Precision,
                    scene: &CloudScene<'_, Self>,
                    group: &mut CloudGroup,
                ) {
                    match precision {
                        Precision::Exact => compiled::resolve_cloud::run::<Exact, Self>(isa, scene, group),
                        Precision::Fast => compiled::resolve_cloud::run::<$fast, Self>(isa, scene, group),
                    }
                }
            }
        )*
    };
}

// What is looked up in a table is certified either way: floats before a lookup have to be right.
cloud_kernels! {
    CloudTiles<'_>, Fast;
    PlaneTable<'_>, Exact;
}
