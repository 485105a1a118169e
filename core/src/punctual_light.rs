//! What a light without extent is in the world, and how it is rounded to the lattice.

use glam::{DVec3, IVec3};
use thiserror::Error;

use crate::{
    lattice::{Lattice, SnapError},
    punctual::Punctual,
    snap::LIMIT,
};

/// Why a light without extent is refused.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
pub enum PunctualLightError {
    /// The position is not finite, or outside the lattice.
    #[error("light position: {0}")]
    Position(SnapError),
    /// The direction is zero or not finite.
    #[error("light direction is {towards}: it points nowhere")]
    Direction {
        /// The direction given.
        towards: DVec3,
    },
}

/// A light in one point, world. It shines to all sides.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PointLight {
    /// Where it is.
    pub position: DVec3,
}

impl PointLight {
    /// The light on the lattice.
    ///
    /// # Errors
    /// A position that is not finite or outside the lattice.
    pub fn snap(&self, lattice: &Lattice) -> Result<Punctual, PunctualLightError> {
        lattice.snap_f64(self.position).map(Punctual::at_sample).map_err(PunctualLightError::Position)
    }
}

/// A light that is infinitely far away, such as the sun.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DirectionalLight {
    /// The vector towards it, world, of any length.
    pub towards: DVec3,
}

impl DirectionalLight {
    /// The light on any lattice, since all have the world's axes: the direction is rounded to integers, its longest component to
    /// 2^29, which turns it by less than 2^-28.
    ///
    /// # Errors
    /// A direction that is zero or not finite.
    pub fn snap(&self) -> Result<Punctual, PunctualLightError> {
        let longest = self.towards.abs().max_element();
        let nowhere = PunctualLightError::Direction { towards: self.towards };
        if !self.towards.is_finite() {
            return Err(nowhere);
        }
        let towards = (self.towards / longest * f64::from(LIMIT)).to_array();
        // Halves away from zero, as the lattice rounds.
        let rounded = towards.map(|x| (x + if x < 0.0 { -0.5 } else { 0.5 }) as i32);
        // (Of zero, 0 / 0 is not a number, which becomes 0 again.)
        Punctual::direction(IVec3::from_array(rounded)).ok_or(nowhere)
    }
}
