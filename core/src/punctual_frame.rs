//! How triangles and receivers meet before a light without extent: the full-coverage test of `proj4` for one sample.
//!
//! A point light has six frames, the faces of a cube around it, with axes along the lattice's. A receiver lies in one of them,
//! in the pyramid from the light over that face, and so does every segment from the light to it: only triangles that reach
//! into the pyramid can block it. A direction has one frame, and all receivers lie in it.

use glam::IVec3;

use crate::{
    frame::LightFrame,
    lanes::Lanes,
    proj4::{self, Keys},
    punctual::Punctual,
};
#[cfg(not(target_arch = "spirv"))]
use crate::{jitter::Jitter, light::LatticeLight};

/// Most frames of a light.
pub const MAX_FACES: u32 = 6;

/// One of a light's frames.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PunctualFrame {
    frame: LightFrame,
    parallel: bool,
}

/// A vector along a face's normal, and along the two axes that follow.
#[inline(always)]
fn in_face(face: u32, v: IVec3) -> [i32; 3] {
    let [along, u, w] = match face / 2 {
        0 => [v.x, v.y, v.z],
        1 => [v.y, v.z, v.x],
        _ => [v.z, v.x, v.y],
    };
    [if face % 2 == 1 { -along } else { along }, u, w]
}

impl Punctual {
    /// Number of frames.
    pub const fn faces(&self) -> u32 {
        if self.position().is_some() { MAX_FACES } else { 1 }
    }

    /// The frame `face < faces()`.
    #[cfg(not(target_arch = "spirv"))]
    pub fn frame(&self, face: u32) -> PunctualFrame {
        match (self.position(), self.towards()) {
            (None, Some(towards)) => PunctualFrame::of(LightFrame::parallel(towards), true),
            (position, _) => {
                // The light of a face shines towards `step_u × step_v`.
                let [u, v] = match face / 2 {
                    0 => [IVec3::Y, IVec3::Z],
                    1 => [IVec3::Z, IVec3::X],
                    _ => [IVec3::X, IVec3::Y],
                };
                let [step_u, step_v] = if face % 2 == 1 { [v, u] } else { [u, v] };
                let origin = position.unwrap_or(IVec3::ZERO);
                let light = LatticeLight { origin, step_u, step_v, rows: 1, columns: 1, jitter: Jitter::NONE };
                PunctualFrame::of(LightFrame::new(&light), false)
            }
        }
    }

    /// The face that a receiver lies in. `None` where the light is: nothing can lie between.
    pub fn face_of(&self, p: IVec3) -> Option<u32> {
        let Some(position) = self.position() else { return Some(0) };
        let away = p - position;
        let size = away.abs();
        let (axis, height) = if size.x >= size.y && size.x >= size.z {
            (0, away.x)
        } else if size.y >= size.z {
            (1, away.y)
        } else {
            (2, away.z)
        };
        if height == 0 { None } else { Some(2 * axis + (height < 0) as u32) }
    }

    /// The faces whose pyramids a triangle may reach into: bit f is face f.
    #[inline]
    pub fn faces_of(&self, corners: &[IVec3; 3]) -> u32 {
        let (mut faces, mut face) = (0, 0);
        while face < self.faces() {
            faces |= (self.is_seen_through(face, corners) as u32) << face;
            face += 1;
        }
        faces
    }

    /// Whether a triangle may reach into the pyramid of a face.
    #[inline(always)]
    pub fn is_seen_through(&self, face: u32, corners: &[IVec3; 3]) -> bool {
        let Some(position) = self.position() else { return true };
        // The five planes of which all corners lie on the outer side.
        let (mut outside, mut k) = (0x1f, 0);
        while k < 3 {
            let [height, u, v] = in_face(face, corners[k] - position);
            outside &= (height <= 0) as u32
                | ((u > height) as u32) << 1
                | ((-u > height) as u32) << 2
                | ((v > height) as u32) << 3
                | ((-v > height) as u32) << 4;
            k += 1;
        }
        outside == 0
    }
}

impl PunctualFrame {
    /// Of a light's frame; `parallel`: the light is a direction.
    pub(crate) fn of(frame: LightFrame, parallel: bool) -> Self {
        Self { frame, parallel }
    }

    /// The light's frame itself.
    pub fn light_frame(&self) -> &LightFrame {
        &self.frame
    }

    /// What a triangle offers to the full-coverage test: rounded up. `None` where no point of it lies before the light.
    #[inline]
    pub fn triangle_keys(&self, corners: &[IVec3; 3]) -> Option<Keys> {
        if !self.parallel {
            return proj4::triangle_keys(&self.frame, corners);
        }
        let (mut keys, b, c) = (self.along(corners[0], 1.0), self.along(corners[1], 1.0), self.along(corners[2], 1.0));
        let mut k = 0;
        while k < keys.len() {
            keys[k] = Lanes::max(keys[k], Lanes::max(b[k], c[k]));
            k += 1;
        }
        Some(keys)
    }

    /// What a receiver in this frame asks of it: rounded down.
    #[inline]
    pub fn receiver_keys(&self, p: IVec3) -> Keys {
        if self.parallel { self.along(p, -1.0) } else { proj4::receiver_keys(&self.frame, p) }
    }

    /// Places along the axes and against them, and nearness to the light, rounded up (`up` is 1) or down (−1).
    #[inline]
    fn along(&self, p: IVec3, up: f32) -> Keys {
        let q = self.frame.place(p);
        let (a, b, w) = (up * q.error_a, up * q.error_b, up * q.error_w);
        [q.a + a, a - q.a, q.b + b, b - q.b, w - q.w]
    }
}
