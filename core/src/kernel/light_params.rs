//! What kernels that make keys have to know of a light, whichever kind it is.

use glam::IVec3;

use crate::{
    facing::Facing,
    occluder::Occluder,
    order::CodeFrame,
    params::{Dispatched, Params, PassParams, PunctualParams},
    proj4::Keys,
    stage::{key_receivers, key_triangles},
};

/// Parameters of a light.
pub trait LightParams: Dispatched {
    /// The pass.
    fn pass(&self) -> PassParams;
    /// What orders triangles and receivers.
    fn codes(&self) -> CodeFrame;
    /// Keys and orientation of a triangle; `None` where it blocks nothing.
    fn triangle(&self, corners: [IVec3; 3]) -> Option<(Keys, Occluder)>;
    /// Keys of a receiver; `None` where no triangle has to be looked at.
    fn receiver(&self, p: IVec3) -> Option<Keys>;
    /// Whether the light is behind a receiver that faces so.
    fn is_behind(&self, facing: Facing, p: IVec3) -> bool;
}

impl LightParams for Params {
    #[inline(always)]
    fn pass(&self) -> PassParams {
        Params::pass(self)
    }

    #[inline(always)]
    fn codes(&self) -> CodeFrame {
        Params::codes(self)
    }

    #[inline(always)]
    fn triangle(&self, corners: [IVec3; 3]) -> Option<(Keys, Occluder)> {
        key_triangles::keys_of(&self.frame(), &self.light(), corners)
    }

    #[inline(always)]
    fn receiver(&self, p: IVec3) -> Option<Keys> {
        key_receivers::keys_of(&self.frame(), &self.light(), p)
    }

    #[inline(always)]
    fn is_behind(&self, facing: Facing, p: IVec3) -> bool {
        facing.is_away_from(&self.light(), p)
    }
}

impl LightParams for PunctualParams {
    #[inline(always)]
    fn pass(&self) -> PassParams {
        self.params.pass()
    }

    #[inline(always)]
    fn codes(&self) -> CodeFrame {
        self.params.codes()
    }

    #[inline(always)]
    fn triangle(&self, corners: [IVec3; 3]) -> Option<(Keys, Occluder)> {
        if !self.light().is_seen_through(self.face(), &corners) {
            return None;
        }
        let keys = self.frame().triangle_keys(&corners)?;
        Some((keys, self.light().occluder(corners)?))
    }

    #[inline(always)]
    fn receiver(&self, p: IVec3) -> Option<Keys> {
        if self.light().face_of(p)? == self.face() { Some(self.frame().receiver_keys(p)) } else { None }
    }

    #[inline(always)]
    fn is_behind(&self, facing: Facing, p: IVec3) -> bool {
        facing.is_away_from_punctual(self.light(), p)
    }
}
