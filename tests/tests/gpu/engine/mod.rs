//! Frames recorded into an engine's encoder: what they put on the lattice, what they shadow, and what they refuse.

mod emission;
mod example;
mod facing;
mod fixture;
mod frames;
mod hard;
mod pixels;
mod refusals;

use libtest_mimic::Trial;
use umbra4_tests::gpu::{Test, test};
use umbra4_wgpu::Gpu;

type Check = fn(&Gpu);

const CHECKS: [(&str, Check); 28] = [
    ("a_frame_is_exact", frames::a_frame_is_exact),
    ("what_cannot_be_used_is_counted", frames::what_cannot_be_used_is_counted),
    ("every_encoding_of_normals", frames::every_encoding_of_normals),
    ("frames_grow_and_shrink", frames::frames_grow_and_shrink),
    ("two_frames_in_one_submission", frames::two_frames_in_one_submission),
    ("no_allocation_once_frames_repeat", frames::no_allocation_once_frames_repeat),
    ("jittered_frames_accumulate", frames::jittered_frames_accumulate),
    ("emissions_are_those_of_the_cpu", emission::emissions_are_those_of_the_cpu),
    ("a_light_without_emission_pays_nothing", emission::a_light_without_emission_pays_nothing),
    ("emissions_at_half_resolution", emission::emissions_at_half_resolution),
    ("pixels_that_face_away_are_dark", facing::pixels_that_face_away_are_dark),
    ("samples_that_face_away_are_dark", facing::samples_that_face_away_are_dark),
    ("blocks_face_where_their_pixel_does", facing::blocks_face_where_their_pixel_does),
    ("only_those_who_ask_pay_for_facings", facing::only_those_who_ask_pay_for_facings),
    ("encodings_of_facings", facing::encodings_of_facings),
    ("lights_without_extent_are_exact", hard::lights_without_extent_are_exact),
    ("a_frame_without_triangles_is_lit", frames::a_frame_without_triangles_is_lit),
    ("depths_are_unprojected", frames::depths_are_unprojected),
    ("the_triangle_that_is_seen_decides_the_lift", pixels::the_triangle_that_is_seen_decides_the_lift),
    ("one_sample_stands_for_a_pixel", pixels::one_sample_stands_for_a_pixel),
    ("every_sample_of_a_drawn_ground_lies_above_it", pixels::every_sample_of_a_drawn_ground_lies_above_it),
    ("half_resolution_is_exact_where_it_has_receivers", pixels::half_resolution_is_exact_where_it_has_receivers),
    ("the_example_engine_has_the_shadows_of_the_cpu", example::the_example_engine_has_the_shadows_of_the_cpu),
    ("the_example_engine_can_be_resized", example::the_example_engine_can_be_resized),
    ("default_limits_and_no_features_suffice", frames::default_limits_and_no_features_suffice),
    ("stages_are_timed", frames::stages_are_timed),
    ("a_lost_device_is_an_error", refusals::a_lost_device_is_an_error),
    ("what_is_refused_is_named", refusals::what_is_refused_is_named),
];

pub fn tests() -> Vec<Test> {
    let of_gpu = |check: Check| {
        move |gpu: &Gpu| {
            check(gpu);
            Ok(())
        }
    };
    CHECKS.into_iter().map(|(name, check)| test(name, of_gpu(check))).collect()
}

/// A test that needs no adapter that can be used, but one that cannot.
pub fn of_gl() -> Trial {
    Trial::ignorable_test("engine::a_device_of_gl_is_refused", || Ok(refusals::a_device_of_gl_is_refused()))
}
