//! Kernel `key_receivers`: keys and place on the curve of one receiver.

use crate::{
    kernel::{light_params::LightParams, point, store},
    order::{Entry, code},
    proj4::{Keys, NOTHING},
};

/// Receiver `first + id` of a block; those behind the light come last in the order.
#[inline(always)]
pub fn key_receivers<T: LightParams>(
    id: usize,
    params: &T,
    receivers: &[[i32; 3]],
    keys: &mut [Keys],
    order: &mut [Entry],
) {
    let pass = params.pass();
    if id >= pass.count as usize {
        return;
    }
    let mut entry = Entry { code: Entry::ABSENT, index: id as u32 };
    let mut own = NOTHING;
    if let Some(p) = point(receivers, pass.first as usize + id)
        && let Some(found) = params.receiver(p)
    {
        own = found;
        entry.code = code(&params.codes(), &own);
    }
    store(keys, id, own);
    store(order, id, entry);
}
