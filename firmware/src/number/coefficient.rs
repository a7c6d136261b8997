//! What a format makes of a coefficient, by a function that the compiler can run: the certificate
//! judges the coefficients that the servo multiplies by, not those that a person wrote.

use super::fixed_point::{self, Scaled};
use super::rounding::Rounding;
use super::{Format, float};

/// The largest unit of a knot of a table: it stands for all of the table's torque.
pub const KNOT_FULL_SCALE: i16 = i16::MAX;
pub(super) const TWICE_FULL_SCALE: f64 = 2.0 * KNOT_FULL_SCALE as f64;

impl Format {
    /// The value of the coefficient that this format makes of `value`. What the format does not
    /// hold is given back as it is: it is refused by name where the servo is built.
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

    /// Torque in N m of half a unit of a knot, as this format makes it of that of a knot at full scale.
    pub(crate) const fn knot_scale(self, torque: f64) -> f64 {
        let half_unit = torque / TWICE_FULL_SCALE;
        match self {
            Self::Fixed { fraction_bits } | Self::Truncated { fraction_bits } => {
                let factor = fixed_point::knot_factor(fraction_bits);
                self.coefficient(half_unit * factor, Rounding::Nearest) / factor
            }
            Self::F32 | Self::F64 => self.coefficient(half_unit, Rounding::Nearest),
        }
    }

    /// The most by which a number of this magnitude is off when it is rounded, half a step, or cut
    /// off, a whole one.
    pub fn rounding_error(self, magnitude: f64) -> f64 {
        match self {
            Self::F32 => 0.5 * f64::from(f32::EPSILON) * magnitude,
            Self::F64 => 0.5 * f64::EPSILON * magnitude,
            Self::Fixed { fraction_bits } => 0.5 / (1_u64 << fraction_bits) as f64,
            Self::Truncated { fraction_bits } => 1.0 / (1_u64 << fraction_bits) as f64,
        }
    }
}

impl Format {
    /// The most by which a place in a table of knots is off, in cells, beside what a product rounds.
    pub(crate) fn error_of_place(self) -> f64 {
        match self {
            Self::F32 | Self::F64 => 0.0,
            Self::Fixed { .. } | Self::Truncated { .. } => {
                1.0 / f64::from(1_u32 << fixed_point::PART_BITS)
            }
        }
    }
}

const fn to_f32(value: f64, rounding: Rounding) -> f32 {
    let nearest = value as f32;
    let (found, wanted) = ((nearest as f64).abs(), value.abs());
    // The bits of a float are in the order of its magnitude.
    match rounding {
        Rounding::Inward if found > wanted => f32::from_bits(nearest.to_bits() - 1),
        Rounding::Outward if found < wanted => f32::from_bits(nearest.to_bits() + 1),
        _ => nearest,
    }
}
