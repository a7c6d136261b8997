//! A scene with its transducers, sent to a board by the bits of its numbers: the board certifies it
//! and then runs its servo for a number of ticks.
//!
//! The programs for the board have one scene each, with a delay in its type; with these requests a test runs
//! many scenes on a board, with any delay.

use haptic_servo::number::Arithmetic;
use haptic_servo::scene::Scene;
use haptic_servo::servo::Transducers;
use serde::{Deserialize, Serialize};

/// A request to run a closed loop on the board.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct LoopRequest {
    /// The scene, which the board certifies before it runs.
    #[serde(with = "crate::scene_codec")]
    pub scene: Scene,
    /// The encoder and the motor.
    pub transducers: Transducers,
    /// The servo's number format: `f32` or `I16F16`, for which a program has room.
    pub arithmetic: Arithmetic,
    /// Number of ticks, for each of which the host gives a count and takes a code.
    pub ticks: u32,
}

/// The board's reply before the first tick; ticks follow only after [`StartReply::Ready`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum StartReply {
    /// The scene is certified and its servo at rest.
    Ready,
    /// The scene is not certified.
    Rejected,
    /// It is certified, but its servo cannot be built with these transducers in this arithmetic.
    BuildFailed,
}
