//! Arithmetic put to the trial: what a board is asked to compute in one way or another, and what it
//! says of the result and of its instructions.
//!
//! A [`Trial`] goes to the board as [`Words`], which are answered by one byte: whether it can be
//! done. Then come [`Inputs`], any number of times, and each is answered by [`Outputs`].

use firmware::number::Arithmetic;
use firmware::scene::Scene;
use firmware::servo::Transducers;

use crate::question::{self, Question, ask};
use crate::sines::Sine;
use crate::words::{self, MachineWords};

/// What is to be computed.
#[derive(Clone, Copy, Debug, PartialEq)]
#[expect(clippy::large_enum_variant, reason = "there is no heap, and never more than one")]
pub enum Trial {
    /// The torque of a scene at each count of an encoder, from rest.
    Servo {
        /// The scene, which has been judged.
        scene: Scene,
        /// Its sensor and its motor.
        transducers: Transducers,
        /// The format to compute in.
        arithmetic: Arithmetic,
    },
    /// The sine of each part of a turn, which is the bits of an `f32`.
    Sine(Sine),
}

/// Inputs at a time: as many as fit a pipe's buffer, so that asking never waits for the board.
pub const BLOCK: usize = 64;
/// Counts, or the bits of parts of a turn.
pub type Inputs = [u32; BLOCK];
/// What came of them.
pub type Outputs = [Output; BLOCK];

/// What came of an input.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Output {
    /// Torque in N m, or sine.
    pub value: f64,
    /// The converter's code; of a sine none.
    pub code: u16,
    /// Instructions that it took.
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
/// The board's first answer: its program has no scene of this type, or none can be built.
pub const REFUSED: u8 = 0;

/// Words in front of a trial's scene: a sine, or [`SERVO`], and the machine.
const HEAD: usize = 1 + size_of::<MachineWords>() / 8;
/// A trial as words.
pub type Words = [u64; HEAD + size_of::<Question>() / 8];

impl Trial {
    /// Its words.
    pub fn words(&self) -> Words {
        let mut words = [0; _];
        match self {
            Self::Servo { scene, transducers, arithmetic } => {
                words[0] = SERVO;
                words[1..HEAD].copy_from_slice(&words::ask(transducers, *arithmetic));
                words[HEAD..].copy_from_slice(&ask(scene));
            }
            Self::Sine(sine) => words[0] = words::place(&Sine::ALL, sine),
        }
        words
    }

    /// The trial of the words; `None` if they are none.
    pub fn read(words: &Words) -> Option<Self> {
        let (&[which, ref machine @ ..], scene) = words.split_first_chunk::<HEAD>()?;
        if which != SERVO {
            return words::at(&Sine::ALL, which).map(Self::Sine);
        }
        let (transducers, arithmetic) = words::read(*machine)?;
        let scene = question::read(scene.try_into().ok()?)?;
        Some(Self::Servo { scene, transducers, arithmetic })
    }
}

/// Stands where a sine would.
const SERVO: u64 = u64::MAX;
