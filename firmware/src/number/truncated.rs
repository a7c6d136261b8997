//! Fixed point with truncated instead of rounded products: two instructions less for each, and up to twice
//! the error, always in the same direction.

use fixed::FixedI32;
use fixed::types::extra::LeEqU32;

use super::{Format, Number, OutOfRange, Scaled};

/// A [`fixed::FixedI32`] whose angles and products are the largest numbers of the format that are not above
/// the exact values. Its coefficients are those of the rounded format, and DAC codes are rounded to nearest
/// in both.
#[derive(Clone, Copy, Debug, PartialEq, PartialOrd)]
pub struct Truncated<F>(F);

impl<Frac: LeEqU32 + 'static> Number for Truncated<FixedI32<Frac>> {
    type Coefficient = Scaled;
    const FORMAT: Format = Format::Truncated { fraction_bits: Frac::U32 };
    const ZERO: Self = Self(FixedI32::ZERO);

    fn from_f64(value: f64) -> Result<Self, OutOfRange> {
        let nearest = FixedI32::from_f64(value);
        let out_of_range = |error| OutOfRange { format: Self::FORMAT, ..error };
        let nearest: FixedI32<Frac> = nearest.map_err(out_of_range)?;
        let above = Number::to_f64(nearest) > value;
        Ok(Self(if above { nearest.saturating_sub(FixedI32::DELTA) } else { nearest }))
    }

    fn bound_from_f64(value: f64) -> Result<Self, OutOfRange> {
        Self::from_f64(value)
    }

    fn to_f64(self) -> f64 {
        Number::to_f64(self.0)
    }

    fn coefficient(value: f64) -> Result<Scaled, OutOfRange> {
        Scaled::new(value, Self::FORMAT)
    }

    fn coefficient_to_f64(coefficient: Scaled) -> f64 {
        coefficient.to_f64()
    }

    #[inline(always)]
    fn plus(self, other: Self) -> Self {
        Self(self.0.plus(other.0))
    }

    #[inline(always)]
    fn minus(self, other: Self) -> Self {
        Self(Number::minus(self.0, other.0))
    }

    #[inline(always)]
    fn times(self, coefficient: Scaled) -> Self {
        Self(FixedI32::from_bits(coefficient.scale_down(self.0.to_bits()).0))
    }

    #[inline(always)]
    fn negated(self) -> Self {
        Self(self.0.negated())
    }

    #[inline(always)]
    fn within(self, bound: Self) -> bool {
        self.0.within(bound.0)
    }

    #[inline(always)]
    fn is_from_zero_to(self, bound: Self) -> bool {
        self.0.is_from_zero_to(bound.0)
    }

    #[inline(always)]
    fn positive_part(self) -> Self {
        Self(self.0.positive_part())
    }

    fn angle_scale(radians_per_count: f64) -> Result<Scaled, OutOfRange> {
        let out_of_range = |error| OutOfRange { format: Self::FORMAT, ..error };
        FixedI32::<Frac>::angle_scale(radians_per_count).map_err(out_of_range)
    }

    #[inline(always)]
    fn angle(count: i32, scale: Scaled) -> (Self, bool) {
        let (bits, fits) = scale.scale_down(count);
        (Self(FixedI32::from_bits(bits)), fits)
    }

    fn parts_scale(parts_per_rad: f64) -> Result<Scaled, OutOfRange> {
        let out_of_range = |error| OutOfRange { format: Self::FORMAT, ..error };
        FixedI32::<Frac>::parts_scale(parts_per_rad).map_err(out_of_range)
    }

    #[inline(always)]
    fn parts(self, scale: Scaled) -> i32 {
        scale.scale_down(self.0.to_bits()).0
    }

    fn part_scale(torque: f64) -> Result<Scaled, OutOfRange> {
        let out_of_range = |error| OutOfRange { format: Self::FORMAT, ..error };
        FixedI32::<Frac>::part_scale(torque).map_err(out_of_range)
    }

    #[inline(always)]
    fn of_parts(parts: i32, scale: Scaled) -> Self {
        Self(FixedI32::from_bits(scale.scale_down(parts).0))
    }

    fn code_scale(codes_per_torque: f64) -> Result<Scaled, OutOfRange> {
        let out_of_range = |error| OutOfRange { format: Self::FORMAT, ..error };
        FixedI32::<Frac>::code_scale(codes_per_torque).map_err(out_of_range)
    }

    #[inline(always)]
    fn codes_below(self, centre: u16, scale: Scaled) -> u16 {
        self.0.codes_below(centre, scale)
    }
}
