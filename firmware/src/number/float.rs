//! The formats of the floating-point unit: `f32` on the target, `f64` as the host's reference.

use super::{Format, Number, OutOfRange, Rounding, bounded};

/// Largest magnitude of a coefficient or a constant. An angle is below 2^34 rad, so that no
/// product of the tick comes near the 2^127 where `f32` would turn infinite.
pub(super) const LARGEST: f64 = (1u64 << 40) as f64;

macro_rules! floating_point {
    ($float:ident, $bits:literal, $format:expr, $integers_from:expr) => {
        impl Number for $float {
            type Coefficient = $float;
            const FORMAT: Format = $format;
            const ZERO: Self = 0.0;

            fn from_f64(value: f64) -> Result<Self, OutOfRange> {
                bounded(value, LARGEST, $format).map(|value| value as $float)
            }

            fn bound_from_f64(value: f64) -> Result<Self, OutOfRange> {
                let nearest = Self::from_f64(value)?;
                let above = f64::from(nearest) > value;
                Ok(if above { nearest.next_down() } else { nearest })
            }

            fn to_f64(self) -> f64 {
                self.into()
            }

            fn coefficient(value: f64) -> Result<Self, OutOfRange> {
                Self::from_f64(value)
            }

            fn coefficient_to_f64(coefficient: Self) -> f64 {
                coefficient.into()
            }

            #[inline(always)]
            fn plus(self, other: Self) -> Self {
                self + other
            }

            #[inline(always)]
            fn minus(self, other: Self) -> Self {
                self - other
            }

            #[inline(always)]
            fn times(self, coefficient: Self) -> Self {
                self * coefficient
            }

            #[inline(always)]
            fn negated(self) -> Self {
                -self
            }

            #[inline(always)]
            fn within(self, bound: Self) -> bool {
                self.abs() <= bound
            }

            #[inline(always)]
            fn is_from_zero_to(self, bound: Self) -> bool {
                // The bits of floats have the order of their magnitudes; NaNs and numbers with a sign bit are
                // above all non-negative numbers.
                self.to_bits() <= bound.to_bits()
            }

            #[inline(always)]
            fn positive_part(self) -> Self {
                // Clears all bits if the sign is set: three integer instructions in place of five for a
                // comparison and a choice.
                let bits = self.to_bits().cast_signed();
                Self::from_bits((bits & !(bits >> ($bits - 1))).cast_unsigned())
            }

            fn angle_scale(radians_per_count: f64) -> Result<Self, OutOfRange> {
                Self::from_f64($format.coefficient(radians_per_count, Rounding::Inward))
            }

            #[inline(always)]
            fn angle(count: i32, scale: Self) -> (Self, bool) {
                (count as $float * scale, true)
            }

            fn parts_scale(parts_per_rad: f64) -> Result<Self, OutOfRange> {
                Self::from_f64(parts_per_rad)
            }

            #[inline(always)]
            fn parts(self, scale: Self) -> i32 {
                (self * scale) as i32
            }

            fn part_scale(torque: f64) -> Result<Self, OutOfRange> {
                Self::from_f64(torque)
            }

            #[inline(always)]
            fn of_parts(parts: i32, scale: Self) -> Self {
                parts as $float * scale
            }

            fn code_scale(codes_per_torque: f64) -> Result<Self, OutOfRange> {
                Self::from_f64($format.coefficient(codes_per_torque, Rounding::Inward))
            }

            #[inline(always)]
            fn codes_below(self, centre: u16, scale: Self) -> u16 {
                // Around 1.5 * 2^(mantissa bits) neighbouring floats are 1 apart, so the subtraction itself
                // rounds to the nearest code, which is then in the low bits. A cast would add the
                // instructions of its saturation.
                let centre = $integers_from + $float::from(centre);
                ((centre - self * scale).to_bits() & 0xfff) as u16
            }
        }
    };
}

floating_point!(f32, 32, Format::F32, 12_582_912.0_f32);
floating_point!(f64, 64, Format::F64, 6_755_399_441_055_744.0_f64);
