//! Numbers without rounding: decimal text and `f64` as rationals.

use num_bigint::BigInt;
use num_rational::BigRational;
use num_traits::One;

/// An exact rational number.
pub type Q = BigRational;

/// The rational that a finite `f64` is, bit for bit; `None` for NaN and infinities.
pub fn of_f64(x: f64) -> Option<Q> {
    BigRational::from_float(x)
}

/// The same of a number that is known to be finite.
///
/// # Panics
/// If it is not.
pub fn q(x: f64) -> Q {
    of_f64(x).expect("a finite number")
}

/// The rational that a decimal such as `-0.0220` or `1e-9` is; `None` if it is not one.
pub fn of_decimal(text: &str) -> Option<Q> {
    let (mantissa, exponent) = match text.split_once(['e', 'E']) {
        Some((m, e)) => (m, e.parse::<i32>().ok()?),
        None => (text, 0),
    };
    let (whole, fraction) = mantissa.split_once('.').unwrap_or((mantissa, ""));
    let digits: BigInt = format!("{whole}{fraction}").parse().ok()?;
    Some(Q::from_integer(digits) * power_of_ten(exponent - i32::try_from(fraction.len()).ok()?))
}

/// `numerator / denominator`.
pub fn ratio(numerator: i64, denominator: i64) -> Q {
    Q::new(numerator.into(), denominator.into())
}

/// `10^n`, also for negative `n`.
pub fn power_of_ten(n: i32) -> Q {
    let magnitude = Q::from_integer(BigInt::from(10).pow(n.unsigned_abs()));
    if n < 0 { Q::one() / magnitude } else { magnitude }
}
