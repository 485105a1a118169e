//! The scenes that are made by code.

#![expect(clippy::unwrap_used, reason = "a test may panic")]

use std::{collections::HashSet, path::Path};

use super::*;

/// Name, least number of triangles asked for, and the number there is: another one is another scene.
const GENERATED: [(&str, usize, usize); 3] =
    [("foliage", 350_000, 478_355), ("lattice", 500_000, 540_146), ("hairball", 500_000, 518_402)];

fn made(name: &str) -> Scene {
    scene(name, Path::new("no such directory"), 4, PAPER_LIGHT).unwrap()
}

#[test]
fn generated_scenes_have_their_triangles() {
    assert_eq!(generated().collect::<Vec<_>>(), GENERATED.map(|(name, ..)| name));
    for (name, least, expected) in GENERATED {
        let found = made(name).model.triangles.len();
        assert!(found >= least, "{name}: {found}");
        assert_eq!(found, expected, "{name}");
    }
}

#[test]
fn generated_scenes_are_the_same_on_every_run() {
    for name in generated() {
        assert!(made(name).model == made(name).model, "{name}");
    }
}

#[test]
fn generated_triangles_have_an_area_and_are_no_copies() {
    for name in generated() {
        let model = made(name).model;
        assert!(model.vertices.iter().all(|vertex| vertex.is_finite()), "{name}");
        let mut seen = HashSet::new();
        for t in 0..model.triangles.len() {
            let [a, b, c] = model.corners(t).unwrap();
            let longest = (b - a).length().max((c - b).length()).max((a - c).length());
            // The height over the longest side, in its lengths.
            let height = (b - a).cross(c - a).length() / (longest * longest);
            assert!(height > 1e-3, "{name}, triangle {t}: {a} {b} {c}");
            let mut corners = [a, b, c].map(|corner| corner.to_array().map(f64::to_bits));
            corners.sort_unstable();
            assert!(seen.insert(corners), "{name}, triangle {t} is there twice");
        }
    }
}

#[test]
fn the_light_is_outside_and_faces_the_model() {
    for name in generated() {
        for paper_light in [1.0, PAPER_LIGHT, 5.0] {
            let scene = made(name).with_light_scale(paper_light).unwrap();
            let Lamp { corner, edge_u, edge_v } = scene.lamp;
            for point in [corner, corner + edge_u, corner + edge_v, corner + edge_u + edge_v] {
                // Above all triangles; the ground lies below the model.
                assert!(point.y > scene.extent.max.y, "{name}: a corner of the light is at {point}");
            }
            let normal = edge_u.cross(edge_v);
            let Bounds { min, max } = scene.extent;
            for i in 0..8 {
                let corner = |bit: usize, low: f64, high: f64| if i >> bit & 1 == 0 { low } else { high };
                let point = DVec3::new(corner(0, min.x, max.x), corner(1, min.y, max.y), corner(2, min.z, max.z));
                assert!(normal.dot(point - scene.lamp.corner) > 0.0, "{name}: {point} is behind the light");
            }
        }
    }
}

#[test]
fn a_light_of_another_size_is_the_one_made_so() {
    let (scaled, made) = (made("hairball").with_light_scale(5.0).unwrap(), {
        scene("hairball", Path::new("no such directory"), 4, 5.0).unwrap()
    });
    assert!(scaled.lamp.corner.distance(made.lamp.corner) < 1e-12);
    assert!(scaled.lamp.edge_u.distance(made.lamp.edge_u) < 1e-12);
    assert_eq!((scaled.light.rows(), scaled.light.columns()), (4, 4));
}

#[test]
fn unknown_scenes_are_refused() {
    let error = scene("spnza", Path::new(""), 4, PAPER_LIGHT).unwrap_err();
    assert!(error.to_string().contains("sponza, foliage"), "{error}");
}
