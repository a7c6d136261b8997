//! Means of computing sine and cosine of a motor's phase, for the table of their costs.

use core::f32::consts::TAU;

use haptic_servo::current::sine_and_cosine;
use haptic_servo::excitation::sine::{QUINTIC, sine};
use haptic_servo::words;

use crate::sines::{CUBIC, SEPTIC};

words! {
    /// A means of computing sine and cosine of an angle, which is a part of a turn in 32 bits.
    #[derive(serde::Serialize, serde::Deserialize)]
    Rotation {
    /// The crate `micromath`, in `f32`.
    Micromath "micromath",
    /// The crate `libm`, for `f32`.
    Libm "libm sincosf",
    /// A polynomial of the third degree, twice.
    Cubic "degree 3",
    /// A polynomial of the fifth degree, twice.
    Quintic "degree 5",
    /// A polynomial of the seventh degree, twice.
    Septic "degree 7",
    /// Straight lines between the entries of a table of 256 for a turn, in whole numbers: what a current loop
    /// has.
    Table "table of 256",
    }
}

const QUARTER: u32 = 1 << 30;

impl Rotation {
    /// Sine and cosine of an angle.
    #[inline(always)]
    pub fn of_angle(self, angle: u32) -> [f32; 2] {
        match self {
            Self::Micromath => {
                let (sine, cosine) = micromath::F32Ext::sin_cos(TAU * turn(angle));
                [sine, cosine]
            }
            Self::Libm => {
                let (sine, cosine) = libm::sincosf(TAU * turn(angle));
                [sine, cosine]
            }
            Self::Cubic => twice(angle, &CUBIC),
            Self::Quintic => twice(angle, &QUINTIC),
            Self::Septic => twice(angle, &SEPTIC),
            Self::Table => sine_and_cosine(angle),
        }
    }
}

/// An angle as a part of a turn, of the 24 bits that `f32` holds exactly.
#[inline(always)]
fn turn(angle: u32) -> f32 {
    (angle >> 8) as f32 * (1.0 / (1 << 24) as f32)
}

#[inline(always)]
fn twice<const N: usize>(angle: u32, coefficients: &[f32; N]) -> [f32; 2] {
    [sine(turn(angle), coefficients), sine(turn(angle.wrapping_add(QUARTER)), coefficients)]
}

/// Sine and cosine as the one number that a measurement has.
pub fn packed([sine, cosine]: [f32; 2]) -> f64 {
    f64::from_bits(u64::from(sine.to_bits()) << 32 | u64::from(cosine.to_bits()))
}

/// Sine and cosine of such a number.
pub fn unpacked(pair: f64) -> [f32; 2] {
    [(pair.to_bits() >> 32) as u32, pair.to_bits() as u32].map(f32::from_bits)
}
