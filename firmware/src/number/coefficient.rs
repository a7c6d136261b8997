//! The rounding of a coefficient by a number format, as a `const fn`: the certificate judges the rounded
//! coefficients of the servo, not the written numbers.

use super::fixed_point::{self, Scaled};
use super::rounding::Rounding;
use super::{Format, float};

impl Format {
    /// The value of the coefficient after rounding to this format. A value that the format cannot represent
    /// is returned unchanged; building the servo refuses it with its name.
    #[cfg_attr(target_os = "none", inline(never))]
    pub const fn coefficient(self, value: f64, rounding: Rounding) -> f64 {
        match self {
            Self::F32 if value.abs() <= float::LARGEST => to_f32(value, rounding) as f64,
            Self::Fixed { .. } | Self::Truncated { .. } if value.abs() <= fixed_point::LARGEST => {
                Scaled::of(value, rounding).to_f64()
            }
            Self::F32 | Self::F64 | Self::Fixed { .. } | Self::Truncated { .. } => value,
        }
    }

    /// Parts per rad as rounded by [`Number::parts_scale`](super::Number::parts_scale).
    pub(crate) const fn parts_per_rad(self, value: f64) -> f64 {
        let steps = self.steps_per_unit();
        self.coefficient(value / steps, Rounding::Nearest) * steps
    }

    /// The torque in N m of a part as rounded by [`Number::part_scale`](super::Number::part_scale).
    pub(crate) const fn torque_of_part(self, value: f64) -> f64 {
        let steps = self.steps_per_unit();
        self.coefficient(value * steps, Rounding::Nearest) / steps
    }

    /// Steps of a fixed-point format per rad or N m, a power of two; 1 in floating point.
    const fn steps_per_unit(self) -> f64 {
        match self {
            Self::Fixed { fraction_bits } | Self::Truncated { fraction_bits } => {
                (1_u64 << fraction_bits) as f64
            }
            Self::F32 | Self::F64 => 1.0,
        }
    }

    /// The largest error of a number of this magnitude: half a step if rounded, a whole step if truncated.
    pub fn rounding_error(self, magnitude: f64) -> f64 {
        match self {
            Self::F32 => 0.5 * f64::from(f32::EPSILON) * magnitude,
            Self::F64 => 0.5 * f64::EPSILON * magnitude,
            Self::Fixed { fraction_bits } => 0.5 / (1_u64 << fraction_bits) as f64,
            Self::Truncated { fraction_bits } => 1.0 / (1_u64 << fraction_bits) as f64,
        }
    }
}

const fn to_f32(value: f64, rounding: Rounding) -> f32 {
    let nearest = value as f32;
    let (found, wanted) = ((nearest as f64).abs(), value.abs());
    // The bits of floats have the order of their magnitudes.
    match rounding {
        Rounding::Inward if found > wanted => f32::from_bits(nearest.to_bits() - 1),
        Rounding::Outward if found < wanted => f32::from_bits(nearest.to_bits() + 1),
        _ => nearest,
    }
}
