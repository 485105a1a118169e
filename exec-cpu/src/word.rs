//! The mask words that kernels are compiled for: here and once, not again in every crate that asks for masks.

use umbra4_core::{
    Exact, Fast, MaskWord, PairWord, Precision,
    jitter::{Pattern, Regular},
    stage::{
        resolve::{Group, Occlusion},
        resolve_cells::CellScene,
        resolve_silhouette::{SilhouetteRoom, SilhouetteScene},
    },
};

use crate::Isa;

/// A mask word of this executor: `u16`, `u32`, `u64`, and the pair of `u32` that GPUs use.
pub trait CpuWord: MaskWord + Kernels {}

impl<W: MaskWord + Kernels> CpuWord for W {}

/// The kernels of a word.
pub trait Kernels: Sized {
    /// Fills the masks of a group. `isa` comes from [`Isa::available`].
    #[doc(hidden)]
    fn resolve(isa: Isa, precision: Precision, scene: &Occlusion<'_>, group: &mut Group<Self>);
    /// The same, of jittered samples.
    #[doc(hidden)]
    fn resolve_jittered(
        isa: Isa,
        precision: Precision,
        scene: &Occlusion<'_>,
        pattern: &Pattern,
        group: &mut Group<Self>,
    );
    /// The same, by the silhouette.
    #[doc(hidden)]
    fn resolve_silhouette(
        isa: Isa,
        precision: Precision,
        scene: &SilhouetteScene<'_>,
        group: &mut Group<Self>,
        room: &mut SilhouetteRoom<Self>,
    );
    /// The same, with the triangles `list` of its cell.
    #[doc(hidden)]
    fn resolve_cell(isa: Isa, precision: Precision, scene: &CellScene<'_>, list: &[u32], group: &mut Group<Self>);
}

macro_rules! kernels {
    ($($word:ty),*) => {
        $(
            impl Kernels for $word {
                fn resolve(isa: Isa, precision: Precision, scene: &Occlusion<'_>, group: &mut Group<Self>) {
                    match precision {
                        Precision::Exact => isa.resolve::<Self, Exact, _>(scene, &Regular, group),
                        Precision::Fast => isa.resolve::<Self, Fast, _>(scene, &Regular, group),
                    }
                }

                fn resolve_jittered(
                    isa: Isa,
                    precision: Precision,
                    scene: &Occlusion<'_>,
                    pattern: &Pattern,
                    group: &mut Group<Self>,
                ) {
                    match precision {
                        Precision::Exact => isa.resolve::<Self, Exact, _>(scene, pattern, group),
                        Precision::Fast => isa.resolve::<Self, Fast, _>(scene, pattern, group),
                    }
                }

                fn resolve_silhouette(
                    isa: Isa,
                    precision: Precision,
                    scene: &SilhouetteScene<'_>,
                    group: &mut Group<Self>,
                    room: &mut SilhouetteRoom<Self>,
                ) {
                    match precision {
                        Precision::Exact => isa.resolve_silhouette::<Self, Exact>(scene, group, room),
                        Precision::Fast => isa.resolve_silhouette::<Self, Fast>(scene, group, room),
                    }
                }

                fn resolve_cell(
                    isa: Isa,
                    precision: Precision,
                    scene: &CellScene<'_>,
                    list: &[u32],
                    group: &mut Group<Self>,
                ) {
                    match precision {
                        Precision::Exact => isa.resolve_cell::<Self, Exact>(scene, list, group),
                        Precision::Fast => isa.resolve_cell::<Self, Fast>(scene, list, group),
                    }
                }
            }
        )*
    };
}

kernels!(u16, u32, u64, PairWord);
