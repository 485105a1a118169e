//! What reaches every receiver of one light, as fractions of what would without occluders.

use std::borrow::Cow;

use umbra4_core::glam::Vec3;

use crate::light::Weights;

/// The fractions of one light, for every receiver.
#[derive(Clone, Debug)]
pub enum Fractions<'a> {
    /// Of a light whose samples all emit the same: the fraction of those that are lit.
    Plain(Vec<f32>),
    /// Of a light with weights: the sums of those of lit samples.
    Weighted {
        /// The weights of all samples.
        emission: Cow<'a, Weights>,
        /// The sums, red, green and blue.
        lit: Vec<[u32; 3]>,
    },
}

impl Fractions<'_> {
    /// The fraction that reaches a receiver, red, green and blue; all of it where there is no such receiver.
    pub fn color(&self, receiver: usize) -> Vec3 {
        match self {
            Self::Plain(lit) => Vec3::splat(lit.get(receiver).copied().unwrap_or(1.0)),
            Self::Weighted { emission, lit } => {
                lit.get(receiver).map_or(Vec3::ONE, |lit| Vec3::from_array(emission.fraction(*lit)))
            }
        }
    }

    /// The fraction of the weights of all colours together.
    fn gray(&self, receiver: usize) -> f32 {
        match self {
            Self::Plain(lit) => lit.get(receiver).copied().unwrap_or(1.0),
            Self::Weighted { emission, lit } => lit.get(receiver).map_or(1.0, |lit| {
                let sum = |weights: [u32; 3]| weights.iter().map(|weight| f64::from(*weight)).sum::<f64>();
                (sum(*lit) / sum(emission.total())) as f32
            }),
        }
    }
}

/// The mean over lights of the fraction that is lit, for every one of so many receivers.
pub fn mean(lights: &[Fractions<'_>], receivers: usize) -> Vec<f32> {
    let of = |receiver| lights.iter().map(|light| light.gray(receiver)).sum::<f32>() / lights.len() as f32;
    (0..receivers).map(of).collect()
}

/// The same in colour.
pub fn mean_color(lights: &[Fractions<'_>], receivers: usize) -> Vec<Vec3> {
    let of = |receiver| lights.iter().map(|light| light.color(receiver)).sum::<Vec3>() / lights.len() as f32;
    (0..receivers).map(of).collect()
}

#[cfg(test)]
mod tests {
    use umbra4_core::emission::Emission;

    use super::*;

    #[test]
    fn colours_are_fractions_of_their_own() {
        let emission = Emission::new(1, 2, vec![[4, 6, 0], [4, 2, 0]]).unwrap();
        let weighted =
            Fractions::Weighted { emission: Cow::Borrowed(&emission), lit: vec![[8, 8, 0], [4, 2, 0], [0, 0, 0]] };
        assert_eq!([0, 1, 2].map(|i| weighted.color(i).to_array()), [[1.0, 1.0, 0.0], [0.5, 0.25, 0.0], [0.0; 3]]);
        assert_eq!([0, 1, 2].map(|i| weighted.gray(i)), [1.0, 0.375, 0.0]);
        let lights = [weighted, Fractions::Plain(vec![1.0, 0.125, 0.0])];
        assert_eq!(mean(&lights, 3), [1.0, 0.25, 0.0]);
        // Of a colour that the light does not have, no part gets through.
        assert_eq!(mean_color(&lights, 2), [Vec3::new(1.0, 1.0, 0.5), Vec3::new(0.3125, 0.1875, 0.0625)]);
    }
}
