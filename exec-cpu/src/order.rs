//! Order of triangles and receivers along the curve of `umbra4_core::order`, and the frame of their codes.

use rayon::prelude::*;
use umbra4_core::{
    frame::LightFrame,
    order::{CodeFrame, Entry, code, tangents},
    proj4::Keys,
};

use crate::scatter::Scatter;

/// Entries looked at to find the middle and the spread of a scene.
const SAMPLES: usize = 1024;

/// Codes and sorts entries; those without keys come last. The frame is fitted to the slopes that occur.
pub(crate) fn ordered<T: Sync>(
    frame: &LightFrame,
    things: &[T],
    keys: impl Fn(&T) -> Option<Keys> + Sync,
) -> Vec<Entry> {
    let codes = fitted(frame, things.len(), |index| keys(&things[index]));
    let mut order: Vec<Entry> = things
        .par_iter()
        .enumerate()
        .map(|(index, thing)| Entry {
            code: keys(thing).map_or(Entry::ABSENT, |keys| code(&codes, &keys)),
            index: index as u32,
        })
        .collect();
    sort(&mut order);
    order
}

/// Binary digits that a pass sorts by; codes have 30 (and [`Entry::ABSENT`] all ones).
const DIGITS: u32 = 11;

/// Entries that are worth a thread.
const PART: usize = 1 << 14;

/// Sorts by code, entries of the same code staying in order: three passes over the entries, whatever their number. In each,
/// every thread counts the digits of its part, and so knows where they go.
pub(crate) fn sort(entries: &mut Vec<Entry>) {
    let part = entries.len().div_ceil(rayon::current_num_threads()).max(PART);
    let mut other = vec![Entry::default(); entries.len()];
    for pass in 0..3 {
        let digit = |entry: &Entry| (entry.code >> (pass * DIGITS)) as usize & ((1 << DIGITS) - 1);
        let count = |entries: &[Entry]| {
            let mut places = vec![0_u32; 1 << DIGITS];
            for entry in entries {
                places[digit(entry)] += 1;
            }
            places
        };
        let mut places: Vec<Vec<u32>> = entries.par_chunks(part).map(count).collect();
        let mut sum = 0;
        for digit in 0..1 << DIGITS {
            for places in &mut places {
                sum += std::mem::replace(&mut places[digit], sum);
            }
        }
        let out = Scatter::new(&mut other);
        entries.par_chunks(part).zip(&mut places).for_each(|(entries, places)| {
            for entry in entries {
                let place = &mut places[digit(entry)];
                // SAFETY: places were counted, so that every entry has one of its own.
                unsafe { out.part(*place as usize, 1) }.copy_from_slice(std::slice::from_ref(entry));
                *place += 1;
            }
        });
        std::mem::swap(entries, &mut other);
    }
}

/// The frame for the slopes of `count` things.
pub(crate) fn fitted(frame: &LightFrame, count: usize, keys: impl Fn(usize) -> Option<Keys>) -> CodeFrame {
    let step = (count / SAMPLES).max(1);
    let seen: Vec<[f32; 2]> = (0..count)
        .step_by(step)
        .filter_map(keys)
        .map(|keys| tangents(&keys, frame.scale))
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
