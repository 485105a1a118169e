//! Kernel `illuminate`: the irradiance of one receiver, from its mask ([`crate::irradiance`]).

use glam::Vec3;

use crate::{
    irradiance::{Lambertian, PackedSample, Sums, emitted, place},
    kernel::{fetch, point, store, weigh::lit_samples},
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
        let (mut lit, mut row) = (lit_samples(&light, pass.stride), 0);
        while let Some(number) = lit.next(masks, id) {
            if number >= row + light.columns {
                sums = sums.row_ended();
                row = number - number % light.columns;
            }
            let sample = fetch(samples, number as usize, [0; 5]);
            sums = sums.plus(emitted(&sample), receiver.form_factor(place(&sample)));
        }
    }
    store(irradiance, index, sums.row_ended().irradiance());
}
