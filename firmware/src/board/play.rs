//! A scene with what it runs on, put to a board by the bits of its numbers: the board certifies it
//! and then is its servo for so many ticks.
//!
//! The programs for the board have one scene each, with a delay that is a type; this is how a test
//! has a board play many scenes in one run, whatever their delays.

use super::question::{Question, ask, read};
use crate::encoder::CounterWidth;
use crate::number::Arithmetic;
use crate::scene::Scene;
use crate::servo::Transducers;

/// What a board is to play.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Play {
    /// The scene, which is certified before anything of it runs.
    pub scene: Scene,
    /// The encoder and the motor.
    pub transducers: Transducers,
    /// What the servo computes in: `f32` or `I16F16`, for which a program has room.
    pub arithmetic: Arithmetic,
    /// Number of ticks, for each of which the host gives a count and takes a code.
    pub ticks: u32,
}

/// What a board says to that before the first tick; only [`Curtain::Open`] is followed by any.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u64)]
pub enum Curtain {
    /// The scene is certified and its servo at rest.
    Open = 0,
    /// The scene is not certified.
    Refused = 1,
    /// It is, but cannot be had with these transducers in this arithmetic.
    Unbuildable = 2,
}

/// Words behind the scene's.
const MORE: usize = 6;

/// A [`Play`] as words.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PlayWords {
    /// The scene.
    pub question: Question,
    /// The rest.
    pub more: [u64; MORE],
}

impl PlayWords {
    /// Length in bytes.
    pub const BYTES: usize = size_of::<Question>() + 8 * MORE;

    /// From the bytes of all words, in the order of the fields.
    pub fn from_le_bytes(words: &[[u8; 8]]) -> Self {
        let word = |i: usize| words.get(i).map_or(0, |word| u64::from_le_bytes(*word));
        let question: Question = core::array::from_fn(word);
        let more = core::array::from_fn(|i| word(question.len() + i));
        Self { question, more }
    }

    /// All words, each as bytes.
    pub fn to_le_bytes(&self) -> impl Iterator<Item = [u8; 8]> {
        self.question.iter().chain(&self.more).map(|word| word.to_le_bytes())
    }
}

impl Curtain {
    /// As bytes.
    pub const fn to_bytes(self) -> [u8; 8] {
        (self as u64).to_le_bytes()
    }

    /// From bytes; `None` for what [`Curtain::to_bytes`] did not write.
    pub fn from_bytes(bytes: [u8; 8]) -> Option<Self> {
        let all = [Self::Open, Self::Refused, Self::Unbuildable];
        all.into_iter().find(|curtain| curtain.to_bytes() == bytes)
    }
}

impl Play {
    /// As words.
    pub fn to_words(&self) -> PlayWords {
        let Transducers { counts_per_turn, counter, full_scale_torque, largest_speed } =
            self.transducers;
        PlayWords {
            question: ask(&self.scene),
            more: [
                counts_per_turn.to_bits(),
                u64::from(counter == CounterWidth::Bits16),
                full_scale_torque.to_bits(),
                largest_speed.to_bits(),
                Arithmetic::ALL.iter().take_while(|other| **other != self.arithmetic).count()
                    as u64,
                self.ticks.into(),
            ],
        }
    }

    /// From words; `None` if they are none.
    pub fn from_words(words: &PlayWords) -> Option<Self> {
        let [counts, narrow, torque, speed, arithmetic, ticks] = words.more;
        Some(Self {
            scene: read(&words.question)?,
            transducers: Transducers {
                counts_per_turn: f64::from_bits(counts),
                counter: if narrow == 0 { CounterWidth::Bits32 } else { CounterWidth::Bits16 },
                full_scale_torque: f64::from_bits(torque),
                largest_speed: f64::from_bits(speed),
            },
            arithmetic: *Arithmetic::ALL.get(usize::try_from(arithmetic).ok()?)?,
            ticks: ticks.try_into().ok()?,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::environment::{Environment, Wall};
    use crate::scene::{Coupling, Device, Timing};

    #[test]
    fn plays_survive_their_words() {
        let wall = Wall {
            stiffness: 1.0,
            damping: 0.5,
            filter: None,
            delay: 4,
            face: 0.0,
            one_sided: false,
        };
        let play = Play {
            scene: Scene {
                device: Device { inertia: 0.1, damping: 0.2, passivity: None },
                timing: Timing { period: 0.4, worst_period: Some(0.8) },
                coupling: Coupling::Rigid,
                environment: Environment::DamperWall(wall),
                torque_limit: None,
            },
            transducers: Transducers {
                counts_per_turn: 61_440.0,
                counter: CounterWidth::Bits16,
                full_scale_torque: 2.0,
                largest_speed: 100.0,
            },
            arithmetic: Arithmetic::I16F16,
            ticks: 5000,
        };
        let words = play.to_words();
        assert_eq!(Play::from_words(&words), Some(play));
        let [a, b, c, d, _, ticks] = words.more;
        assert_eq!(Play::from_words(&PlayWords { more: [a, b, c, d, 8, ticks], ..words }), None);
        for curtain in [Curtain::Open, Curtain::Refused, Curtain::Unbuildable] {
            assert_eq!(Curtain::from_bytes(curtain.to_bytes()), Some(curtain));
        }
        assert_eq!(Curtain::from_bytes([9; 8]), None);
    }
}
