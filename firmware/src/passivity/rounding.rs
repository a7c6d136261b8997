//! Sums, products and quotients of doubles rounded downward and upward, usable in `const fn`.
//!
//! The processor rounds to nearest; if the result is not exact, the next double outward is used. The required
//! properties of a number are read from its bits: emulated doubles are compared by a call and integers are
//! not, and every call costs time in the evaluation of a constant.

/// All bits of a double except its sign.
const MAGNITUDE: u64 = u64::MAX >> 1;
const SIGN: u64 = !MAGNITUDE;
/// The bits of the exponent, which are those of infinity; NaNs are above.
const EXPONENT: u64 = f64::INFINITY.to_bits();
/// The implicit first bit of a normal number's mantissa.
const IMPLICIT: u64 = 1 << 52;

/// Lower bound of a sum; minus infinity for NaN.
#[cfg_attr(target_os = "none", inline(never))]
pub(super) const fn add_down(a: f64, b: f64) -> f64 {
    let sum = a + b;
    let (a, b) = (a.to_bits(), b.to_bits());
    // Without a branch, which would not be predictable.
    let swapped = (a ^ b) & ((a & MAGNITUDE < b & MAGNITUDE) as u64).wrapping_neg();
    let (large, small) = (f64::from_bits(a ^ swapped), f64::from_bits(b ^ swapped));
    // Dekker's two-sum: the part of the smaller summand in the sum, exact for finite numbers. For an infinite
    // sum it is NaN, or so large that the step outward is made.
    if small >= sum - large { sum } else { below(sum) }
}

/// Lower bound of a product; zero times anything is zero.
#[cfg_attr(target_os = "none", inline(never))]
pub(super) const fn mul_down(a: f64, b: f64) -> f64 {
    if is_zero(a) || is_zero(b) {
        return 0.0;
    }
    let product = a * b;
    if fits_a_mantissa(a, b) && is_normal(product.to_bits()) { product } else { below(product) }
}

/// Upper bound of a product.
#[cfg_attr(target_os = "none", inline(never))]
pub(super) const fn mul_up(a: f64, b: f64) -> f64 {
    -mul_down(-a, b)
}

/// Lower bound of a quotient; `b > 0`.
#[cfg_attr(target_os = "none", inline(never))]
pub(super) const fn div_down(a: f64, b: f64) -> f64 {
    if is_zero(a) {
        return 0.0;
    }
    let quotient = a / b;
    let is_exact = fits_a_mantissa(quotient, b) && is_normal(a.to_bits()) && quotient * b == a;
    if is_exact { quotient } else { below(quotient) }
}

/// Upper bound of a quotient; `b > 0`.
#[cfg_attr(target_os = "none", inline(never))]
pub(super) const fn div_up(a: f64, b: f64) -> f64 {
    -div_down(-a, b)
}

/// Lower bound of a half.
pub(super) const fn half_down(value: f64) -> f64 {
    let half = value * 0.5;
    if is_normal(half.to_bits()) || half + half == value { half } else { below(half) }
}

pub(super) const fn is_zero(value: f64) -> bool {
    let bits = value.to_bits();
    // In one piece, the compiler would replace it by a comparison of doubles, which is a call on a board.
    if cfg!(target_os = "none") { is_zero_by_halves(bits) } else { bits & MAGNITUDE == 0 }
}

const fn is_zero_by_halves(bits: u64) -> bool {
    ((bits >> 32) as u32 & (u32::MAX >> 1)) | bits as u32 == 0
}

pub(super) const fn is_not_negative(value: f64) -> bool {
    value.to_bits() <= 1 << 63
}

/// The next double below; minus infinity if there is none, or if the value is NaN.
const fn below(value: f64) -> f64 {
    let bits = value.to_bits();
    let magnitude = bits & MAGNITUDE;
    if magnitude == 0 {
        -f64::from_bits(1)
    } else if magnitude > EXPONENT || bits == EXPONENT | SIGN {
        f64::NEG_INFINITY
    } else {
        // The bits less one, or for a negative number plus one; without a branch, which would not be
        // predictable.
        f64::from_bits((bits - 1) + (bits >> 63 << 1))
    }
}

/// Whether these are the bits of a number that is neither zero nor subnormal nor infinite.
const fn is_normal(bits: u64) -> bool {
    let exponent = bits & EXPONENT;
    exponent != 0 && exponent != EXPONENT
}

/// Whether the product of two numbers is exact, as long as it is a normal number: the significant
/// bits of the factors fit a mantissa together.
const fn fits_a_mantissa(a: f64, b: f64) -> bool {
    let (a, b) = (a.to_bits(), b.to_bits());
    // The number of mantissa bits, of 53, after the last set bit.
    let behind = (a | IMPLICIT).trailing_zeros() + (b | IMPLICIT).trailing_zeros();
    behind >= 53 && is_normal(a) && is_normal(b)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Where one kind of double meets the next, of both signs.
    const BORDERS: [f64; 9] = [
        0.0,
        f64::from_bits(1),
        f64::from_bits(IMPLICIT - 1),
        f64::MIN_POSITIVE,
        1.0,
        1.0 + f64::EPSILON,
        std::f64::consts::PI,
        f64::MAX,
        f64::INFINITY,
    ];

    #[test]
    fn bits_tell_what_the_library_does() {
        for value in BORDERS.into_iter().flat_map(|value| [value, -value]) {
            assert_eq!(below(value), value.next_down(), "{value:e}");
            assert_eq!(is_normal(value.to_bits()), value.is_normal(), "{value:e}");
            assert_eq!(is_not_negative(value), value >= 0.0, "{value:e}");
            assert_eq!(is_zero(value), value == 0.0, "{value:e}");
            assert_eq!(is_zero_by_halves(value.to_bits()), value == 0.0, "{value:e}");
        }
        for value in [f64::NAN, -f64::NAN] {
            assert_eq!(below(value), f64::NEG_INFINITY);
            assert!(!is_normal(value.to_bits()) && !is_zero(value));
        }
    }

    /// Overflow and subnormal numbers: no bound inside of the exact result.
    #[test]
    fn bounds_at_the_ends_of_the_range_are_outward() {
        assert_eq!(add_down(f64::MAX, f64::MAX), f64::MAX);
        assert_eq!(add_down(f64::INFINITY, f64::NEG_INFINITY), f64::NEG_INFINITY);
        assert_eq!(mul_down(-f64::MAX, 2.0), f64::NEG_INFINITY);
        assert_eq!(mul_down(f64::MAX, 2.0), f64::MAX);
        assert_eq!(mul_up(f64::MAX, 2.0), f64::INFINITY);
        let least = f64::from_bits(1);
        assert!(mul_down(least, 0.5) <= 0.0 && mul_up(least, 0.5) >= least);
        assert!(half_down(least) <= 0.0 && half_down(-least) <= -least);
        assert!(div_down(least, 2.0) <= 0.0 && div_up(least, 2.0) >= least);
        assert_eq!(div_down(1.0, f64::INFINITY), 0.0f64.next_down());
    }

    #[test]
    fn what_is_exact_stays() {
        assert_eq!((mul_down(1.5, -2.25), mul_up(1.5, -2.25)), (-3.375, -3.375));
        assert_eq!((div_down(6.0, 3.0), div_up(6.0, 3.0)), (2.0, 2.0));
        assert!(div_down(1.0, 3.0) < div_up(1.0, 3.0));
        assert_eq!((mul_down(0.0, f64::INFINITY), div_down(0.0, 3.0)), (0.0, 0.0));
    }
}
