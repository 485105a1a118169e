//! Emission: sums of weights against the oracle's masks, sample by sample; shapes; and what is refused.

use umbra4_core::emission::{Emission, EmissionError, Shape, WHOLE};
use umbra4_cpu::{CpuExecutor, ExecutorError};
use umbra4_tests::{
    ledger::say,
    rng::Rng,
    scenes::{EXPONENTS, GENERATORS, SampleGrid},
    weights::{expected, weights},
};

const GRIDS: [(u32, u32); 5] = [(16, 16), (5, 31), (64, 64), (1, 1), (33, 17)];

#[test]
fn sums_are_those_of_the_oracle_s_masks() {
    let executor = CpuExecutor::new().with_threads(2).expect("threads can be started");
    let (mut receivers, mut partial) = (0, 0);
    for (name, generator) in GENERATORS {
        let mut rng = Rng::named(0, &format!("emission {name}"));
        for (round, (rows, columns)) in GRIDS.into_iter().enumerate() {
            let grid = SampleGrid::regular(rows, columns);
            let grid = if round % 2 == 1 { grid.jittered(&mut rng) } else { grid };
            let inputs = generator(&mut rng, grid).inputs(EXPONENTS[round]);
            let weights = weights(&mut rng, inputs.light.sample_count() as usize);
            let emission = Emission::new(rows, columns, &weights[..]).expect("weights are fine");
            let expected = expected(&inputs, &weights);
            let (sums, _) = executor
                .light(&inputs.occluders, &inputs.light, &inputs.receivers, &emission)
                .unwrap_or_else(|error| panic!("{error}"));
            assert_eq!(sums.len(), expected.len(), "{name}");
            for (r, (found, expected)) in sums.iter().zip(&expected).enumerate() {
                assert_eq!(found.map(u64::from), *expected, "{name}, {rows}×{columns}, receiver {r}");
                partial += usize::from(found[1] > 0 && found[1] < emission.total()[1]);
            }
            receivers += expected.len();
        }
    }
    assert!(partial > receivers / 10, "{partial} of {receivers} receivers get a part of the light");
    say(&format!("emission: {receivers} receivers, {partial} get a part of the light, 0 sums differ"));
}

#[test]
fn shapes_hold_what_lies_inside() {
    // A disk of many samples has the area of a disk.
    let disk = Emission::shaped(64, 64, vec![[0; 3]; 4096], Shape::Disk).expect("a disk");
    let share = f64::from(disk.total()[0]) / f64::from(WHOLE) / 4096.0;
    assert!((share - std::f64::consts::FRAC_PI_4).abs() < 0.01, "{share}");
    // A triangle, wound either way, and a star that holds its own middle twice.
    let corners = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]];
    let mut turned = corners;
    turned.reverse();
    for corners in [corners, turned] {
        let half = Emission::shaped(4, 4, vec![[0; 3]; 16], Shape::Polygon(&corners)).expect("a triangle");
        for (row, column) in (0..4).flat_map(|row| (0..4).map(move |column| (row, column))) {
            let inside = row + column < 3;
            assert!(row + column == 3 || half.weight(row, column) == Some([if inside { WHOLE } else { 0 }; 3]));
        }
    }
    let star = [[0.5, 0.0], [0.8, 1.0], [0.0, 0.35], [1.0, 0.35], [0.2, 1.0]];
    assert!(!Shape::Polygon(&star).holds([0.5, 0.5]) && Shape::Polygon(&star).holds([0.5, 0.1]));
    for (row, column) in [(0, 64), (64, 0), (u32::MAX, u32::MAX), (1 << 26, 0)] {
        assert_eq!(disk.weight(row, column), None);
    }
}

#[test]
fn a_texture_is_rounded() {
    let radiance = [[0.0, 1.0, 2.0], [4.0, 0.00001, 3.0]];
    for unit in [1.0, 1e-30, 1e37] {
        let scaled = radiance.map(|sample| sample.map(|value| value * unit));
        let texture = Emission::textured(1, 2, [[7; 3]; 2], &scaled).expect("a texture");
        assert_eq!(texture.weight(0, 0), Some([0, 16384, 32768]));
        assert_eq!(texture.weight(0, 1), Some([WHOLE, 0, 49151]));
        assert_eq!(texture.fraction(texture.total()), [1.0; 3]);
        assert_eq!(texture.fraction([0; 3]), [0.0; 3]);
    }
}

#[test]
fn bad_emissions_are_refused() {
    let room = || vec![[0; 3]; 4];
    let names = |error: &dyn std::error::Error, parts: &[&str]| {
        let text = error.to_string();
        assert!(parts.iter().all(|part| text.contains(part)), "{text}");
    };
    let wrong = Emission::new(2, 3, room()).expect_err("a wrong count");
    assert_eq!(wrong, EmissionError::Count { field: "weights", count: 4, rows: 2, columns: 3 });
    names(&wrong, &["4 weights", "2×3"]);
    assert!(Emission::textured(2, 2, room(), &[[1.0; 3]; 3]).is_err());
    assert!(Emission::textured(2, 2, vec![[0; 3]; 5], &[[1.0; 3]; 4]).is_err());
    for (rows, columns, field) in [(0, 4, "rows"), (2, 65, "columns"), (u32::MAX, 1, "rows")] {
        let error = Emission::new(rows, columns, room()).expect_err("no such light");
        assert!(matches!(error, EmissionError::SampleCount { field: f, .. } if f == field), "{error}");
    }
    for value in [-1.0, f32::NAN, f32::INFINITY, -f32::MIN_POSITIVE] {
        let mut radiance = [[1.0; 3]; 4];
        radiance[2][1] = value;
        let error = Emission::textured(2, 2, room(), &radiance).expect_err("no radiance");
        names(&error, &["row 1", "column 0", "green", &value.to_string()]);
    }
    assert_eq!(Emission::new(2, 2, room()), Err(EmissionError::Dark));
    assert_eq!(Emission::textured(2, 2, room(), &[[0.0; 3]; 4]), Err(EmissionError::Dark));
    assert_eq!(Emission::shaped(2, 2, room(), Shape::Polygon(&[])), Err(EmissionError::Dark));
    for value in [f64::NAN, f64::INFINITY] {
        let corners = [[0.0, 1.0], [1.0, value], [1.0, 0.0]];
        let error = Emission::shaped(2, 2, room(), Shape::Polygon(&corners)).expect_err("not finite");
        names(&error, &["corner 1", &value.to_string()]);
    }

    let mut rng = Rng::named(0, "emission of another light");
    let inputs = GENERATORS[0].1(&mut rng, SampleGrid::regular(4, 8)).inputs(0);
    let emission = Emission::shaped(8, 4, vec![[0; 3]; 32], Shape::Disk).expect("a disk");
    let error = CpuExecutor::new()
        .light(&inputs.occluders, &inputs.light, &inputs.receivers, &emission)
        .expect_err("it is another light's");
    assert_eq!(error, ExecutorError::EmissionSize { emission: [8, 4], light: [4, 8] });
    names(&error, &["8×4", "4×8"]);
}
