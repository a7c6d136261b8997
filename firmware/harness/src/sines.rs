//! Other means of computing the sweep's sine, for the table of their costs.

use core::f32::consts::TAU;

use haptic_servo::excitation::sine::{QUINTIC, sine};
use haptic_servo::words;

words! {
    /// A means of computing the sine of a part of a turn.
    #[derive(serde::Serialize, serde::Deserialize)]
    Sine {
    /// The crate `micromath`, in `f32`.
    Micromath "micromath",
    /// The crate `libm`, for `f32`; inside it computes in `f64`.
    Libm "libm sinf",
    /// The same crate, for `f64`.
    LibmDouble "libm sin",
    /// A polynomial of the third degree.
    Cubic "degree 3",
    /// A polynomial of the fifth degree: what a sweep is played with.
    Quintic "degree 5",
    /// A polynomial of the seventh degree.
    Septic "degree 7",
    /// A polynomial of the ninth degree.
    Nonic "degree 9",
    }
}

/// Coefficients as those of [`QUINTIC`], with the least largest error of their degree.
pub(crate) const CUBIC: [f32; 2] = [6.192_264_7, -35.363_71];
pub(crate) const SEPTIC: [f32; 4] = [6.283_164, -41.337_143, 81.340_77, -70.993_43];
#[expect(clippy::approx_constant, reason = "the least error is beside it, not at it")]
const NONIC: [f32; 5] = [6.283_185, -41.341_656, 81.601_006, -76.549_78, 39.536_705];

impl Sine {
    /// The sine of `turn` turns, from 0 to 1.
    #[inline(always)]
    pub fn of_turn(self, turn: f32) -> f32 {
        match self {
            // By name, since `f32` has a sine of its own where there is an operating system.
            Self::Micromath => micromath::F32Ext::sin(TAU * turn),
            Self::Libm => libm::sinf(TAU * turn),
            Self::LibmDouble => libm::sin(core::f64::consts::TAU * f64::from(turn)) as f32,
            Self::Cubic => sine(turn, &CUBIC),
            Self::Quintic => sine(turn, &QUINTIC),
            Self::Septic => sine(turn, &SEPTIC),
            Self::Nonic => sine(turn, &NONIC),
        }
    }
}
