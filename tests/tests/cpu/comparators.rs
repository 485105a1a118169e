//! The comparators can fail: a perturbed bit, a wrong length, NaN, nothing at all.

use umbra4_core::PairWord;
use umbra4_tests::{
    compare::{Amount, Compared, Mismatch, bits_of, compare_light, compare_masks, compare_visibility, lit_counts},
    filtered::{Agreement, Disagreement, SHARE, TOLERANCE, agree},
    hard_cases::Check,
    ledger::Ledger,
    scene::Inputs,
    suite::{Subject, Visibility, check, minimise},
};

const EXPECTED: [u64; 6] = [0b001, 0b111, 0b000, 0b101, 0b110, 0b011];

#[test]
fn equal_masks_are_counted() {
    let got = EXPECTED.map(|w| w as u16);
    assert_eq!(compare_masks(&EXPECTED, &got, 2, 3, Amount::Some), Ok(Compared { bits: 18, blocked: 10 }));
}

#[test]
fn every_perturbed_bit_is_found_where_it_is() {
    for index in 0..6 {
        for column in 0..3 {
            let mut got = EXPECTED.map(|w| w as u32);
            got[index] ^= 1 << column;
            let expected = EXPECTED[index] >> column & 1 == 1;
            assert_eq!(
                compare_masks(&EXPECTED, &got, 2, 3, Amount::Some),
                Err(Mismatch::Bit {
                    receiver: index / 2,
                    row: index % 2,
                    column,
                    expected,
                    got: !expected,
                    differing: 1,
                    receivers: 1,
                    bits: 18
                })
            );
        }
    }
}

#[test]
fn differences_are_counted() {
    let mut got = EXPECTED;
    got[0] ^= 0b110;
    got[1] ^= 0b001;
    got[5] ^= 0b100;
    let error = compare_masks(&EXPECTED, &got, 2, 3, Amount::Some).expect_err("four bits differ");
    assert!(
        matches!(error, Mismatch::Bit { receiver: 0, row: 0, column: 1, differing: 4, receivers: 2, .. }),
        "{error}"
    );
}

#[test]
fn lengths_must_match() {
    let got = EXPECTED.map(|w| w as u16);
    assert_eq!(compare_masks(&EXPECTED, &got[..4], 2, 3, Amount::Some), Err(Mismatch::Length { expected: 6, got: 4 }));
    assert_eq!(compare_masks(&EXPECTED[..4], &got, 2, 3, Amount::Some), Err(Mismatch::Length { expected: 4, got: 6 }));
    assert_eq!(compare_masks::<u16>(&EXPECTED, &[], 2, 3, Amount::Some), Err(Mismatch::Length { expected: 6, got: 0 }));
    assert_eq!(compare_masks(&[], &got, 2, 3, Amount::Some), Err(Mismatch::Length { expected: 0, got: 6 }));
    // Not a whole number of receivers.
    assert!(matches!(compare_masks(&EXPECTED, &got, 4, 3, Amount::Some), Err(Mismatch::Length { .. })));
    assert!(matches!(compare_masks(&EXPECTED, &got, 0, 3, Amount::Some), Err(Mismatch::Length { .. })));
}

#[test]
fn nothing_is_a_failure_unless_expected() {
    assert_eq!(compare_masks::<u64>(&[], &[], 2, 3, Amount::Some), Err(Mismatch::Empty));
    assert_eq!(compare_masks::<u64>(&[], &[], 2, 3, Amount::None), Ok(Compared::default()));
    assert_eq!(compare_masks::<u64>(&[], &[0], 2, 3, Amount::None), Err(Mismatch::NotEmpty { got: 1 }));
    assert_eq!(compare_masks::<u64>(&[0, 0], &[], 2, 3, Amount::None), Err(Mismatch::Length { expected: 2, got: 0 }));
    assert_eq!(compare_visibility(&[], &[], 9, Amount::Some), Err(Mismatch::Empty));
    assert_eq!(compare_visibility(&[], &[], 9, Amount::None), Ok(()));
    assert_eq!(compare_visibility(&[], &[1.0], 9, Amount::None), Err(Mismatch::NotEmpty { got: 1 }));
}

#[test]
fn stray_bits_are_found_even_where_both_have_them() {
    let stray = [0b1000_u64, 0];
    let error = Mismatch::Stray { receiver: 0, row: 0, word: 8, columns: 3 };
    assert_eq!(compare_masks(&[0, 0], &stray, 2, 3, Amount::Some), Err(error.clone()));
    assert_eq!(compare_masks(&stray, &[0_u16, 0], 2, 3, Amount::Some), Err(error.clone()));
    assert_eq!(compare_masks(&stray, &stray, 2, 3, Amount::Some), Err(error));
}

