//! The door: world → lattice. The only rounding there is, the same for f32 kernels and for the host.

use proptest::prelude::*;
use umbra4_core::{
    AreaLight, Bounds, Lattice, LatticeError, Lift, SnapError,
    glam::{DVec3, IVec3, Vec3},
    snap::{LIMIT, snap_coordinate},
};
use umbra4_tests::{bigint, budget};

/// The lattice of step `2^-exponent`.
fn lattice(exponent: i32) -> Lattice {
    let reach = DVec3::splat(f64::from(LIMIT - 1024) * 2.0_f64.powi(-exponent));
    let lattice = Lattice::covering(Bounds { min: -reach, max: reach }).expect("bounds are fine");
    assert_eq!(lattice.exponent(), exponent);
    lattice
}

/// `x·2^k` rounded, halves away from zero, in integers: `None` where it is not below 2^29.
fn rounded(x: f32, k: i32) -> Option<i32> {
    let bits = x.to_bits();
    let (biased, fraction) = ((bits >> 23 & 0xff) as i32, bits & 0x7f_ffff);
    if biased == 0xff {
        return None;
    }
    let (mantissa, exponent) = if biased == 0 { (fraction, -149) } else { (fraction | 1 << 23, biased - 150) };
    let shift = exponent + k;
    let magnitude = if mantissa == 0 || shift < -40 {
        0
    } else if shift > 40 {
        return None;
    } else if shift >= 0 {
        u128::from(mantissa) << shift
    } else {
        (u128::from(mantissa) + (1 << (-shift - 1))) >> -shift
    };
    let magnitude = i32::try_from(magnitude).ok().filter(|&m| m < LIMIT)?;
    Some(if x < 0.0 { -magnitude } else { magnitude })
}

/// Any f32, and many whose scaled value is near a half, or near the end of the lattice.
fn float(k: i32) -> impl Strategy<Value = f32> {
    let scale = 2.0_f64.powi(-k);
    prop_oneof![
        any::<u32>().prop_map(f32::from_bits),
        (-(1 << 24)..1 << 24_i32, -3..=3_i32).prop_map(move |(n, e)| (f64::from(n) * 2.0_f64.powi(e) * scale) as f32),
        (-2100..2100_i32).prop_map(move |n| (f64::from(n) * 0.5 * scale) as f32),
        (-64..64_i32, any::<bool>()).prop_map(move |(n, minus)| {
            let x = ((f64::from(LIMIT) * scale) as f32).to_bits().wrapping_add_signed(n);
            if minus { -f32::from_bits(x) } else { f32::from_bits(x) }
        }),
        (1..4000_u32).prop_map(f32::from_bits),
    ]
}

fn exponent_and_float() -> impl Strategy<Value = (i32, f32)> {
    prop_oneof![-98..=100_i32, -4..30_i32, Just(-98), Just(100)].prop_flat_map(|k| (Just(k), float(k)))
}

