//! Instruction benchmarks: a request to compute torques, sines or compare values, and the results with the
//! instructions of each.
//!
//! The board answers a [`BenchRequest`] by whether it can compute it. Then the host sends [`Inputs`], any number of
//! times, and the board answers each with [`Outputs`].

use haptic_servo::number::Arithmetic;
use haptic_servo::scene::Scene;
use haptic_servo::servo::Transducers;
use serde::{Deserialize, Serialize};

use crate::currents::CurrentBench;
use crate::rotations::Rotation;
use crate::sines::Sine;

/// The computation that is measured.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[expect(clippy::large_enum_variant, reason = "there is no heap, and never more than one")]
pub enum BenchRequest {
    /// The torque of a scene at each count of an encoder, from rest.
    Servo {
        /// The scene, which has been judged.
        #[serde(with = "crate::scene_codec")]
        scene: Scene,
        /// Its sensor and its motor.
        transducers: Transducers,
        /// The number format.
        arithmetic: Arithmetic,
    },
    /// The sine of each part of a turn, which is the bits of an `f32`.
    Sine(Sine),
    /// Sine and cosine of each angle, [packed](crate::rotations::packed).
    Rotation(Rotation),
    /// The compare values of a current loop at each instant, from rest: of
    /// [`Input`](crate::currents::Input)s.
    Current(CurrentBench),
}

/// Inputs in a block: as many as fit a pipe's buffer, so that sending never waits for the board.
pub const BLOCK: usize = 64;
/// Counts, or the bits of parts of a turn.
pub type Inputs = [u32; BLOCK];
/// The results of a block.
pub type Outputs = [Output; BLOCK];

/// The result of an input.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Output {
    /// Torque in N m, sine, or compare value of U.
    pub value: f64,
    /// The DAC code, or the compare value of V; zero for a sine.
    pub code: u16,
    /// Instructions of the computation.
    pub instructions: u32,
}

impl Output {
    /// Size in bytes.
    pub const BYTES: usize = 16;

    /// As bytes.
    pub fn to_bytes(self) -> [u8; Self::BYTES] {
        let low = u64::from(self.code) | u64::from(self.instructions) << 32;
        let words = u128::from(low) << 64 | u128::from(self.value.to_bits());
        words.to_le_bytes()
    }

    /// Of bytes.
    pub fn from_bytes(bytes: [u8; Self::BYTES]) -> Self {
        let words = u128::from_le_bytes(bytes);
        let low = (words >> 64) as u64;
        let (code, instructions) = (low as u16, (low >> 32) as u32);
        Self { value: f64::from_bits(words as u64), code, instructions }
    }
}