#[test]
fn words_of_every_width_have_the_same_bits() {
    assert_eq!(bits_of(0x8001_u16), 0x8001);
    assert_eq!(bits_of(0x8000_0001_u32), 0x8000_0001);
    assert_eq!(bits_of(0x8000_0000_0000_0001_u64), 0x8000_0000_0000_0001);
    assert_eq!(bits_of(PairWord { low: 1, high: 0x8000_0000 }), 0x8000_0000_0000_0001);
}

#[test]
fn visibilities_must_be_the_fraction_that_is_lit() {
    let lit = [0, 3, 6];
    assert_eq!(compare_visibility(&lit, &[0.0, 0.5, 1.0], 6, Amount::Some), Ok(()));
    assert_eq!(compare_visibility(&lit, &[0.0, 0.5], 6, Amount::Some), Err(Mismatch::Length { expected: 3, got: 2 }));
    let nan = compare_visibility(&lit, &[0.0, f32::NAN, 1.0], 6, Amount::Some);
    assert_eq!(nan, Err(Mismatch::NotANumber { receiver: 1 }));
    // One sample of the largest light, infinity, and ends that are almost exact.
    for wrong in [0.5 + 1.0 / 4096.0, f32::INFINITY, 0.0, 1.0, -0.5] {
        let error = compare_visibility(&lit, &[0.0, wrong, 1.0], 6, Amount::Some);
        assert_eq!(error, Err(Mismatch::Visibility { receiver: 1, lit: 3, samples: 6, got: wrong }));
    }
    assert!(compare_visibility(&lit, &[1.0e-9, 0.5, 1.0], 6, Amount::Some).is_err());
    assert!(compare_visibility(&lit, &[0.0, 0.5, 1.0 - f32::EPSILON / 2.0], 6, Amount::Some).is_err());
}

#[test]
fn every_channel_of_light_is_compared() {
    let expected = [[1, 2, 3], [0; 3], [1 << 28, 5, 0]];
    assert_eq!(compare_light(&expected, &expected, Amount::Some), Ok(()));
    for (receiver, channel, by) in [(0, 0, 1), (1, 1, 1), (2, 2, u32::MAX), (2, 0, 1 << 31)] {
        let mut got = expected;
        got[receiver][channel] ^= by;
        let error = Mismatch::Light { receiver, expected: expected[receiver], got: got[receiver], differing: 1 };
        assert_eq!(compare_light(&expected, &got, Amount::Some), Err(error));
    }
    let all = compare_light(&expected, &[[9; 3]; 3], Amount::Some).expect_err("all differ");
    assert!(matches!(all, Mismatch::Light { receiver: 0, differing: 3, .. }), "{all}");
    assert_eq!(compare_light(&expected, &expected[..2], Amount::Some), Err(Mismatch::Length { expected: 3, got: 2 }));
    assert_eq!(compare_light(&[], &[], Amount::Some), Err(Mismatch::Empty));
    assert_eq!(compare_light(&[], &expected, Amount::None), Err(Mismatch::NotEmpty { got: 3 }));
}

#[test]
fn lit_samples_are_counted() {
    assert_eq!(lit_counts(&EXPECTED, 2, 3), [2, 4, 2]);
}

#[test]
fn checks_can_fail() {
    let cases = umbra4_tests::hard_cases::HARD_CASES.iter().flat_map(|(_, build)| build(5, 15));
    let mut kinds = [0; 6];
    for case in cases {
        let masks = case.inputs.oracle();
        let light = &case.inputs.light;
        let inverted: Vec<u64> = masks.iter().map(|w| !w & (u64::MAX >> (64 - light.columns))).collect();
        let wrong = match &case.check {
            Check::Lit => [inverted, vec![]],
            Check::Blocked => [inverted, vec![]],
            Check::Mixed => [vec![0; masks.len()], vec![u64::MAX >> (64 - light.columns); masks.len()]],
            Check::Masks(_) => [inverted, vec![]],
            Check::BlockedAt(_) => [inverted, vec![0; masks.len()]],
            Check::NoMasks => [vec![0], vec![1]],
        };
        kinds[match case.check {
            Check::Lit => 0,
            Check::Blocked => 1,
            Check::Mixed => 2,
            Check::Masks(_) => 3,
            Check::BlockedAt(_) => 4,
            Check::NoMasks => 5,
        }] += 1;
        for wrong in wrong {
            assert!(case.check.holds(&wrong, light).is_err(), "{:?} holds for {wrong:x?}", case.check);
        }
    }
    assert!(kinds.iter().all(|&n| n > 0), "every kind of check occurs: {kinds:?}");
}

