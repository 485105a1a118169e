//! `color` and `intensity`.

use umbra4_core::glam::DVec3;

use super::FieldError;

const COLOR: [&str; 3] = ["color[0]", "color[1]", "color[2]"];

/// `color · intensity`, where each is an amount: at least 0, and no more than an f32 holds.
///
/// # Errors
/// One that is not.
pub fn power(color: [f64; 3], intensity: f64) -> Result<DVec3, FieldError> {
    let named = COLOR.into_iter().zip(color).chain([("intensity", intensity)]);
    for (field, value) in named {
        if !(0.0..=f64::from(f32::MAX)).contains(&value) {
            return Err(FieldError::Amount { field, value });
        }
    }
    Ok(DVec3::from_array(color) * intensity)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_amounts_are_taken() {
        assert_eq!(power([1.0, 0.5, 0.0], 4.0).unwrap(), DVec3::new(4.0, 2.0, 0.0));
        for (color, intensity, field) in [
            ([1.0, -1.0, 1.0], 1.0, "`color[1]` is -1"),
            ([1.0, 1.0, f64::NAN], 1.0, "`color[2]` is NaN"),
            ([1.0; 3], f64::INFINITY, "`intensity` is inf"),
            ([1.0; 3], -0.5, "`intensity` is -0.5"),
            ([1.0; 3], 1e39, "`intensity` is 1"),
        ] {
            let message = power(color, intensity).unwrap_err().to_string();
            assert!(message.contains(field), "{message}");
        }
    }
}
