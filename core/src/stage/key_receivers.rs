//! Stage `key_receivers`: what every receiver asks of the full-coverage test.

use glam::IVec3;

use crate::{
    exact::{self, Wide},
    frame::LightFrame,
    light::LatticeLight,
    proj4::{Keys, receiver_keys},
};

/// Keys of receiver `id`. `None` where it is behind the light, and so has every bit of its mask set.
#[inline]
pub fn key_receivers(id: usize, frame: &LightFrame, light: &LatticeLight, receivers: &[IVec3]) -> Option<Keys> {
    keys_of(frame, light, *receivers.get(id)?)
}

/// As [`key_receivers`], of a receiver given by its point.
#[inline]
pub fn keys_of(frame: &LightFrame, light: &LatticeLight, p: IVec3) -> Option<Keys> {
    if exact::behind_light::<Wide>(light, p) { None } else { Some(receiver_keys(frame, p)) }
}
