//! Everything that can stop the program, each with a message of one line.

use std::{fmt::Display, io};

use umbra4_core::{LatticeError, LightError, accumulate::AccumulationError, emission::EmissionError};
use umbra4_cpu::{ExecutorError, SceneError};

use crate::{
    array_file::ArrayError,
    camera::CameraError,
    casters::PartError,
    executor::GpuError,
    in_file::InFile,
    light::{InLight, SnapLightError},
    light_file::LightFileError,
    model::{InPart, ModelError},
    output::OutputError,
    report::{CompareError, RasterError},
    scene_file::SceneFileError,
};

/// Why the program stopped.
#[derive(Debug, thiserror::Error)]
#[error(transparent)]
pub enum ProgramError {
    /// The model.
    Model(#[from] InFile<ModelError>),
    /// The receivers.
    Array(#[from] InFile<ArrayError>),
    /// The light's file.
    LightFile(#[from] InFile<LightFileError>),
    /// A file to be written.
    Output(#[from] InFile<OutputError>),
    /// A scene file.
    SceneFile(#[from] InFile<SceneFileError>),
    /// The light, once sampled and snapped.
    Light(#[from] LightError),
    /// One of several lights, once snapped.
    SnapLight(#[from] InLight<SnapLightError>),
    /// What the samples of a light emit.
    Emission(#[from] EmissionError),
    /// The camera.
    Camera(#[from] CameraError),
    /// The world is too large.
    Lattice(#[from] LatticeError),
    /// A point that cannot be snapped.
    Scene(#[from] SceneError),
    /// A part of the scene that casts no shadow.
    Caster(#[from] InPart<PartError>),
    /// Something that only opaque surfaces which cast on everything have.
    #[error(
        "surfaces that are cut out or let light through, layers, plane offsets and closed meshes do not go with {with}"
    )]
    Casters {
        /// What was asked for, or the light.
        with: String,
    },
    /// The executor.
    Executor(#[from] ExecutorError),
    /// The GPU, or that there is none in this program.
    Gpu(#[from] GpuError),
    /// Frames that do not belong together.
    Accumulation(#[from] AccumulationError),
    /// Visibilities that cannot be compared.
    Compare(#[from] CompareError),
    /// A plot that cannot be drawn.
    Plot(#[from] RasterError),
    /// Standard output is closed.
    Stdout(#[from] io::Error),
    /// A picture that would not fit the memory of most machines.
    #[error("{pixels} receivers are too many for one picture: at most {most}")]
    TooManyPixels {
        /// Pixels, times what each is oversampled.
        pixels: u64,
        /// How many can be.
        most: u64,
    },
    /// Something that only plain rectangles have.
    #[error("{option} is for lights with an area whose samples all emit the same, not for {light}")]
    AreaOnly {
        /// What was asked for.
        option: &'static str,
        /// The light that is something else, and what it is.
        light: String,
    },
    /// Something that a file with lights of its own says already.
    #[error("{option} is not for {file}: it has lights of its own")]
    FileLights {
        /// What was asked for.
        option: &'static str,
        /// The scene file or the model.
        file: String,
    },
    /// A number of threads that the system does not give.
    #[error("cannot start {threads} threads: {reason}")]
    Threads {
        /// Threads asked for.
        threads: usize,
        /// What the system said.
        reason: String,
    },
}

/// Any message as one line.
pub fn one_line(message: impl Display) -> String {
    message.to_string().split_whitespace().collect::<Vec<_>>().join(" ")
}
