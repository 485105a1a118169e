//! The process that is measured.

use std::io::stdin;

use clap::Args;
use thiserror::Error;
use umbra4_core::{Lattice, LatticeError, Lift, LightError};
use umbra4_cpu::{CpuExecutor, ExecutorError, Occluders, Receivers, SceneError};

use super::{exchange::Handed, resident};

/// Why memory is not measured.
#[derive(Debug, Error)]
pub enum MemoryError {
    /// A scene cannot be set up.
    #[error(transparent)]
    Setup(#[from] crate::scene::SceneError),
    /// The scene does not fit a lattice.
    #[error(transparent)]
    Lattice(#[from] LatticeError),
    /// The light is refused.
    #[error(transparent)]
    Light(#[from] LightError),
    /// The occluders or receivers are refused.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// The executor refuses to run.
    #[error(transparent)]
    Executor(#[from] ExecutorError),
    /// The two processes do not understand each other.
    #[error("between the two processes: {0}")]
    Exchange(#[from] std::io::Error),
    /// The child failed; it has said why.
    #[error("the process that is measured failed")]
    Child,
    /// The system does not say.
    #[error("not measurable: this system has no VmHWM in /proc/self/status")]
    NotMeasurable,
}

/// Arguments of the child.
#[derive(Args)]
pub struct ChildArgs {
    /// Threads of the executor.
    #[arg(long)]
    threads: usize,
}

impl ChildArgs {
    /// Reads a scene from stdin, computes its visibility, and prints bytes: held with the scene, the peak of snapping it,
    /// held after that, and the peak of computing.
    ///
    /// # Errors
    /// Whatever is refused; a system that does not tell its peak.
    pub fn run(&self) -> Result<(), MemoryError> {
        let handed = Handed::read(&mut stdin().lock())?;
        let told = |bytes: Option<u64>| bytes.ok_or(MemoryError::NotMeasurable);
        // Reading needed no more than what is held now.
        let scene = told(resident::peak())?;
        let lattice = Lattice::covering(handed.bounds)?;
        let light = handed.light()?.snap(&lattice, Lift::NONE)?;
        let occluders = Occluders::new(&lattice, &handed.vertices, &handed.triangles)?;
        let receivers = Receivers::on_surfaces(&lattice, &handed.positions, &handed.normals, Lift::F32_POSITIONS)?;
        let (snapping, snapped) = (told(resident::peak())?, told(resident::now())?);
        resident::reset_peak();
        let executor = CpuExecutor::new().with_threads(self.threads)?;
        let (visibility, _) = executor.visibility(&occluders, &light, &receivers)?;
        let computing = told(resident::peak())?;
        let mean = visibility.iter().map(|&lit| f64::from(lit)).sum::<f64>() / visibility.len().max(1) as f64;
        // The mean keeps the result in use until the peak is known.
        println!("{scene} {snapping} {snapped} {computing} {mean}");
        Ok(())
    }
}
