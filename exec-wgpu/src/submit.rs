//! What was recorded goes to the device, and what was asked for comes back.

use wgpu::{Buffer, CommandEncoderDescriptor};

use crate::{
    Gpu, GpuError,
    error::guarded,
    readback::{copy, read},
    recorder::Recorder,
    timing::{add, seconds},
};

/// A part of a buffer: first byte and number of bytes.
pub(crate) type Wanted<'a> = (&'a Buffer, u64, u64);

/// Encodes what was recorded, submits it, and hands out a copy of each part that is wanted, to be read. Adds the seconds of stages, where they are
/// taken: then, and then alone, it waits.
pub(crate) fn submit(
    gpu: &Gpu,
    recorder: &mut Recorder,
    wanted: &[Wanted<'_>],
    stages: &mut Vec<(&'static str, f64)>,
) -> Result<Vec<Buffer>, GpuError> {
    let Gpu { device, queue, .. } = gpu;
    let (copies, ticks) = guarded(device, "records passes", || {
        let mut encoder = device.create_command_encoder(&CommandEncoderDescriptor { label: Some("umbra4") });
        recorder.encode(&mut encoder)?;
        let copies = wanted.iter().map(|(buffer, from, bytes)| copy(device, &mut encoder, buffer, *from, *bytes));
        let copies: Vec<Buffer> = copies.collect();
        let ticks = recorder.timing().filter(|timing| !timing.stages().is_empty()).map(|timing| {
            let size = timing.stages().len() * size_of::<[u64; 2]>();
            copy(device, &mut encoder, timing.ticks(), 0, size as u64)
        });
        queue.submit([encoder.finish()]);
        Ok::<_, GpuError>((copies, ticks))
    })??;
    if let Some((timing, ticks)) = recorder.timing().zip(ticks) {
        let ticks = read::<u64>(device, &ticks)?;
        for (stage, time) in seconds(timing.stages(), &ticks, queue.get_timestamp_period()) {
            add(stages, stage, time);
        }
    }
    Ok(copies)
}
