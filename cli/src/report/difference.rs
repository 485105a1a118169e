//! How far visibilities are from those of a reference.

/// Why two sets of visibilities cannot be compared.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum CompareError {
    /// There is nothing to compare.
    #[error("there is no receiver to compare: the camera sees nothing")]
    Empty,
    /// One has more receivers than the other.
    #[error("{found} visibilities cannot be compared with {expected}")]
    Lengths {
        /// Visibilities.
        found: usize,
        /// Visibilities of the reference.
        expected: usize,
    },
    /// A visibility that is no share.
    #[error("the visibility of receiver {receiver} is {value}, outside 0..=1")]
    NoShare {
        /// Place of the receiver.
        receiver: usize,
        /// Its visibility, or the reference's.
        value: f32,
    },
}

/// Absolute differences of visibility, over all receivers compared.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Difference {
    /// Their mean, in 0..=1.
    pub mean: f64,
    /// The largest, in 0..=1.
    pub largest: f64,
}

impl Difference {
    /// Compares visibilities, receiver by receiver.
    ///
    /// # Errors
    /// No receivers, unequal numbers of them, or a value outside 0..=1, which NaN is too.
    pub fn between(values: &[f32], reference: &[f32]) -> Result<Self, CompareError> {
        if values.len() != reference.len() {
            return Err(CompareError::Lengths { found: values.len(), expected: reference.len() });
        }
        if values.is_empty() {
            return Err(CompareError::Empty);
        }
        let (mut sum, mut largest) = (0.0, 0.0_f64);
        for (receiver, (&value, &expected)) in values.iter().zip(reference).enumerate() {
            for value in [value, expected] {
                if !(0.0..=1.0).contains(&value) {
                    return Err(CompareError::NoShare { receiver, value });
                }
            }
            let difference = (f64::from(value) - f64::from(expected)).abs();
            sum += difference;
            largest = largest.max(difference);
        }
        Ok(Self { mean: sum / values.len() as f64, largest })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equal_values_do_not_differ() {
        assert_eq!(Difference::between(&[0.0, 0.5, 1.0], &[0.0, 0.5, 1.0]), Ok(Difference::default()));
    }

    #[test]
    fn one_changed_value_shows() {
        let difference = Difference::between(&[0.0, 0.75, 1.0, 0.5], &[0.0, 0.5, 1.0, 0.5]).unwrap();
        assert_eq!(difference, Difference { mean: 0.0625, largest: 0.25 });
        assert_ne!(Difference::between(&[f32::from_bits(1), 1.0], &[0.0, 1.0]), Ok(Difference::default()));
    }

    #[test]
    fn what_cannot_be_compared_is_refused() {
        assert_eq!(Difference::between(&[], &[]), Err(CompareError::Empty));
        assert_eq!(Difference::between(&[0.5], &[]), Err(CompareError::Lengths { found: 1, expected: 0 }));
        assert_eq!(Difference::between(&[0.5, 0.5], &[0.5; 3]), Err(CompareError::Lengths { found: 2, expected: 3 }));
        let bad = |value: f32| Difference::between(&[0.5, value], &[0.5, 0.5]);
        assert!(matches!(bad(f32::NAN), Err(CompareError::NoShare { receiver: 1, .. })));
        assert!(matches!(bad(-0.1), Err(CompareError::NoShare { .. })));
        assert!(matches!(Difference::between(&[0.5], &[f32::NAN]), Err(CompareError::NoShare { .. })));
    }
}
