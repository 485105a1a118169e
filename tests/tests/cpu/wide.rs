//! Three u32 limbs are `i128` modulo 2^96, operation by operation and in whole determinants.

use proptest::prelude::*;
use umbra4_core::{
    exact::{cross, dot},
    glam::IVec3,
    wide::{Limbs, WideInt},
};
use umbra4_tests::{bigint, budget};

/// Takes an integer modulo 2^96 to `-2^95..2^95`.
fn wrap(x: i128) -> i128 {
    x << 32 >> 32
}

/// The value of limbs, read from how they print: no operation under test is involved.
fn value(limbs: Limbs) -> i128 {
    let text = format!("{limbs:?}");
    let limb = |name: &str| {
        let from = text.find(name).expect("the limb is printed") + name.len() + 2;
        let digits: String = text[from..].chars().take_while(char::is_ascii_digit).collect();
        digits.parse::<u128>().expect("a limb is a number")
    };
    wrap((limb("low") | limb("mid") << 32 | limb("high") << 64) as i128)
}

/// Limbs of any value, with a check that they have it.
fn limbs(x: i128) -> Limbs {
    let mut limbs = Limbs::ZERO;
    for k in (0..6).rev() {
        limbs = limbs.times(1 << 16).plus(Limbs::product((x >> (16 * k) & 0xffff) as i32, 1));
    }
    assert_eq!(value(limbs), wrap(x));
    limbs
}

/// Integers in which carries run: mostly ones, mostly zeros, near powers of two; and any.
fn integer() -> impl Strategy<Value = i128> {
    prop_oneof![
        any::<i128>(),
        (0..96_u32, -2..=2_i128, any::<bool>()).prop_map(|(k, d, minus)| if minus {
            -(1 << k) + d
        } else {
            (1 << k) + d
        }),
        (any::<u128>(), 0..96_u32).prop_map(|(x, k)| (x >> 32 >> k) as i128),
    ]
    .prop_map(wrap)
}

fn factor() -> impl Strategy<Value = i32> {
    prop_oneof![
        any::<i32>(),
        prop::sample::select(vec![0, 1, -1, i32::MAX, i32::MIN, i32::MIN + 1, 0xffff, 0x1_0000, -0x1_0000]),
    ]
}

/// A lattice coordinate, often the outermost.
fn coordinate() -> impl Strategy<Value = i32> {
    const REACH: i32 = (1 << 29) - 1;
    prop_oneof![-REACH..=REACH, prop::sample::select(vec![REACH, -REACH, REACH - 1, 0, 1, -1])]
}

fn point() -> impl Strategy<Value = IVec3> {
    [coordinate(), coordinate(), coordinate()].prop_map(IVec3::from_array)
}

proptest! {
    #![proptest_config(ProptestConfig { cases: budget::of(20_000), failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn operations_agree_modulo_2_96(a in integer(), b in integer(), m in factor(), n in factor()) {
        let (x, y) = (limbs(a), limbs(b));
        prop_assert_eq!(value(x.plus(y)), wrap(a.wrapping_add(b)));
        prop_assert_eq!(value(x.minus(y)), wrap(a.wrapping_sub(b)));
        prop_assert_eq!(value(x.times(m)), wrap(a.wrapping_mul(i128::from(m))));
        prop_assert_eq!(value(Limbs::product(m, n)), i128::from(m) * i128::from(n));
        prop_assert_eq!(<i128 as WideInt>::product(m, n), i128::from(m) * i128::from(n));
        prop_assert_eq!(x.sign(), wrap(a).signum() as i32);
        prop_assert_eq!(x == y, wrap(a) == wrap(b));
        let down = m.rem_euclid(96 + 31) - 31;
        let magnitude = wrap(a).unsigned_abs();
        let bits = (0..96).rev().find(|k| magnitude >> k & 1 == 1).map_or(0, |k| k + 1);
        prop_assert_eq!((x.bits(), WideInt::bits(wrap(a))), (bits, bits));
        // By a division, or a product, that cannot overflow.
        let shifted = if down < 0 { magnitude * (1 << -down) } else { magnitude / (1 << down) };
        let shifted = u32::try_from(shifted).unwrap_or(u32::MAX);
        prop_assert_eq!((x.shifted(down), wrap(a).shifted(down)), (shifted, shifted), "{}", down);
        prop_assert_eq!(value(Limbs::ZERO), 0);
    }

    #[test]
    fn determinants_agree(a in point(), b in point(), c in point(), p in point()) {
        let limbs = dot(cross::<Limbs>(b - a, c - a), p - a);
        let wide = dot(cross::<i128>(b - a, c - a), p - a);
        prop_assert_eq!(value(limbs), wide);
        prop_assert_eq!(limbs.sign(), wide.sign());
        let big = bigint::det3(&bigint::point(b - a), &bigint::point(c - a), &bigint::point(p - a));
        prop_assert_eq!(big.to_string(), wide.to_string());
        // The stated size: 94 bits with the sign.
        prop_assert!(wide.abs() <= 6 << 90);
    }
}

/// The largest determinant there is, found at corners of the lattice: it must not have wrapped.
#[test]
fn the_largest_determinant_fits() {
    const REACH: i32 = (1 << 29) - 1;
    let corner = |k: u32| IVec3::from_array([0, 1, 2].map(|bit| if k >> bit & 1 == 1 { REACH } else { -REACH }));
    let mut largest = 0;
    for index in 0..8_u32.pow(4) {
        let [a, b, c, p] = [0, 1, 2, 3].map(|digit| corner(index >> (3 * digit) & 7));
        let wide = dot(cross::<i128>(b - a, c - a), p - a);
        assert_eq!(value(dot(cross::<Limbs>(b - a, c - a), p - a)), wide);
        largest = largest.max(wide);
    }
    assert_eq!(largest, 2 * (2 * i128::from(REACH)).pow(3), "twice the cube's volume: the regular tetrahedron's");
}
