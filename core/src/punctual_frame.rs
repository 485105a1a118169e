//! How triangles and receivers meet before a light without extent: the full-coverage test of `proj4` for one sample.
//!
//! A point light has six frames, the faces of a cube around it, with axes along the lattice's. A receiver lies in one of them,
//! in the pyramid from the light over that face, and so does every segment from the light to it: only triangles that reach
//! into the pyramid can block it. A direction has one frame, and all receivers lie in it.

use glam::IVec3;

use crate::{
    frame::LightFrame,
    jitter::Jitter,
    lanes::Lanes,
    light::LatticeLight,
    proj4::{self, Keys},
    punctual::Punctual,
};

/// Most frames of a light.
pub const MAX_FACES: u32 = 6;

/// One of a light's frames.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PunctualFrame {
    frame: LightFrame,
    parallel: bool,
}

/// The axis of a face's normal, whether the face lies on the negative side, and the two other axes.
fn axes_of(face: u32) -> (usize, bool, [usize; 2]) {
    let axis = face as usize / 2 % 3;
    (axis, face % 2 == 1, [(axis + 1) % 3, (axis + 2) % 3])
}

impl Punctual {
    /// Number of frames.
    pub const fn faces(&self) -> u32 {
        if self.position().is_some() { MAX_FACES } else { 1 }
    }

    /// The frame `face < faces()`.
    pub fn frame(&self, face: u32) -> PunctualFrame {
        match (self.position(), self.towards()) {
            (None, Some(towards)) => PunctualFrame { frame: LightFrame::parallel(towards), parallel: true },
            (position, _) => {
                let (_, negative, [u, v]) = axes_of(face);
                let [u, v] = [IVec3::AXES[u], IVec3::AXES[v]];
                // The light of a face shines towards `step_u × step_v`.
                let [step_u, step_v] = if negative { [v, u] } else { [u, v] };
                let origin = position.unwrap_or(IVec3::ZERO);
                let light = LatticeLight { origin, step_u, step_v, rows: 1, columns: 1, jitter: Jitter::NONE };
                PunctualFrame { frame: LightFrame::new(&light), parallel: false }
            }
        }
    }

    /// The face that a receiver lies in. `None` where the light is: nothing can lie between.
    pub fn face_of(&self, p: IVec3) -> Option<u32> {
        let Some(position) = self.position() else { return Some(0) };
        let away = (p - position).to_array();
        let size = away.map(i32::unsigned_abs);
        let axis = if size[0] >= size[1] && size[0] >= size[2] {
            0
        } else if size[1] >= size[2] {
            1
        } else {
            2
        };
        if size[axis] == 0 { None } else { Some(2 * axis as u32 + u32::from(away[axis] < 0)) }
    }

    /// The faces whose pyramids a triangle may reach into: bit f is face f.
    pub fn faces_of(&self, corners: &[IVec3; 3]) -> u32 {
        let Some(position) = self.position() else { return 1 };
        let corners = corners.map(|corner| (corner - position).to_array());
        let mut faces = 0;
        for face in 0..MAX_FACES {
            let (axis, negative, others) = axes_of(face);
            let height = |p: &[i32; 3]| if negative { -p[axis] } else { p[axis] };
            let outside = all(&corners, |p| height(p) <= 0)
                || others.iter().any(|&o| all(&corners, |p| p[o] > height(p)) || all(&corners, |p| -p[o] > height(p)));
            faces |= u32::from(!outside) << face;
        }
        faces
    }
}

fn all(corners: &[[i32; 3]; 3], holds: impl Fn(&[i32; 3]) -> bool) -> bool {
    holds(&corners[0]) && holds(&corners[1]) && holds(&corners[2])
}

impl PunctualFrame {
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
        let [a, b, c] = corners.map(|corner| self.along(corner, 1.0));
        let mut keys = a;
        for (k, key) in keys.iter_mut().enumerate() {
            *key = Lanes::max(*key, Lanes::max(b[k], c[k]));
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
