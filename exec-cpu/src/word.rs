//! The mask words that kernels are compiled for: here and once, not again in every crate that asks for masks. Kernels take
//! long to compile, so that words share some: what is computed in a wider word is narrowed.

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
pub trait CpuWord: MaskWord {
    /// The word that masks of regular samples are computed in.
    #[doc(hidden)]
    type Regular: Kernels<Regular>;
    /// The word that masks of jittered samples are computed in.
    #[doc(hidden)]
    type Jittered: Kernels<Pattern>;
    /// Rows as they are handed out; `room` is as long.
    #[doc(hidden)]
    fn of_regular<'a>(rows: &'a [Self::Regular], room: &'a mut [Self]) -> &'a [Self];
    /// Rows as they are handed out; `room` is as long.
    #[doc(hidden)]
    fn of_jittered<'a>(rows: &'a [Self::Jittered], room: &'a mut [Self]) -> &'a [Self];
}

/// The kernels of a word, for samples that lie as `S` says. `isa` comes from [`Isa::available`].
pub trait Kernels<S>: MaskWord {
    /// Fills the masks of a group.
    #[doc(hidden)]
    fn resolve(isa: Isa, precision: Precision, scene: &Occlusion<'_>, samples: &S, group: &mut Group<Self>);
    /// The same, by the silhouette.
    #[doc(hidden)]
    fn resolve_silhouette(
        isa: Isa,
        precision: Precision,
        scene: &SilhouetteScene<'_>,
        samples: &S,
        group: &mut Group<Self>,
        room: &mut SilhouetteRoom<Self>,
    );
    /// The same, with the triangles `list` of its cell. The grid takes regular samples only, and is given no others.
    #[doc(hidden)]
    fn resolve_cell(_: Isa, _: Precision, _: &CellScene<'_>, _: &[u32], _: &mut Group<Self>) {}
}

macro_rules! kernels {
    ($($word:ty, $samples:ty, $fast:ty $(, with $cells:ident)?;)*) => {
        $(
            impl Kernels<$samples> for $word {
                fn resolve(
                    isa: Isa,
                    precision: Precision,
                    scene: &Occlusion<'_>,
                    samples: &$samples,
                    group: &mut Group<Self>,
                ) {
                    match precision {
                        Precision::Exact => isa.resolve::<Self, Exact, _>(scene, samples, group),
                        Precision::Fast => isa.resolve::<Self, $fast, _>(scene, samples, group),
                    }
                }

                fn resolve_silhouette(
                    isa: Isa,
                    precision: Precision,
                    scene: &SilhouetteScene<'_>,
                    samples: &$samples,
                    group: &mut Group<Self>,
                    room: &mut SilhouetteRoom<Self>,
                ) {
                    match precision {
                        Precision::Exact => isa.resolve_silhouette::<Self, Exact, _>(scene, samples, group, room),
                        Precision::Fast => isa.resolve_silhouette::<Self, $fast, _>(scene, samples, group, room),
                    }
                }

                $(kernels!(@ $cells);)?
            }
        )*
    };
    (@ cells) => {
        fn resolve_cell(isa: Isa, precision: Precision, scene: &CellScene<'_>, list: &[u32], group: &mut Group<Self>) {
            match precision {
                Precision::Exact => isa.resolve_cell::<Self, Exact>(scene, list, group),
                Precision::Fast => isa.resolve_cell::<Self, Fast>(scene, list, group),
            }
        }
    };
}

// Jittered samples are certified either way: what that saves is not worth twice the kernels.
kernels! {
    u16, Regular, Fast, with cells;
    u32, Regular, Fast, with cells;
    u64, Regular, Fast, with cells;
    u32, Pattern, Exact;
    u64, Pattern, Exact;
}

/// Rows in words of another type.
fn converted<'a, K: Copy, W>(rows: &[K], room: &'a mut [W], convert: impl Fn(K) -> W) -> &'a [W] {
    for (word, row) in room.iter_mut().zip(rows) {
        *word = convert(*row);
    }
    &room[..rows.len().min(room.len())]
}

fn pair(word: u64) -> PairWord {
    PairWord { low: word as u32, high: (word >> 32) as u32 }
}

impl CpuWord for u16 {
    type Regular = Self;
    type Jittered = u32;

    fn of_regular<'a>(rows: &'a [Self], _: &'a mut [Self]) -> &'a [Self] {
        rows
    }

    // A row has no bits beyond the light's columns.
    fn of_jittered<'a>(rows: &'a [u32], room: &'a mut [Self]) -> &'a [Self] {
        converted(rows, room, |row| row as Self)
    }
}

macro_rules! own_kernels {
    ($($word:ty),*) => {
        $(
            impl CpuWord for $word {
                type Regular = Self;
                type Jittered = Self;

                fn of_regular<'a>(rows: &'a [Self], _: &'a mut [Self]) -> &'a [Self] {
                    rows
                }

                fn of_jittered<'a>(rows: &'a [Self], _: &'a mut [Self]) -> &'a [Self] {
                    rows
                }
            }
        )*
    };
}

own_kernels!(u32, u64);

impl CpuWord for PairWord {
    type Regular = u64;
    type Jittered = u64;

    fn of_regular<'a>(rows: &'a [u64], room: &'a mut [Self]) -> &'a [Self] {
        converted(rows, room, pair)
    }

    fn of_jittered<'a>(rows: &'a [u64], room: &'a mut [Self]) -> &'a [Self] {
        converted(rows, room, pair)
    }
}
