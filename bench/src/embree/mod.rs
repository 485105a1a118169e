//! The rival written in C++: Embree 3, one shadow ray per light sample, single or in packets of neighbouring samples.

mod ffi;
mod packets;
mod scene;

use std::time::Instant;

use thiserror::Error;
use umbra4_core::glam::Vec3;

use crate::{
    contender::{Contender, ContenderError, Run},
    problem::Problem,
    row_word::RowWord,
};
use packets::{trace, trace_receivers};
use scene::{Options, TriangleScene};

/// Embree reports an error.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
#[error("Embree reports error {code}")]
pub struct EmbreeError {
    /// `RTCError`
    pub code: i32,
}

/// A way of using Embree.
#[derive(Clone, Copy, Debug)]
pub struct Embree {
    width: usize,
    /// Packets of 4×2 or 4×4 samples instead of 8 or 16 in a row.
    square: bool,
    /// Packets of neighbouring receivers instead of neighbouring samples.
    receivers: bool,
    options: Options,
}

impl Embree {
    /// `embree{1,8,16}[-high][-robust][-square][-avx2][-refit]`, or `embree{8,16}-receivers…`: packets of receivers, for lights of few samples.
    pub fn named(name: &str) -> Option<Self> {
        let mut words = name.strip_prefix("embree")?.split('-');
        let width = words.next()?.parse().ok().filter(|width| [1, 8, 16].contains(width))?;
        let mut embree = Self { width, square: false, receivers: false, options: Options::default() };
        for word in words {
            match word {
                "high" => embree.options.high_quality = true,
                "robust" => embree.options.robust = true,
                "refit" => embree.options.refit = true,
                "avx2" => embree.options.avx2 = true,
                "receivers" => embree.receivers = true,
                "square" => embree.square = true,
                _ => return None,
            }
        }
        Some(embree)
    }

    fn masks<W: RowWord>(&self, scene: &TriangleScene, problem: &Problem<'_>, origins: &[Vec3], out: &mut [W]) {
        match (self.width, self.square) {
            (8, _) if self.receivers => trace_receivers::<8, W>(scene, problem, origins, out),
            (16, _) if self.receivers => trace_receivers::<16, W>(scene, problem, origins, out),
            (1, _) => trace::<1, W>(scene, problem, 1, origins, out),
            (8, false) => trace::<8, W>(scene, problem, 8, origins, out),
            (8, true) => trace::<8, W>(scene, problem, 4, origins, out),
            (_, false) => trace::<16, W>(scene, problem, 16, origins, out),
            (_, true) => trace::<16, W>(scene, problem, 4, origins, out),
        }
    }
}

impl<W: RowWord> Contender<W> for Embree {
    fn run(&self, problem: &Problem<'_>, threads: usize, out: &mut [W]) -> Result<Run, ContenderError> {
        let mut start = Instant::now();
        let scene = TriangleScene::new(problem.model, self.options, threads.max(1))?;
        if self.options.refit {
            start = Instant::now();
            scene.refit(problem.model)?;
        }
        let build = start.elapsed().as_secs_f64();
        let start = Instant::now();
        problem.for_blocks(threads, out, |origins, rows| self.masks(&scene, problem, origins, rows));
        Ok(Run { build, masks: start.elapsed().as_secs_f64(), counts: None })
    }
}
