//! The contenders: what they have in common, and how they are named.

use thiserror::Error;
use umbra4_core::{Counts, VolumeLightError, cloud_table::TableError, emission::EmissionError};
use umbra4_cpu::{CasterError, ExecutorError, Index, Precision, SceneError};

use crate::{
    bvh_rival::BvhRival,
    problem::Problem,
    row_word::RowWord,
    umbra::{PointLamp, Umbra},
};

/// One run: its seconds, and what was counted.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Run {
    /// Seconds of making the occluders ready: a hierarchy, or the snap to the lattice; for those that follow a mesh that moves,
    /// of following it once.
    pub build: f64,
    /// Seconds of all masks.
    pub masks: f64,
    /// Pairs of receivers and triangles; ray tracers have none.
    pub counts: Option<Counts>,
}

/// Why a contender did not finish, or is not known.
#[derive(Debug, Error)]
pub enum ContenderError {
    /// There is no such contender.
    #[error(
        "no contender is called {name}; there are umbra4[-triangles|-silhouette], umbra4-fast, umbra4-arranged, \
         umbra4-point (lights of one sample), obvhs[-cwbvh][-fast|-medium]; with the feature 'embree' embree1, embree8 and \
         embree16 with [-high][-robust][-square][-receivers][-avx2][-refit]; with the feature 'tinybvh', on a target with \
         AVX2, tinybvh[-high]"
    )]
    Unknown {
        /// The name asked for.
        name: String,
    },
    /// umbra4 refuses to run.
    #[error(transparent)]
    Executor(#[from] ExecutorError),
    /// A light of several samples is no point.
    #[error("umbra4-point takes a light of one sample, not of {samples}: --samples 1")]
    NoPoint {
        /// Samples of the light.
        samples: u32,
    },
    /// There is no such caster.
    #[error(transparent)]
    Caster(#[from] CasterError),
    /// There is no such emission.
    #[error(transparent)]
    Emission(#[from] EmissionError),
    /// There is no such light.
    #[error(transparent)]
    Volume(#[from] VolumeLightError),
    /// There is no such table.
    #[error(transparent)]
    Table(#[from] TableError),
    /// umbra4 refuses the occluders.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// Embree reports an error.
    #[cfg(feature = "embree")]
    #[error(transparent)]
    Embree(#[from] crate::embree::EmbreeError),
    /// tinybvh refuses the model.
    #[cfg(all(feature = "tinybvh", target_feature = "avx2"))]
    #[error("tinybvh: {0}")]
    Tiny(tinybvh_rs::Error),
}

#[cfg(all(feature = "tinybvh", target_feature = "avx2"))]
impl From<tinybvh_rs::Error> for ContenderError {
    fn from(error: tinybvh_rs::Error) -> Self {
        Self::Tiny(error)
    }
}

/// Something that computes masks.
pub trait Contender<W: RowWord> {
    /// Computes the masks of all receivers into `out`, receiver-major, `problem.rows()` words each, on so many threads (or
    /// [`CALLING_THREAD`](crate::umbra::CALLING_THREAD)).
    ///
    /// # Errors
    /// Whatever the contender refuses.
    fn run(&self, problem: &Problem<'_>, threads: usize, out: &mut [W]) -> Result<Run, ContenderError>;
}

/// A contender and what tables say about it.
pub struct Entry<W> {
    /// Its name, as asked for.
    pub name: String,
    /// True for umbra4, which always runs on all receivers.
    pub ours: bool,
    /// The contender.
    pub contender: Box<dyn Contender<W>>,
}

/// The contender called `name`.
///
/// # Errors
/// An unknown name.
pub fn by_name<W: RowWord>(name: &str) -> Result<Entry<W>, ContenderError> {
    let unknown = || ContenderError::Unknown { name: name.to_owned() };
    let contender: Box<dyn Contender<W>> = match name {
        "umbra4" => Box::new(Umbra::new(Precision::Exact, Index::Auto)),
        "umbra4-triangles" => Box::new(Umbra::new(Precision::Exact, Index::Hierarchy)),
        "umbra4-silhouette" => Box::new(Umbra::new(Precision::Exact, Index::Silhouette)),
        "umbra4-fast" => Box::new(Umbra::new(Precision::Fast, Index::Auto)),
        "umbra4-arranged" => Box::new(Umbra::new(Precision::Exact, Index::Auto).arranged()),
        "umbra4-point" => Box::new(PointLamp),
        _ if name.starts_with("obvhs") => Box::new(BvhRival::named(name).ok_or_else(unknown)?),
        #[cfg(feature = "embree")]
        _ if name.starts_with("embree") => Box::new(crate::embree::Embree::named(name).ok_or_else(unknown)?),
        #[cfg(all(feature = "tinybvh", target_feature = "avx2"))]
        _ if name.starts_with("tinybvh") => Box::new(crate::tiny_rival::TinyRival::named(name).ok_or_else(unknown)?),
        _ => return Err(unknown()),
    };
    Ok(Entry { name: name.to_owned(), ours: name.starts_with("umbra4"), contender })
}
