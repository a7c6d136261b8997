//! Instruction benchmarks: a request to compute torques, sines or compare values, and the results with the
//! instructions of each.
//!
//! A [`BenchRequest`] goes to the board as [`BenchRequestWords`]; the board answers with one byte, whether it
//! can compute it. Then the host sends [`Inputs`], any number of times, and the board answers each with
//! [`Outputs`].

use haptic_servo::number::Arithmetic;
use haptic_servo::scene::Scene;
use haptic_servo::servo::Transducers;

use crate::currents::CurrentBench;
use crate::rotations::Rotation;
use crate::scene_codec::{self, SceneWords, encode};
use crate::sines::Sine;
use crate::transducer_codec::{self, TransducerWords};

/// The computation that is measured.
#[derive(Clone, Copy, Debug, PartialEq)]
#[expect(clippy::large_enum_variant, reason = "there is no heap, and never more than one")]
pub enum BenchRequest {
    /// The torque of a scene at each count of an encoder, from rest.
    Servo {
        /// The scene, which has been judged.
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

/// The board's first answer: it will compute.
pub const READY: u8 = 1;
/// The board's first answer: its program has no scene of this type, or its servo cannot be built.
pub const REFUSED: u8 = 0;

/// Words in front of the scene: a sine, or [`SERVO`], and the transducers.
const HEAD: usize = 1 + size_of::<TransducerWords>() / 8;
/// A request as words.
pub type BenchRequestWords = [u64; HEAD + size_of::<SceneWords>() / 8];

impl BenchRequest {
    /// Its words.
    pub fn encode(&self) -> BenchRequestWords {
        let mut words = [0; _];
        match self {
            Self::Servo { scene, transducers, arithmetic } => {
                words[0] = SERVO;
                words[1..HEAD].copy_from_slice(&transducer_codec::encode(transducers, *arithmetic));
                words[HEAD..].copy_from_slice(&encode(scene));
            }
            Self::Rotation(rotation) => {
                words[0] = ROTATION;
                words[1] = transducer_codec::index_of(&Rotation::ALL, rotation);
            }
            Self::Current(bench) => {
                words[0] = CURRENT;
                words[1] = transducer_codec::index_of(&CurrentBench::ALL, bench);
            }
            Self::Sine(sine) => words[0] = transducer_codec::index_of(&Sine::ALL, sine),
        }
        words
    }

    /// The request of the words; `None` if they are malformed.
    pub fn decode(words: &BenchRequestWords) -> Option<Self> {
        let (&[which, ref machine @ ..], scene) = words.split_first_chunk::<HEAD>()?;
        if which == ROTATION {
            return transducer_codec::from_index(&Rotation::ALL, machine[0]).map(Self::Rotation);
        }
        if which == CURRENT {
            return transducer_codec::from_index(&CurrentBench::ALL, machine[0]).map(Self::Current);
        }
        if which != SERVO {
            return transducer_codec::from_index(&Sine::ALL, which).map(Self::Sine);
        }
        let (transducers, arithmetic) = transducer_codec::decode(*machine)?;
        let scene = scene_codec::decode(scene.try_into().ok()?)?;
        Some(Self::Servo { scene, transducers, arithmetic })
    }
}

/// Marks a request for a servo in the place of a sine.
const SERVO: u64 = u64::MAX;
const CURRENT: u64 = u64::MAX - 1;
const ROTATION: u64 = u64::MAX - 2;
