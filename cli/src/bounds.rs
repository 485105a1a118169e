//! The box that a lattice must cover.

use umbra4_core::{AreaLight, Bounds, Lattice, LatticeError, glam::DVec3};

/// The finest lattice that holds the points and the light.
///
/// Where every point is what an f32 holds, the lattice lies around the world's origin. Points with more digits than
/// that come from worlds far away: their lattice lies around the middle of the bounds, so that the digits count.
///
/// # Errors
/// As [`Lattice::covering`].
pub fn lattice_around<'a>(
    points: impl Iterator<Item = &'a DVec3> + Clone,
    light: &AreaLight,
) -> Result<Lattice, LatticeError> {
    let single = points.clone().filter(|p| p.is_finite()).all(|p| p.as_vec3().as_dvec3() == *p);
    let bounds = Bounds::of(points.copied().chain(light.corners()));
    if single { Lattice::covering(bounds) } else { Lattice::covering_about(bounds, bounds.center()) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn far_details_in_f64_survive() {
        let light = AreaLight::new(DVec3::new(1e6, 1.0, 0.0), DVec3::X, DVec3::Z, 1, 1).unwrap();
        let far = [DVec3::new(1e6, 0.0, 0.0), DVec3::new(1e6 + 0.01, 0.0, 0.0)];
        let lattice = lattice_around(far.iter(), &light).unwrap();
        let [a, b] = far.map(|p| lattice.snap_f64(p).unwrap());
        assert!(((b - a).x as f64 * lattice.step() - 0.01).abs() < 1e-6);
        assert_eq!(lattice_around(far[..1].iter(), &light).unwrap().origin(), DVec3::ZERO);
    }
}
