//! What can go wrong on a device.

use thiserror::Error;
use umbra4_core::{LatticeError, LightError, PunctualLightError, glam::Vec3, texture::TextureError};
use umbra4_maps::{microquad::MicroquadError, stochastic::StochasticError};
use wgpu::{Device, ErrorFilter};

use crate::usable::{Lack, Listed};

/// Why the GPU does not answer, or a call is refused.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum GpuError {
    /// There is no adapter such as was asked for.
    #[error("no {wanted}: {reason}")]
    NoAdapter {
        /// What was asked for.
        wanted: String,
        /// What the system said, or which adapters there are.
        reason: String,
    },
    /// The adapter, or the device that an engine hands over, cannot be used: its backend is one that the kernels do not compile for, a limit is too
    /// small, or its driver does not run the kernels as they are.
    #[error("adapter {adapter} cannot be used: {}", Listed(lacks))]
    Unusable {
        /// Its name and its backend.
        adapter: String,
        /// Why; never empty.
        lacks: Vec<Lack>,
    },
    /// The device could not be opened.
    #[error("cannot open adapter {adapter}: {reason}")]
    NoDevice {
        /// Its name.
        adapter: String,
        /// What the driver said.
        reason: String,
    },
    /// A buffer would be larger than the device can bind.
    #[error("{what} take {bytes} bytes, more than the {limit} that the device binds")]
    TooLarge {
        /// What it would hold.
        what: &'static str,
        /// Its size.
        bytes: u64,
        /// Largest size.
        limit: u64,
    },
    /// The device has no memory left.
    #[error("the device is out of memory while it {doing}")]
    OutOfMemory {
        /// What it was asked for.
        doing: &'static str,
    },
    /// wgpu refuses a call, or the driver does.
    #[error("wgpu refuses to {doing}: {reason}")]
    Refused {
        /// What was asked for.
        doing: &'static str,
        /// What wgpu said.
        reason: String,
    },
    /// The device was lost, or does not answer.
    #[error("the device was lost while it {doing}: {reason}")]
    Lost {
        /// What it was doing.
        doing: &'static str,
        /// What the driver said.
        reason: String,
    },
    /// The driver stops threads that run for long, even for the least that they can be given.
    #[error("the driver of {adapter} stops threads before they are done")]
    Stopped {
        /// The adapter.
        adapter: String,
    },
    /// The mask word holds fewer columns than the light has.
    #[error("a light of {columns} columns does not fit words of {bits} bits")]
    WordTooNarrow {
        /// Columns of the light.
        columns: u32,
        /// Bits of the word.
        bits: u32,
    },
    /// Options of a stochastic soft shadow map are outside their ranges.
    #[error(transparent)]
    Stochastic(#[from] StochasticError),
    /// Something that the engine hands over cannot be used.
    #[error("{field} is {value}: {needs}")]
    Field {
        /// Which: `meshes[2].vertices.stride`.
        field: String,
        /// Its value.
        value: String,
        /// What is needed.
        needs: &'static str,
    },
    /// No lattice holds the bounds of the frame.
    #[error("bounds: {0}")]
    Bounds(#[from] LatticeError),
    /// A light cannot be rounded to the lattice.
    #[error("lights[{index}]: {source}")]
    Light {
        /// Which.
        index: usize,
        /// Why.
        source: LightError,
    },
    /// A light without extent cannot be rounded to the lattice.
    #[error("lights[{index}]: {source}")]
    PunctualLight {
        /// Which.
        index: usize,
        /// Why.
        source: PunctualLightError,
    },
    /// The emission is another light's.
    #[error("an emission of {}×{} samples for a light of {}×{}", emission[0], emission[1], light[0], light[1])]
    EmissionSize {
        /// Rows and columns of the emission.
        emission: [u32; 2],
        /// Rows and columns of the light.
        light: [u32; 2],
    },
    /// There are more normals, or fewer, than receivers.
    #[error("{normals} normals for {receivers} receivers")]
    NormalCount {
        /// Normals given.
        normals: usize,
        /// Receivers given.
        receivers: usize,
    },
    /// A receiver's normal is zero or not finite.
    #[error("normal {index} is {normal}: it points nowhere")]
    Normal {
        /// Index of the receiver.
        index: usize,
        /// The normal given.
        normal: Vec3,
    },
    /// Options of microquad soft shadow mapping are refused.
    #[error(transparent)]
    Microquads(#[from] MicroquadError),
    /// The technique gives visibility alone.
    #[error("a stochastic soft shadow map has no masks: ask for visibility")]
    NoMasks,
    /// Masks to add to are those of other receivers, or of another light.
    #[error("masks are {words} words, not those of {receivers} receivers with {rows} rows")]
    MaskCount {
        /// Words given.
        words: usize,
        /// Receivers.
        receivers: usize,
        /// Rows of the light.
        rows: u32,
    },
    /// Either all receivers face some way, or it is known of none.
    #[error("facings of {facings} receivers, for {receivers}")]
    FacingCount {
        /// Facings given.
        facings: usize,
        /// Receivers given.
        receivers: usize,
    },
    /// Either all receivers are on layers of their own, or none is.
    #[error("layers of {layers} receivers, for {receivers}")]
    LayerCount {
        /// Sets of layers given.
        layers: usize,
        /// Receivers given.
        receivers: usize,
    },
    /// There is no such caster.
    #[error("caster {place} of {casters}: there is none")]
    NoCaster {
        /// Its place.
        place: usize,
        /// Casters there are.
        casters: usize,
    },
    /// One of several casters is refused.
    #[error("caster {place}: {source}")]
    Caster {
        /// Its place.
        place: usize,
        /// What is wrong with it.
        source: Box<GpuError>,
    },
    /// The texture of a caster is refused.
    #[error(transparent)]
    Texture(#[from] TextureError),
    /// There are more elements than a 32-bit index can name.
    #[error("{count} {field} are too many: at most {most} can be indexed")]
    TooMany {
        /// "vertices", "triangles" or "receivers".
        field: &'static str,
        /// How many were given.
        count: usize,
        /// How many can be.
        most: usize,
    },
}

/// Does something with a device, and catches what wgpu would else panic with. For tools that use the device too.
///
/// # Errors
/// The device is out of memory; wgpu or the driver refuses.
pub fn guarded<T>(device: &Device, doing: &'static str, work: impl FnOnce() -> T) -> Result<T, GpuError> {
    let memory = device.push_error_scope(ErrorFilter::OutOfMemory);
    let internal = device.push_error_scope(ErrorFilter::Internal);
    let validation = device.push_error_scope(ErrorFilter::Validation);
    let done = work();
    let refused = pollster::block_on(validation.pop());
    let failed = pollster::block_on(internal.pop());
    let exhausted = pollster::block_on(memory.pop());
    match (exhausted, refused.or(failed)) {
        (Some(_), _) => Err(GpuError::OutOfMemory { doing }),
        (None, Some(error)) => Err(GpuError::Refused { doing, reason: error.to_string() }),
        (None, None) => Ok(done),
    }
}
