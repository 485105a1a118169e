//! Depth unprojection: its own bound on its error holds against f64, and the lift that follows clears the true surface.

use proptest::prelude::*;
use umbra4_core::{
    Bounds, Lattice,
    gbuffer::{Pixel, ViewParams, from_depth, unproject},
    glam::{
        DMat4, DVec3,
        dcamera::rh::{proj, view},
    },
    surface::Upwards,
};
use umbra4_tests::budget;

const SIZE: [u32; 2] = [1920, 1080];
const REACH: f64 = 64.0;

/// A camera within the bounds that looks at another point of them.
fn camera() -> impl Strategy<Value = DMat4> {
    let point = || [-REACH..REACH, -REACH..REACH, -REACH..REACH].prop_map(DVec3::from_array);
    let near = prop_oneof![Just(0.01), Just(0.1), Just(1.0)];
    (point(), point(), near, any::<bool>()).prop_map(|(eye, target, near, reverse)| {
        let aspect = f64::from(SIZE[0]) / f64::from(SIZE[1]);
        let target = if eye.distance(target) < 1.0 { eye + DVec3::X } else { target };
        let projection = match reverse {
            true => proj::directx::perspective_infinite_reverse(1.0, aspect, near),
            false => proj::directx::perspective(1.0, aspect, near, 500.0),
        };
        projection * view::look_at_mat4(eye, target, DVec3::new(0.1, 1.0, 0.2).normalize())
    })
}

fn params(camera: DMat4, lattice: &Lattice, ulps: u32) -> ViewParams {
    ViewParams {
        snap: lattice.snap_params().expect("a lattice around zero"),
        width: SIZE[0],
        height: SIZE[1],
        depth_error: ulps as f32 * f32::EPSILON,
        empty_depth: -1.0,
        pixel_width: 2.0 / SIZE[0] as f32,
        pixel_height: 2.0 / SIZE[1] as f32,
        place: [0.5; 2],
        unproject: camera.inverse().as_mat4().to_cols_array_2d(),
        ..bytemuck::Zeroable::zeroed()
    }
}

/// The world point of a pixel, so much beside its middle, at a distance from the camera; and its depth.
fn seen(camera: DMat4, [x, y]: [u32; 2], beside: [f64; 2], distance: f64) -> (DVec3, f64) {
    let place =
        [(f64::from(x) + 0.5 + beside[0]) / f64::from(SIZE[0]), (f64::from(y) + 0.5 + beside[1]) / f64::from(SIZE[1])];
    let inverse = camera.inverse();
    let at = |depth: f64| inverse.project_point3(DVec3::new(2.0 * place[0] - 1.0, 1.0 - 2.0 * place[1], depth));
    // Two depths that both projections have, and the ray through them.
    let (a, b) = (at(0.6), at(0.5));
    let point = a + (b - a).normalize() * distance;
    (point, camera.project_point3(point).z)
}

proptest! {
    #![proptest_config(ProptestConfig { max_global_rejects: 1_000_000, ..ProptestConfig::with_cases(budget::of(20_000)) })]

    #[test]
    fn the_error_of_a_position_is_within_its_bound(
        camera in camera(),
        pixel in [0..SIZE[0], 0..SIZE[1]],
        distance in 0.0..100.0_f64,
        ulps in prop_oneof![Just(1), Just(4), Just(1000)],
        wrong in prop_oneof![Just(-1.0), Just(0.0), Just(1.0), -1.0..1.0_f64],
        moved in [-1.0..1.0_f64, -1.0..1.0_f64],
        place_error in prop_oneof![Just(0.0_f32), Just(1.0 / 512.0), Just(0.5)],
    ) {
        let lattice = Lattice::covering(Bounds { min: DVec3::splat(-REACH), max: DVec3::splat(REACH) }).expect("finite");
        let params = ViewParams { place_error, ..params(camera, &lattice, ulps) };
        // The rasteriser sees the surface a little beside the middle of the pixel.
        let (point, depth) = seen(camera, pixel, moved.map(|m| m * f64::from(place_error)), distance);
        prop_assume!(depth > 0.0 && depth < 1.0 && point.abs().max_element() < 4.0 * REACH);
        // Off by as much as is allowed, less the rounding to f32.
        let stored = (depth + wrong * (f64::from(ulps) - 0.5) * f64::from(f32::EPSILON) * depth) as f32;
        let (got, bound) = unproject(&params, pixel[0], pixel[1], stored);
        let error = (got.as_dvec3() - point).abs().max_element();
        prop_assert!(error <= f64::from(bound), "{error:e} > {bound:e} at {point}");
    }

    #[test]
    fn a_receiver_lies_above_its_true_surface(
        camera in camera(),
        pixel in [0..SIZE[0], 0..SIZE[1]],
        distance in 0.5..60.0_f64,
        normal in [-1.0..1.0_f32, -1.0..1.0_f32, -1.0..1.0_f32],
    ) {
        let lattice = Lattice::covering(Bounds { min: DVec3::splat(-REACH), max: DVec3::splat(REACH) }).expect("finite");
        let params = params(camera, &lattice, 1);
        let (point, depth) = seen(camera, pixel, [0.0; 2], distance);
        let axis = (0..3).max_by(|a, b| normal[*a].abs().total_cmp(&normal[*b].abs())).expect("three axes");
        prop_assume!(depth > 0.0 && depth < 1.0 && point.abs().max_element() < REACH && normal[axis].abs() > 0.1);
        let up = Upwards { axis, sign: if normal[axis] > 0.0 { 1 } else { -1 } };
        match from_depth(&params, pixel[0], pixel[1], depth as f32, up) {
            Pixel::Receiver(p) => {
                let above = (lattice.to_world(p) - point).dot(umbra4_core::glam::Vec3::from_array(normal).as_dvec3());
                prop_assert!(above > 0.0, "{above:e} below the surface");
            }
            // So far off that it is no point of the lattice any more.
            Pixel::Refused => {}
            Pixel::Empty => prop_assert!(false, "something is seen"),
        }
    }
}