/// An executor that is wrong in one bit of one receiver, wherever that receiver is blocked at all.
struct Wrong;

impl Subject for Wrong {
    fn name(&self) -> String {
        "wrong in one bit".into()
    }

    fn masks<W: umbra4_cpu::CpuWord>(&self, inputs: &Inputs) -> Result<Vec<W>, String> {
        let spans = |word: u64| {
            (0..inputs.light.columns).filter(|j| word >> j & 1 == 1).fold(W::EMPTY, |w, j| w.or(W::span(j, j + 1)))
        };
        let mut masks: Vec<W> = inputs.oracle().into_iter().map(spans).collect();
        if let Some(word) = masks.iter_mut().find(|w| **w != W::EMPTY) {
            *word = word.without(W::span(word.lowest(), word.lowest() + 1));
        }
        Ok(masks)
    }

    fn visibility(&self, inputs: &Inputs) -> Result<Vec<f32>, String> {
        Ok(vec![f32::NAN; inputs.receivers.len()])
    }
}

fn mixed_scene() -> Inputs {
    let (_, soup) = umbra4_tests::scenes::GENERATORS[0];
    let mut rng = umbra4_tests::rng::Rng::named(0, "a wrong executor");
    loop {
        let inputs = soup(&mut rng, umbra4_tests::scenes::SampleGrid::regular(8, 16)).inputs(0);
        if inputs.oracle().iter().any(|&w| w != 0) && inputs.occluders.triangles().len() > 10 {
            return inputs;
        }
    }
}

#[test]
fn the_suite_finds_a_wrong_bit_and_the_smallest_scene_that_shows_it() {
    let inputs = mixed_scene();
    let error = check::<u16>(&Wrong, &inputs, Visibility::Left).expect_err("a bit is wrong");
    assert!(error.contains("1 of"), "{error}");
    let smallest = minimise::<u16>(&Wrong, &inputs);
    assert_eq!(smallest.receivers.len(), 1);
    assert!(smallest.mesh.triangles.len() <= 1, "{smallest:?}");
}

#[test]
#[should_panic(expected = "smallest scene that fails")]
fn a_property_fails_for_a_wrong_executor() {
    umbra4_tests::suite::property::<u32>(&Wrong, "u32", "soup", 1000, &Ledger::new(2, 1));
}

#[test]
#[should_panic(expected = "smallest scene that fails")]
fn the_hard_cases_fail_for_a_wrong_executor() {
    umbra4_tests::suite::hard_cases::<u64>(&Wrong, "u64", 1, &Ledger::new(2, 1));
}

#[test]
#[should_panic(expected = "only 10 bits were compared")]
fn a_suite_that_compares_too_little_fails() {
    Ledger::new(1, 11).enter("nobody", Compared { bits: 10, blocked: 5 });
}

#[test]
fn filtered_visibility_that_disagrees_is_noticed() {
    let expected: Vec<f32> = (0..1000).map(|k| k as f32 / 1000.0).collect();
    let same = agree(&expected, &expected, 0.0).expect("the same");
    assert_eq!(same, Agreement { receivers: 1000, ..Agreement::default() });
    let moved = |count: usize, by: f32| {
        let mut got = expected.clone();
        got.iter_mut().take(count).for_each(|v| *v += by);
        got
    };
    // Within the tolerance, all may differ.
    let near = agree(&expected, &moved(1000, TOLERANCE * 0.2), 0.0).expect("near");
    assert!(near.differing == 1000 && near.beyond == 0 && near.largest > 0.0);
    // Beyond it, as many as the share allows.
    assert!(agree(&expected, &moved(1, 0.1), 0.0).is_err());
    assert_eq!(agree(&expected, &moved(2, 0.1), SHARE).map(|a| a.beyond), Ok(2));
    assert!(matches!(agree(&expected, &moved(3, 0.1), SHARE), Err(Disagreement::Beyond(a)) if a.beyond == 3));
    assert_eq!(agree(&expected, &expected[1..], 1.0), Err(Disagreement::Length { expected: 1000, got: 999 }));
    assert_eq!(agree(&[], &[], 1.0), Err(Disagreement::Empty));
    for wrong in [f32::NAN, f32::INFINITY, -0.1, 1.1] {
        let mut got = expected.clone();
        got[7] = wrong;
        assert!(matches!(agree(&expected, &got, 1.0), Err(Disagreement::NoFraction { receiver: 7, .. })));
        assert!(matches!(agree(&got, &expected, 1.0), Err(Disagreement::NoFraction { receiver: 7, .. })));
    }
}
