//! Each stage in a module of its own for each instruction set, which compilers take side by side.

use umbra4_core::{
    MaskWord, PrecisionMode,
    cloud_pair::SampleTest,
    lanes::Four,
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

use crate::{Detected, Isa, lanes::Portable};

/// A stage for each instruction set, and the choice between them.
macro_rules! stage {
    ($stage:ident::$function:ident<$($generic:ident: $bound:ident),*>($($argument:ident: $type:ty),*), portable: $portable:ty) => {
        pub(crate) mod $stage {
            use super::*;
            use umbra4_core::stage::$stage as stage;

            #[inline]
            pub(crate) fn run<$($generic: $bound),*>(isa: Detected, $($argument: $type),*) {
                match isa.isa() {
                    #[cfg(target_arch = "x86_64")]
                    // SAFETY: `Detected` holds an instruction set that the processor has.
                    Isa::Avx512 => unsafe { avx512::run::<$($generic),*>($($argument),*) },
                    #[cfg(target_arch = "x86_64")]
                    // SAFETY: as above.
                    Isa::Avx2 => unsafe { avx2::run::<$($generic),*>($($argument),*) },
                    #[cfg(target_arch = "aarch64")]
                    Isa::Neon => neon::run::<$($generic),*>($($argument),*),
                    Isa::Portable => portable::run::<$($generic),*>($($argument),*),
                }
            }

            #[cfg(target_arch = "x86_64")]
            mod avx512 {
                use super::*;

                #[target_feature(enable = "avx512f,avx512bw,avx512dq,avx512vl,avx2,fma,bmi1,bmi2,lzcnt,popcnt")]
                pub(super) fn run<$($generic: $bound),*>($($argument: $type),*) {
                    stage::$function::<crate::lanes::avx512::Avx512, $($generic),*>($($argument),*);
                }
            }

            #[cfg(target_arch = "x86_64")]
            mod avx2 {
                use super::*;

                #[target_feature(enable = "avx2,fma,bmi1,bmi2,lzcnt,popcnt")]
                pub(super) fn run<$($generic: $bound),*>($($argument: $type),*) {
                    stage::$function::<crate::lanes::avx2::Avx2, $($generic),*>($($argument),*);
                }
            }

            #[cfg(target_arch = "aarch64")]
            mod neon {
                use super::*;

                pub(super) fn run<$($generic: $bound),*>($($argument: $type),*) {
                    stage::$function::<crate::lanes::neon::Neon, $($generic),*>($($argument),*);
                }
            }

            mod portable {
                use super::*;

                pub(super) fn run<$($generic: $bound),*>($($argument: $type),*) {
                    stage::$function::<$portable, $($generic),*>($($argument),*);
                }
            }
        }
    };
}

stage! {
    resolve::resolve<W: MaskWord, P: PrecisionMode, S: Portable>(
        scene: &Occlusion<'_>, samples: &S, group: &mut Group<W>
    ), portable: S::Lanes
}
stage! {
    resolve_silhouette::resolve_silhouette<W: MaskWord, P: PrecisionMode, S: Portable>(
        scene: &SilhouetteScene<'_>, samples: &S, group: &mut Group<W>, room: &mut SilhouetteRoom<W>
    ), portable: S::Lanes
}
stage! {
    resolve_cells::resolve_cell<W: MaskWord, P: PrecisionMode>(
        scene: &CellScene<'_>, list: &[u32], group: &mut Group<W>
    ), portable: Four
}
stage! {
    resolve_punctual::resolve_punctual<P: PrecisionMode>(
        scene: &PunctualScene<'_>, group: &mut PunctualGroup
    ), portable: Four
}
stage! {
    resolve_cloud::resolve_cloud<P: PrecisionMode, T: SampleTest>(
        scene: &CloudScene<'_, T>, group: &mut CloudGroup
    ), portable: Four
}
stage! {
    resolve_cutout::resolve_cutout<W: MaskWord, S: Portable>(
        scene: &CutoutScene<'_>, samples: &S, group: &mut Group<W>, room: &mut Group<W>
    ), portable: S::Lanes
}
stage! {
    add_tint::add_tint<W: MaskWord, S: Portable>(
        scene: &TintScene<'_>,
        samples: &S,
        group: &mut Group<W>,
        room: &mut Group<W>,
        depths: &mut [Depth],
        tinted: &mut u32
    ), portable: S::Lanes
}
