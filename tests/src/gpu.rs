//! The executor on a GPU, as a [`Subject`].

use umbra4_core::MaskWord;
use umbra4_wgpu::{Choice, Gpu, GpuError, LatticeScene, WgpuExecutor};

use crate::{scene::Inputs, suite::Subject};

/// The executor on a GPU.
#[derive(Debug)]
pub struct Wgpu(WgpuExecutor);

impl Wgpu {
    /// On the adapter chosen, in blocks of at most `block` receivers.
    ///
    /// # Errors
    /// There is no such adapter.
    pub fn open(choice: &Choice, block: u32) -> Result<Self, GpuError> {
        Ok(Self(WgpuExecutor::new(Gpu::open(choice)?).with_block(block)))
    }
}

fn scene(inputs: &Inputs) -> LatticeScene<'_> {
    LatticeScene { vertices: inputs.occluders.vertices(), triangles: inputs.occluders.triangles() }
}

impl Subject for Wgpu {
    fn name(&self) -> String {
        format!("wgpu, {}", self.0.gpu().name)
    }

    fn masks<W: MaskWord>(&self, inputs: &Inputs) -> Result<Vec<W>, String> {
        let done = self.0.masks::<W>(&scene(inputs), &inputs.light, inputs.receivers.points());
        Ok(done.map_err(|error| error.to_string())?.0)
    }

    fn visibility(&self, inputs: &Inputs) -> Result<Vec<f32>, String> {
        let done = self.0.visibility(&scene(inputs), &inputs.light, inputs.receivers.points());
        Ok(done.map_err(|error| error.to_string())?.0)
    }
}
