//! 32-bit fixed point: saturating, rounded to nearest, with coefficients that keep 31 bits.

use core::fmt;
use core::hint::cold_path;

use fixed::FixedI32;
use fixed::types::extra::{LeEqU32, Unsigned};

use super::{Format, Number, OutOfRange, Rounding, bounded};

/// Largest magnitude of a coefficient.
pub(super) const LARGEST: f64 = i32::MAX as f64;

/// A coefficient of the fixed-point formats: `mantissa / 2^shift`.
///
/// Each coefficient has its own binary point. In the format of the angles and torques the paper's coupling
/// compliance 1/44 would have a relative error of 3e-4, and the encoder's step of 1e-4 rad of a third
/// (theory, section 9). Here the relative error of a coefficient is at most 2^-32, so that the error of the
/// product with the largest number is half a step of the format, at the same cost in the tick.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Scaled {
    mantissa: i32,
    shift: u32,
}

impl Scaled {
    /// Largest shift: below the width of a register, where a 64-bit shift takes four instructions
    /// in place of eight.
    const LARGEST_SHIFT: u32 = 31;

    /// The nearest coefficient to `value`; an error from 2^31 on. Not inlined: it runs once per coefficient
    /// and never in a tick.
    #[inline(never)]
    pub(super) fn new(value: f64, format: Format) -> Result<Self, OutOfRange> {
        bounded(value, LARGEST, format).map(|value| Self::of(value, Rounding::Nearest))
    }

    /// The nearest coefficient to `value` that is not farther from zero.
    fn inward(value: f64, format: Format) -> Result<Self, OutOfRange> {
        bounded(value, LARGEST, format).map(|value| Self::of(value, Rounding::Inward))
    }

    /// Rounds a value of magnitude up to [`LARGEST`]. The binary point only depends on the value's power of
    /// two, so rounding never reverses the order of two values.
    pub(super) const fn of(value: f64, rounding: Rounding) -> Self {
        let magnitude = value.abs();
        let exponent = (magnitude.to_bits() >> 52) as i32 - 1023;
        let mut shift = if exponent < 0 { Self::LARGEST_SHIFT } else { (30 - exponent) as u32 };
        // Both the product and its fractional part are exact.
        let scaled = magnitude * (1_u32 << shift) as f64;
        let whole = scaled as u32;
        let rest = scaled - whole as f64;
        let up = match rounding {
            Rounding::Nearest => rest >= 0.5,
            Rounding::Inward => false,
            Rounding::Outward => rest > 0.0,
        };
        let mut mantissa = whole + up as u32;
        if mantissa > i32::MAX as u32 {
            // Rounded up to the next power of two.
            (mantissa, shift) = (mantissa >> 1, shift - 1);
        }
        let mantissa = mantissa as i32;
        Self { mantissa: if value < 0.0 { -mantissa } else { mantissa }, shift }
    }

    /// The exact value.
    pub(super) const fn to_f64(self) -> f64 {
        self.mantissa as f64 / (1_u32 << self.shift) as f64
    }

    /// `bits * self` rounded to nearest: the nearest `i32`, and whether it is that of the product.
    #[inline(always)]
    pub(super) fn scale(self, bits: i32) -> (i32, bool) {
        let product = i64::from(bits) * i64::from(self.mantissa);
        let shift = self.shift & Self::LARGEST_SHIFT;
        let half = i64::from((1_u32 << shift) >> 1);
        // At most 2^62 + 2^30: no overflow.
        nearest(product.wrapping_add(half) >> shift)
    }

    /// `bits * self` truncated: the nearest `i32` to the largest whole number that is not above the product,
    /// and whether they are equal.
    #[inline(always)]
    pub(super) fn scale_down(self, bits: i32) -> (i32, bool) {
        let product = i64::from(bits) * i64::from(self.mantissa);
        nearest(product >> (self.shift & Self::LARGEST_SHIFT))
    }
}

/// The nearest `i32`, and whether it is the value itself.
#[inline(always)]
fn nearest(value: i64) -> (i32, bool) {
    let (high, low) = ((value >> 32) as i32, value as i32);
    if high == low >> 31 {
        return (low, true);
    }
    cold_path();
    (if high < 0 { i32::MIN } else { i32::MAX }, false)
}

/// A number of 32 bits in two's complement.
pub trait FixedPoint: Copy + Default + PartialOrd + fmt::Debug + 'static {
    /// The number of its fractional bits.
    type Frac: LeEqU32;
    /// Zero.
    const ZERO: Self;
    /// Whether numbers are the largest of the format that are not above the exact values, in place of the
    /// nearest.
    const TRUNCATES: bool;
    /// The number of these bits.
    fn of_bits(bits: i32) -> Self;
    /// Its bits.
    fn bits(self) -> i32;
}

impl<Frac: LeEqU32 + 'static> FixedPoint for FixedI32<Frac> {
    type Frac = Frac;
    const ZERO: Self = Self::ZERO;
    const TRUNCATES: bool = false;

    #[inline(always)]
    fn of_bits(bits: i32) -> Self {
        Self::from_bits(bits)
    }

    #[inline(always)]
    fn bits(self) -> i32 {
        self.to_bits()
    }
}

