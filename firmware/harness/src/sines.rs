//! Sines, whose arithmetic is compared between boards and host.

use haptic_servo::excitation::sine::{QUINTIC, sine};
use serde::{Deserialize, Serialize};

/// A means of computing the sine of a part of a turn.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Sine {
    /// The crate `libm`, for `f32`; inside it computes in `f64`.
    Libm,
    /// The same crate, for `f64`.
    LibmDouble,
    /// A polynomial of the fifth degree: what a sweep is played with.
    Quintic,
}

impl Sine {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::Libm, Self::LibmDouble, Self::Quintic];

    /// The sine of `turn` turns, from 0 to 1.
    #[inline(always)]
    pub fn of_turn(self, turn: f32) -> f32 {
        match self {
            Self::Libm => libm::sinf(core::f32::consts::TAU * turn),
            Self::LibmDouble => libm::sin(core::f64::consts::TAU * f64::from(turn)) as f32,
            Self::Quintic => sine(turn, &QUINTIC),
        }
    }
}
