//! Number formats of the servo, with only the operations that a tick needs.
//!
//! A [`Number`] holds angles (rad) and torques (N m). Their factors are of type [`Number::Coefficient`],
//! computed once from plain SI values. All operations of the tick give the same bits on every machine: no
//! fused multiply-add, no library function, no division.

mod arithmetic;
mod coefficient;
mod fixed_point;
mod float;
mod rounding;
#[cfg(test)]
mod tests;
mod truncated;

/// The crate of the fixed-point formats, in the version used here.
pub use fixed;

pub use arithmetic::{Arithmetic, InEach};
pub use fixed_point::Scaled;
pub use rounding::Rounding;
pub use truncated::Truncated;

use core::fmt;

use crate::text::{Piece, Text, push};

/// A number format of the servo: `f32`, `f64`, or a [`fixed::FixedI32`], rounded or [`Truncated`].
pub trait Number: Copy + Default + PartialOrd + fmt::Debug + 'static {
    /// A factor of a number: a gain, a compliance, a scale.
    type Coefficient: Copy + fmt::Debug;
    /// The format's name and resolution, for messages.
    const FORMAT: Format;
    /// Zero.
    const ZERO: Self;

    /// Rounds a value in SI units to the format; an error if it does not fit.
    fn from_f64(value: f64) -> Result<Self, OutOfRange>;
    /// Rounds a positive bound towards zero, so that a number within the rounded bound is within the value.
    fn bound_from_f64(value: f64) -> Result<Self, OutOfRange>;
    /// The number in SI units, exactly.
    fn to_f64(self) -> f64;
    /// Rounds a factor to the format's coefficients; an error if it does not fit.
    fn coefficient(value: f64) -> Result<Self::Coefficient, OutOfRange>;
    /// The exact value of a coefficient, by which the servo multiplies.
    fn coefficient_to_f64(coefficient: Self::Coefficient) -> f64;

    /// Sum; saturates in fixed point.
    fn plus(self, other: Self) -> Self;
    /// Difference; saturates in fixed point.
    fn minus(self, other: Self) -> Self;
    /// Product with a coefficient, rounded to nearest, or truncated in a [`Truncated`] format; saturates in
    /// fixed point.
    fn times(self, coefficient: Self::Coefficient) -> Self;
    /// The number with the opposite sign; saturates in fixed point.
    fn negated(self) -> Self;
    /// Whether the magnitude is at most `bound`; never true of a NaN.
    fn within(self, bound: Self) -> bool;
    /// Whether the number is at least zero and at most `bound`, which is not negative; never true of a NaN,
    /// and of a negative zero in some formats.
    #[inline(always)]
    fn is_from_zero_to(self, bound: Self) -> bool {
        self >= Self::ZERO && self <= bound
    }
    /// The number if it is positive, otherwise zero. For a NaN: by its sign, itself or zero.
    fn positive_part(self) -> Self;
    /// The smaller of two; `self` if one is a NaN.
    #[inline(always)]
    fn smaller(self, other: Self) -> Self {
        if other < self { other } else { self }
    }
    /// The larger of two; `self` if one is a NaN.
    #[inline(always)]
    fn larger(self, other: Self) -> Self {
        if self < other { other } else { self }
    }

    /// The factor for [`Number::angle`] from the encoder's step in rad, rounded [`Rounding::Inward`].
    fn angle_scale(radians_per_count: f64) -> Result<Self::Coefficient, OutOfRange>;
    /// Angle of an encoder count in rad, and whether it fits the format; if not, the angle is the end of the
    /// format's range.
    fn angle(count: i32, scale: Self::Coefficient) -> (Self, bool);
    /// The factor for [`Number::parts`] from parts per rad.
    fn parts_scale(parts_per_rad: f64) -> Result<Self::Coefficient, OutOfRange>;
    /// The angle in whole parts, truncated or rounded; the nearest `i32` if it is out of range.
    fn parts(self, scale: Self::Coefficient) -> i32;
    /// The factor for [`Number::of_parts`] from the torque in N m of a part.
    fn part_scale(torque: f64) -> Result<Self::Coefficient, OutOfRange>;
    /// The torque in N m of a number of parts.
    fn of_parts(parts: i32, scale: Self::Coefficient) -> Self;
    /// The factor for [`Number::codes_below`] from the DAC's codes per N m, rounded
    /// [`Rounding::Inward`].
    fn code_scale(codes_per_torque: f64) -> Result<Self::Coefficient, OutOfRange>;
    /// `centre - torque * scale` rounded to the nearest whole code, for results in `0..=4095`.
    fn codes_below(self, centre: u16, scale: Self::Coefficient) -> u16;
}

/// A number format, for messages.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "wire", derive(serde::Serialize, serde::Deserialize))]
pub enum Format {
    /// IEEE binary32.
    F32,
    /// IEEE binary64.
    F64,
    /// 32-bit two's complement with this many fractional bits.
    Fixed {
        /// Number of fractional bits.
        fraction_bits: u32,
    },
    /// The same, with truncated products.
    Truncated {
        /// Number of fractional bits.
        fraction_bits: u32,
    },
}

impl Format {
    /// The name, such as `f32` or `Q8.24`.
    pub const fn name(self) -> Text<16> {
        let mut name = Text::new();
        match self {
            Self::F32 => name.push("f32"),
            Self::F64 => name.push("f64"),
            Self::Fixed { fraction_bits } | Self::Truncated { fraction_bits } => {
                push!(name, "Q" {32.0 - fraction_bits as f64} "." {fraction_bits});
                if matches!(self, Self::Truncated { .. }) {
                    name.push(" truncated");
                }
            }
        }
        name
    }
}

impl fmt::Display for Format {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name().as_str())
    }
}

/// A value that a number format cannot represent.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OutOfRange {
    /// The value in its given unit.
    pub value: f64,
    /// The largest magnitude that fits.
    pub bound: f64,
    /// The format.
    pub format: Format,
}

impl Piece<OutOfRange> {
    pub(crate) const fn push_to<const N: usize>(self, t: &mut Text<N>) {
        let OutOfRange { value, bound, format } = self.0;
        push!(*t,
            {value} " does not fit " {format.name().as_str()} ": its magnitude may be at most " {bound});
    }
}

impl fmt::Display for OutOfRange {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut sentence = Text::<128>::new();
        push!(sentence, { *self });
        f.write_str(sentence.as_str())
    }
}

impl core::error::Error for OutOfRange {}

/// The value if its magnitude is at most `bound` (never for NaN), else the error.
fn bounded(value: f64, bound: f64, format: Format) -> Result<f64, OutOfRange> {
    if value.abs() <= bound { Ok(value) } else { Err(OutOfRange { value, bound, format }) }
}
