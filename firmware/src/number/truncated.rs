//! Fixed point with truncated instead of rounded products: two instructions less for each, and up to twice
//! the error, always in the same direction.

use fixed::FixedI32;
use fixed::types::extra::LeEqU32;

use super::fixed_point::FixedPoint;

/// A [`fixed::FixedI32`] whose angles and products are the largest numbers of the format that are not above
/// the exact values. Its coefficients are those of the rounded format, and DAC codes are rounded to nearest
/// in both.
#[derive(Clone, Copy, Debug, Default, PartialEq, PartialOrd)]
pub struct Truncated<F>(F);

impl<Frac: LeEqU32 + 'static> FixedPoint for Truncated<FixedI32<Frac>> {
    type Frac = Frac;
    const ZERO: Self = Self(FixedI32::ZERO);
    const TRUNCATES: bool = true;

    #[inline(always)]
    fn of_bits(bits: i32) -> Self {
        Self(FixedI32::from_bits(bits))
    }

    #[inline(always)]
    fn bits(self) -> i32 {
        self.0.to_bits()
    }
}
