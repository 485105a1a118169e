//! Lights without extent: what the rule says, lights put where signs are zero, and one property for every executor.

use umbra4_core::{Punctual, glam::IVec3, snap::LIMIT};

use crate::{
    compare::{Amount, Compared, compare_masks},
    oracle::{hit, hit_towards},
    rng::Rng,
    scene::{Inputs, REACH, Scene},
    scenes::{EXPONENTS, GENERATORS, SampleGrid},
};

/// A bit a receiver, from the rule alone.
///
/// # Panics
/// For a light that is neither a point nor a direction, of which there is none.
pub fn oracle(light: Punctual, receivers: &[IVec3], triangles: &[[IVec3; 3]]) -> Vec<u64> {
    let blocks = |p: IVec3, triangle: [IVec3; 3]| match (light.position(), light.towards()) {
        (Some(position), _) => hit(p, position, triangle),
        (_, Some(towards)) => hit_towards(p, towards, triangle),
        _ => panic!("{light:?} is neither a point nor a direction"),
    };
    receivers.iter().map(|&p| u64::from(triangles.iter().any(|&t| blocks(p, t)))).collect()
}

/// Lights where signs are zero: in corners, receivers and planes, along edges and planes, through corners; and anywhere.
fn lights(rng: &mut Rng, scene: &Scene) -> Vec<Punctual> {
    let inside = |p: IVec3| p.clamp(IVec3::splat(-REACH), IVec3::splat(REACH));
    let mut points = vec![scene.light.sample(0, 0), rng.point(REACH), rng.point(REACH / 4)];
    let mut directions = vec![rng.point(LIMIT), IVec3::from_array(rng.pick(&[[1, 0, 0], [0, -1, 0], [0, 0, LIMIT]]))];
    if !scene.receivers.is_empty() {
        points.push(rng.pick(&scene.receivers));
    }
    if !scene.mesh.triangles.is_empty() {
        let corners = rng.pick(&scene.mesh.triangles).map(|vertex| scene.mesh.vertices[vertex as usize]);
        let [a, b, c] = corners;
        points.extend([a, inside(a + (b - a) / 2 + (c - a) / 2), inside(b + b / 2 - a / 2)]);
        directions.extend([b - a, (c - a) / 2 + (b - c) / 2]);
        if !scene.receivers.is_empty() {
            directions.push((c - rng.pick(&scene.receivers)) / 2 * 2);
        }
    }
    let directions = directions.into_iter().map(|d| d.clamp(IVec3::splat(-LIMIT), IVec3::splat(LIMIT)));
    let directions = directions.filter_map(Punctual::direction);
    points.into_iter().filter_map(Punctual::point).chain(directions).collect()
}

/// Compares every bit that `run` finds on `rounds` scenes of the generator called `name`, for many lights each.
///
/// # Panics
/// At the first difference.
pub fn property(name: &str, rounds: usize, run: impl Fn(&Inputs, &Punctual) -> Result<Vec<u16>, String>) -> Compared {
    let (_, generator) = GENERATORS.iter().find(|(n, _)| *n == name).expect("a generator has this name");
    let mut rng = Rng::named(0, &format!("punctual {name}"));
    let mut total = Compared::default();
    for round in 0..rounds {
        let mut scene = generator(&mut rng, SampleGrid::regular(4, 4));
        let lights = lights(&mut rng, &scene);
        // Receivers in the light, and on the edges and corners of its faces.
        for position in lights.iter().filter_map(|light| light.position()) {
            let size = 1 + rng.below(1 << 20) as i32;
            for along in [[0, 0, 0], [1, 1, 1], [-1, 1, 1], [1, 0, -1], [0, 1, 0]] {
                let p = position + IVec3::from_array(along) * size;
                scene.receivers.push(p.clamp(IVec3::splat(-REACH), IVec3::splat(REACH)));
            }
        }
        let inputs = scene.inputs(EXPONENTS[round % EXPONENTS.len()]);
        let triangles = inputs.triangles();
        for light in lights {
            let expected = oracle(light, inputs.receivers.points(), &triangles);
            let compared = run(&inputs, &light)
                .and_then(|bits| compare_masks(&expected, &bits, 1, 1, Amount::Some).map_err(|e| e.to_string()))
                .unwrap_or_else(|error| panic!("{name}, scene {round}, {light:?}: {error}"));
            total.bits += compared.bits;
            total.blocked += compared.blocked;
        }
    }
    // A generator whose lights are never, or always, blocked would test nothing.
    assert!(total.blocked > 0 && total.blocked < total.bits, "{name}: {total:?}");
    total
}
