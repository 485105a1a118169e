//! Order of triangles and receivers along the curve of `umbra4_core::order`, and the frame of their codes.

use rayon::prelude::*;
use umbra4_core::{
    frame::LightFrame,
    order::{CodeFrame, Entry, code, tangents},
    proj4::Keys,
};

/// Entries looked at to find the middle and the spread of a scene.
const SAMPLES: usize = 1024;

/// Codes and sorts entries; those without keys come last. The frame is fitted to the slopes that occur.
pub(crate) fn ordered(frame: &LightFrame, keys: &[Option<Keys>]) -> Vec<Entry> {
    let codes = fitted(frame, keys);
    let mut order: Vec<Entry> = keys
        .par_iter()
        .enumerate()
        .map(|(index, keys)| Entry {
            code: keys.as_ref().map_or(Entry::ABSENT, |keys| code(&codes, keys)),
            index: index as u32,
        })
        .collect();
    order.par_sort_unstable();
    order
}

fn fitted(frame: &LightFrame, keys: &[Option<Keys>]) -> CodeFrame {
    let step = (keys.len() / SAMPLES).max(1);
    let seen: Vec<[f32; 2]> = keys
        .iter()
        .step_by(step)
        .flatten()
        .map(|keys| tangents(keys, frame.scale))
        .filter(|t| t[0].abs().max(t[1].abs()) < 1.0e6)
        .collect();
    let median = |mut values: Vec<f32>| {
        let middle = values.len() / 2;
        if values.is_empty() { 0.0 } else { *values.select_nth_unstable_by(middle, f32::total_cmp).1 }
    };
    let center = [0, 1].map(|axis| median(seen.iter().map(|t| t[axis]).collect()));
    let far = median(seen.iter().map(|t| (t[0] - center[0]).abs().max((t[1] - center[1]).abs())).collect());
    CodeFrame::new(frame.scale, center, 2.0 * far)
}
