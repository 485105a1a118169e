//! Kernel `illuminate`: the irradiance of one receiver, from its mask ([`crate::irradiance`]).

use glam::Vec3;

use crate::{
    irradiance::{Lambertian, PackedSample, Sums, emitted, place},
    kernel::{fetch, point, store},
    params::Params,
};

/// Receiver `id` of a block. Masks as [`super::weigh::weigh`] reads them; `normals` of length 1, of all receivers; `samples` row by row.
#[inline(always)]
pub fn illuminate(
    id: usize,
    params: &Params,
    masks: &[u32],
    receivers: &[[i32; 3]],
    normals: &[[f32; 3]],
    samples: &[PackedSample],
    irradiance: &mut [[f32; 3]],
) {
    let pass = params.pass();
    if id >= pass.count as usize {
        return;
    }
    let (light, index, mut sums) = (params.light(), pass.first as usize + id, Sums::default());
    if let Some(p) = point(receivers, index) {
        let [x, y, z] = fetch(normals, index, [0.0; 3]);
        let receiver = Lambertian::new(&light, p, Vec3::new(x, y, z));
        let (mask, mut row) = (id * pass.stride as usize, 0);
        while row < light.rows {
            let mut first = 0;
            while first < light.columns {
                let mut lit = lit_of(masks, mask, row, first, light.columns);
                while lit != 0 {
                    let column = first + lit.trailing_zeros();
                    lit &= lit.wrapping_sub(1);
                    let sample = fetch(samples, (row * light.columns + column) as usize, [0; 5]);
                    sums = sums.plus(emitted(&sample), receiver.form_factor(place(&sample)));
                }
                first += 32;
            }
            sums = sums.row_ended();
            row += 1;
        }
    }
    store(irradiance, index, sums.irradiance());
}

/// The lit samples among the 32 of a row from column `first` on, a multiple of 32.
#[inline(always)]
fn lit_of(masks: &[u32], mask: usize, row: u32, first: u32, columns: u32) -> u32 {
    let (word, shift) = if columns <= 16 {
        (row / 2, row % 2 * 16)
    } else if columns <= 32 {
        (row, 0)
    } else {
        (row * 2 + first / 32, 0)
    };
    let left = columns - first;
    let present = if left < 32 { (1 << left) - 1 } else { u32::MAX };
    !(fetch(masks, mask + word as usize, u32::MAX) >> shift) & present
}
