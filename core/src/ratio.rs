//! A fraction of two counts as the bits of a pixel, in integers: the same bits on every processor, whatever its division does.

/// The largest denominator of all formats: counts up to it are exact in f32.
pub const MOST_WHOLE: u32 = 1 << 24;

/// What denominators of floats are below.
pub const MOST_FLOAT: u32 = 1 << 31;

/// The binary digits of `part / whole`, `0 < part < whole <` [`MOST_FLOAT`], rounded to the nearest float, halves to even: of a float with
/// `digits` digits, its leading one included, whose normal numbers begin at `2^least`.
#[inline(always)]
fn float(part: u32, whole: u32, digits: u32, least: i32) -> u32 {
    let (mut rest, mut exponent) = (part, 0);
    while rest < whole {
        rest <<= 1;
        exponent -= 1;
    }
    // Below the normal numbers digits are fewer.
    let missing = if exponent < least { least - exponent } else { 0 };
    rest -= whole;
    if missing >= digits as i32 {
        // Half of the least float rounds to even, 0; above it lies 1, below it 0.
        return (missing == digits as i32 && rest > 0) as u32;
    }
    let (mut quotient, mut k) = (1, 1);
    while k < digits as i32 - missing {
        rest <<= 1;
        let digit = (rest >= whole) as u32;
        rest -= digit * whole;
        quotient = quotient << 1 | digit;
        k += 1;
    }
    let twice = rest << 1;
    quotient += (twice > whole || (twice == whole && quotient & 1 == 1)) as u32;
    if missing > 0 {
        return quotient;
    }
    // The leading digit, and what rounding may carry, adds 1 to the exponent.
    (((exponent - least) as u32) << (digits - 1)) + quotient
}

/// `part / whole` in IEEE single precision. Nothing of nothing is 0.
#[inline(always)]
pub fn float32(part: u32, whole: u32) -> u32 {
    if part == 0 {
        0
    } else if part >= whole {
        0x3f80_0000
    } else {
        float(part, whole, 24, -126)
    }
}

/// `part / whole` in IEEE half precision.
#[inline(always)]
pub fn float16(part: u32, whole: u32) -> u32 {
    if part == 0 {
        0
    } else if part >= whole {
        0x3c00
    } else {
        float(part, whole, 11, -14)
    }
}

/// `part / whole` in parts of 255, halves up.
#[inline(always)]
pub fn unorm8(part: u32, whole: u32) -> u32 {
    if part >= whole {
        return if part == 0 { 0 } else { 255 };
    }
    // At most 255·2^24.
    let (quotient, rest) = (part * 255 / whole, part * 255 % whole);
    quotient + (rest >= whole - rest) as u32
}