const fn format<F: FixedPoint>() -> Format {
    let fraction_bits = F::Frac::U32;
    if F::TRUNCATES { Format::Truncated { fraction_bits } } else { Format::Fixed { fraction_bits } }
}

/// A step of a format in rad or N m.
fn step<F: FixedPoint>() -> f64 {
    FixedI32::<F::Frac>::DELTA.to_num()
}

/// `bits * scale` as the format rounds products: the nearest `i32`, and whether it is that of the product.
#[inline(always)]
fn product<F: FixedPoint>(bits: i32, scale: Scaled) -> (i32, bool) {
    if F::TRUNCATES { scale.scale_down(bits) } else { scale.scale(bits) }
}

/// The number of a value, the nearest or the one below it.
fn rounded<F: FixedPoint>(value: f64, is_down: bool) -> Result<F, OutOfRange> {
    type Nearest<F> = FixedI32<<F as FixedPoint>::Frac>;
    let bound = Nearest::<F>::MAX.to_num();
    let out_of_range = OutOfRange { value, bound, format: format::<F>() };
    let nearest = Nearest::<F>::checked_from_num(value).ok_or(out_of_range)?;
    let is_above = is_down && nearest.to_num::<f64>() > value;
    Ok(F::of_bits(nearest.to_bits().saturating_sub(is_above.into())))
}

impl<F: FixedPoint> Number for F {
    type Coefficient = Scaled;
    const FORMAT: Format = format::<F>();
    const ZERO: Self = <F as FixedPoint>::ZERO;

    fn from_f64(value: f64) -> Result<Self, OutOfRange> {
        rounded(value, F::TRUNCATES)
    }

    fn bound_from_f64(value: f64) -> Result<Self, OutOfRange> {
        rounded(value, true)
    }

    fn to_f64(self) -> f64 {
        FixedI32::<F::Frac>::from_bits(self.bits()).to_num()
    }

    fn coefficient(value: f64) -> Result<Scaled, OutOfRange> {
        Scaled::new(value, Self::FORMAT)
    }

    fn coefficient_to_f64(coefficient: Scaled) -> f64 {
        coefficient.to_f64()
    }

    #[inline(always)]
    fn plus(self, other: Self) -> Self {
        Self::of_bits(self.bits().saturating_add(other.bits()))
    }

    #[inline(always)]
    fn minus(self, other: Self) -> Self {
        Self::of_bits(self.bits().saturating_sub(other.bits()))
    }

    #[inline(always)]
    fn times(self, coefficient: Scaled) -> Self {
        Self::of_bits(product::<F>(self.bits(), coefficient).0)
    }

    #[inline(always)]
    fn negated(self) -> Self {
        Self::of_bits(self.bits().saturating_neg())
    }

    #[inline(always)]
    fn within(self, bound: Self) -> bool {
        self.bits() <= bound.bits() && self.bits() >= bound.bits().saturating_neg()
    }

    #[inline(always)]
    fn is_from_zero_to(self, bound: Self) -> bool {
        // A negative number has more bits than any other.
        self.bits().cast_unsigned() <= bound.bits().cast_unsigned()
    }

    #[inline(always)]
    fn positive_part(self) -> Self {
        Self::of_bits(self.bits().max(0))
    }

    fn angle_scale(radians_per_count: f64) -> Result<Scaled, OutOfRange> {
        Scaled::inward(radians_per_count * step::<F>().recip(), Self::FORMAT)
    }

    #[inline(always)]
    fn angle(count: i32, scale: Scaled) -> (Self, bool) {
        let (bits, fits) = product::<F>(count, scale);
        (Self::of_bits(bits), fits)
    }

    fn parts_scale(parts_per_rad: f64) -> Result<Scaled, OutOfRange> {
        Scaled::new(parts_per_rad * step::<F>(), Self::FORMAT)
    }

    #[inline(always)]
    fn parts(self, scale: Scaled) -> i32 {
        product::<F>(self.bits(), scale).0
    }

    fn part_scale(torque: f64) -> Result<Scaled, OutOfRange> {
        Scaled::new(torque * step::<F>().recip(), Self::FORMAT)
    }

    #[inline(always)]
    fn of_parts(parts: i32, scale: Scaled) -> Self {
        Self::of_bits(product::<F>(parts, scale).0)
    }

    fn code_scale(codes_per_torque: f64) -> Result<Scaled, OutOfRange> {
        Scaled::inward(codes_per_torque * step::<F>(), Self::FORMAT)
    }

    #[inline(always)]
    fn codes_below(self, centre: u16, scale: Scaled) -> u16 {
        // Rounded to nearest also where products are truncated.
        let (below, _) = scale.scale(self.bits());
        i32::from(centre).saturating_sub(below).clamp(0, 0xfff) as u16
    }
}