proptest! {
    #![proptest_config(ProptestConfig { cases: budget::of(100_000), failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn the_kernel_snaps_as_the_host_does_and_both_as_integers_say((k, x) in exponent_and_float()) {
        let lattice = lattice(k);
        let params = lattice.snap_params().expect("the origin is zero");
        let kernel = snap_coordinate(&params, x);
        let host = lattice.snap(Vec3::new(0.0, x, 0.0));
        prop_assert_eq!(kernel, host.ok().map(|p| p.y), "k = {}, x = {:e}", k, x);
        prop_assert_eq!(kernel, rounded(x, k), "k = {}, x = {:e}", k, x);
        match host {
            Ok(p) => {
                prop_assert_eq!((p.x, p.z), (0, 0));
                // Idempotent: a lattice point, brought back to the world, stays where it is.
                prop_assert_eq!(lattice.snap_f64(lattice.to_world(p)), Ok(p));
            }
            Err(SnapError::NotFinite { axis, value }) => {
                prop_assert!(!x.is_finite() && axis == 'y' && value.to_bits() == f64::from(x).to_bits());
            }
            Err(SnapError::OutOfRange { axis, value, min, max }) => {
                prop_assert!(x.is_finite() && axis == 'y' && value == f64::from(x));
                prop_assert!(value < min + lattice.step() || value > max - lattice.step());
            }
        }
    }

    #[test]
    fn the_lattice_is_the_finest_that_holds_the_bounds(largest in -1.0e30..1.0e30_f64, power in -120..30_i32) {
        let largest = largest * 2.0_f64.powi(power);
        prop_assume!(largest.abs() < 1.7e38);
        let bounds = Bounds { min: DVec3::splat(largest.min(0.0)), max: DVec3::splat(largest.max(0.0)) };
        let lattice = Lattice::covering(bounds).expect("bounds are fine");
        prop_assert!(lattice.snap_f64(bounds.min).is_ok() && lattice.snap_f64(bounds.max).is_ok());
        let units = largest.abs() / lattice.step();
        prop_assert!(units < f64::from(LIMIT));
        prop_assert!(lattice.exponent() == 100 || units > f64::from(LIMIT / 2 - 1024), "{} units", units);
    }

    #[test]
    fn points_far_away_snap_relative_to_the_origin(x in -1.0e3..1.0e3_f64, origin in -1.0e9..1.0e9_f64) {
        // Multiples of 2^-20: the sum is exact.
        let x = (x * f64::from(1 << 20)).round() / f64::from(1 << 20);
        let origin = origin.round();
        let bounds = |c: f64| Bounds { min: DVec3::splat(c - 1001.0), max: DVec3::splat(c + 1001.0) };
        let far = Lattice::covering_about(bounds(origin), DVec3::splat(origin)).expect("bounds are fine");
        let near = Lattice::covering(bounds(0.0)).expect("bounds are fine");
        prop_assert_eq!(far.snap_f64(DVec3::splat(origin + x)), near.snap_f64(DVec3::splat(x)));
        prop_assert!(origin == 0.0 || far.snap_params().is_none());
    }

    #[test]
    fn a_light_keeps_its_centre_and_its_samples_move_by_less_than_stated(
        corner in prop::array::uniform3(-5.0..5.0_f64),
        u in prop::array::uniform3(-1.0..1.0_f64),
        v in prop::array::uniform3(-1.0..1.0_f64),
        rows in 1..=64_u32,
        columns in 1..=64_u32,
    ) {
        let (corner, u, v) = (DVec3::from_array(corner), DVec3::from_array(u), DVec3::from_array(v));
        let long = |edge: DVec3| edge.abs().max_element() > 0.01;
        prop_assume!(long(u) && long(v) && u.cross(v).length() > 1.0e-4);
        let lattice = Lattice::covering(Bounds { min: DVec3::splat(-8.0), max: DVec3::splat(8.0) }).expect("fine");
        let light = AreaLight::new(corner, u, v, rows, columns).expect("a light with area");
        let snapped = light.snap(&lattice, Lift::NONE).expect("the light fits");
        let moves = 0.5 + f64::from(rows - 1 + columns - 1) / 4.0 + 1.0e-3;
        for i in [0, rows - 1] {
            for j in [0, columns - 1] {
                let exact = corner
                    + u * (f64::from(j) + 0.5) / f64::from(columns)
                    + v * (f64::from(i) + 0.5) / f64::from(rows);
                let off = (exact / lattice.step() - snapped.sample(i, j).as_dvec3()).abs().max_element();
                prop_assert!(off <= moves, "sample ({}, {}) is off by {} > {}", i, j, off, moves);
            }
        }
        let twice_center = snapped.sample(0, 0) + snapped.sample(rows - 1, columns - 1);
        let off = (light.center() / lattice.step() * 2.0 - twice_center.as_dvec3()).abs().max_element();
        prop_assert!(off <= 1.0 + 1.0e-3, "the centre is off by {} half units", off);
        // A lifted light is the same light, moved along one axis to the side that it shines to.
        let lifted = light.snap(&lattice, Lift::F32_POSITIONS).expect("the light fits");
        let by = lifted.origin - snapped.origin;
        prop_assert_eq!((lifted.step_u, lifted.step_v), (snapped.step_u, snapped.step_v));
        prop_assert_eq!(by.abs().element_sum(), by.abs().max_element());
        prop_assert!(by.abs().max_element() >= Lift::F32_POSITIONS.steps());
        let normal = [snapped.step_u, snapped.step_v, by].map(bigint::point);
        prop_assert_eq!(bigint::sign(&bigint::det3(&normal[0], &normal[1], &normal[2])), 1);
    }
}

#[test]
fn halves_go_away_from_zero() {
    let lattice = lattice(0);
    for (x, expected) in [(0.5, 1), (-0.5, -1), (1.5, 2), (-1.5, -2), (2.5, 3), (0.499_999_97, 0), (-0.499_999_97, 0)] {
        assert_eq!(lattice.snap(Vec3::splat(x)), Ok(IVec3::splat(expected)), "{x}");
        assert_eq!(snap_coordinate(&lattice.snap_params().expect("origin zero"), x), Some(expected), "{x}");
    }
}

#[test]
fn the_ends_of_the_lattice() {
    let lattice = lattice(0);
    let last = f64::from(LIMIT - 1);
    assert_eq!(lattice.snap_f64(DVec3::splat(last)), Ok(IVec3::splat(LIMIT - 1)));
    assert_eq!(lattice.snap_f64(DVec3::splat(-last - 0.499)), Ok(IVec3::splat(1 - LIMIT)));
    for outside in [last + 0.5, -last - 0.5, 1.0e300, -1.0e300] {
        assert!(matches!(
            lattice.snap_f64(DVec3::new(0.0, 0.0, outside)),
            Err(SnapError::OutOfRange { axis: 'z', value, .. }) if value == outside
        ));
    }
    for k in [-98, 100] {
        let scale = self::lattice(k).snap_params().expect("origin zero").scale;
        assert!(scale.is_normal() && f64::from(scale) == 2.0_f64.powi(k));
    }
}

#[test]
fn bounds_of_nothing_are_empty() {
    assert_eq!(Bounds::of([]), Bounds::EMPTY);
    assert_eq!(Bounds::of([DVec3::NAN, DVec3::INFINITY]), Bounds::EMPTY);
    assert!(matches!(Lattice::covering(Bounds::EMPTY), Err(LatticeError::Empty { axis: 'x', .. })));
    let point = Bounds::of([DVec3::ONE, DVec3::NAN]);
    assert_eq!(point, Bounds { min: DVec3::ONE, max: DVec3::ONE });
    assert_eq!(point.union(Bounds::EMPTY), point);
    // A single point at zero is held by the finest lattice.
    assert_eq!(Lattice::covering(Bounds::of([DVec3::ZERO])).expect("a point").exponent(), 100);
}
