//! A run for the host: what it hands over goes up, what it asked for comes back, block by block.

use umbra4_core::{
    glam::Vec3,
    irradiance::PackedSample,
    kernel::{
        resolve::{ReceiverCounts, STOPPED},
        resolve_cloud::SampleTile,
        weigh::PackedWeight,
    },
};
use wgpu::{Buffer, CommandEncoderDescriptor};

use crate::{
    Gpu, GpuError, LatticeReceivers, LatticeScene,
    error::guarded,
    readback::{copy, read},
    recorder::Recorder,
    stages::{Buffers, Ends},
    submit::submit,
};

/// What is asked for.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Asked<'a> {
    pub(crate) masks: bool,
    pub(crate) counts: bool,
    pub(crate) visibility: bool,
    /// Those of the light's samples: visibility comes as sums of them.
    pub(crate) weights: Option<&'a [PackedWeight]>,
    /// What irradiance is summed up of.
    pub(crate) irradiance: Option<Illuminated<'a>>,
    /// Those of a cloud.
    pub(crate) samples: &'a [SampleTile],
    /// A table of planes before it.
    pub(crate) planes: Option<&'a [u32]>,
}

/// What irradiance is summed up of.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Illuminated<'a> {
    /// Of length 1, one a receiver.
    pub(crate) normals: &'a [Vec3],
    /// Row by row.
    pub(crate) samples: &'a [PackedSample],
}

/// What came back.
#[derive(Clone, Debug, Default)]
pub(crate) struct Results {
    pub(crate) masks: Vec<u32>,
    pub(crate) lit: Vec<u32>,
    pub(crate) weighed: Vec<[u32; 3]>,
    pub(crate) irradiance: Vec<[f32; 3]>,
    pub(crate) counts: Vec<ReceiverCounts>,
    pub(crate) stages: Vec<(&'static str, f64)>,
    /// Whether the driver has stopped a thread: the results lack something.
    pub(crate) stopped: bool,
}

/// The host's ends of a run.
pub(crate) struct Host<'a> {
    gpu: &'a Gpu,
    asked: Asked<'a>,
    stride: u32,
    receivers: u64,
    results: Results,
}

impl<'a> Host<'a> {
    /// `stride`: words of 32 bits that a receiver's mask takes.
    pub(crate) fn new(gpu: &'a Gpu, asked: Asked<'a>, stride: u32) -> Self {
        Self { gpu, asked, stride, receivers: 0, results: Results::default() }
    }

    /// Brings the scene and the receivers to the device. No run is under way: each has waited for its results.
    pub(crate) fn upload(
        &self,
        buffers: &Buffers,
        scene: &LatticeScene<'_>,
        receivers: LatticeReceivers<'_>,
    ) -> Result<(), GpuError> {
        let Gpu { device, queue, .. } = self.gpu;
        let parts: [(&Buffer, &[u8]); 3] = [
            (&buffers.vertices, bytemuck::cast_slice(scene.vertices)),
            (&buffers.triangles, bytemuck::cast_slice(scene.triangles)),
            (&buffers.receivers, bytemuck::cast_slice(receivers.points)),
        ];
        let weights = buffers.emission.as_ref().and_then(|[weights, _]| weights.buffer()).zip(self.asked.weights);
        let weights = weights.map(|(buffer, weights)| (buffer, bytemuck::cast_slice(weights)));
        let facings = buffers.facings.as_ref().map(|buffer| (buffer, bytemuck::cast_slice(receivers.facings)));
        let samples = buffers.samples.as_ref().map(|buffer| (buffer, bytemuck::cast_slice(self.asked.samples)));
        let planes = buffers.planes.as_ref().zip(self.asked.planes);
        let planes = planes.map(|(buffer, words)| (buffer, bytemuck::cast_slice(words)));
        let illuminated = buffers.irradiance.as_ref().zip(self.asked.irradiance).map(|(buffers, asked)| {
            let [normals, samples, _] = buffers;
            [(normals, bytemuck::cast_slice(asked.normals)), (samples, bytemuck::cast_slice(asked.samples))]
        });
        let weights = weights.into_iter().chain(illuminated.into_iter().flatten());
        guarded(device, "uploads a scene", || {
            for (buffer, bytes) in parts.into_iter().chain(weights).chain(facings).chain(samples).chain(planes) {
                queue.write_buffer(buffer, 0, bytes);
            }
        })
    }

    /// The results of all blocks.
    pub(crate) fn finish(self, recorder: &mut Recorder, buffers: &Buffers) -> Result<Results, GpuError> {
        let Self { gpu: Gpu { device, queue, .. }, asked, mut results, receivers, .. } = self;
        recorder.restart();
        if receivers == 0 {
            return Ok(results);
        }
        let (stopped, lit, weighed, irradiance) = guarded(device, "reads results", || {
            let mut encoder = device.create_command_encoder(&CommandEncoderDescriptor { label: Some("umbra4") });
            let word = size_of::<u32>() as u64;
            let stopped = copy(device, &mut encoder, &buffers.masks, buffers.stopped(), word);
            let lit = buffers.lit.as_ref().filter(|_| asked.visibility);
            let lit = lit.map(|lit| copy(device, &mut encoder, lit, 0, receivers * word));
            let weighed = buffers.emission.as_ref().and_then(|[_, sums]| sums.buffer());
            let weighed = weighed.map(|weighed| copy(device, &mut encoder, weighed, 0, receivers * 3 * word));
            let irradiance = buffers.irradiance.as_ref();
            let irradiance = irradiance.map(|[_, _, sums]| copy(device, &mut encoder, sums, 0, receivers * 3 * word));
            queue.submit([encoder.finish()]);
            (stopped, lit, weighed, irradiance)
        })?;
        results.stopped = read::<u32>(device, &stopped)?.contains(&STOPPED);
        if let Some(lit) = lit {
            results.lit = read(device, &lit)?;
        }
        if let Some(weighed) = weighed {
            results.weighed = read(device, &weighed)?;
        }
        if let Some(irradiance) = irradiance {
            results.irradiance = read(device, &irradiance)?;
        }
        Ok(results)
    }
}

impl Ends for Host<'_> {
    // Both are on the lattice already: no plan for the host has these stages.
    fn snap_vertices(&mut self, _: &mut Recorder, _: &Buffers) -> Result<(), GpuError> {
        Ok(())
    }

    fn snap_receivers(&mut self, _: &mut Recorder, _: &Buffers, _: u32, _: u32) -> Result<(), GpuError> {
        Ok(())
    }

    fn block(&mut self, recorder: &mut Recorder, buffers: &Buffers, _: u32, count: u32) -> Result<(), GpuError> {
        self.receivers += u64::from(count);
        let Self { gpu, asked, stride, results, .. } = self;
        let bytes = |words: u64| u64::from(count) * words * size_of::<u32>() as u64;
        let mut wanted = Vec::new();
        if asked.masks {
            wanted.push((&buffers.masks, 0, bytes(u64::from(*stride))));
        }
        if let Some(counts) = &buffers.counts {
            wanted.push((counts, 0, bytes((size_of::<ReceiverCounts>() / size_of::<u32>()) as u64)));
        }
        let mut copies = submit(gpu, recorder, &wanted, &mut results.stages)?.into_iter();
        if asked.masks
            && let Some(masks) = copies.next()
        {
            results.masks.extend(read::<u32>(&gpu.device, &masks)?);
        }
        if let Some(counts) = copies.next() {
            results.counts.extend(read::<ReceiverCounts>(&gpu.device, &counts)?);
        }
        Ok(())
    }
}
