//! A scene with what it runs on, put to a board by the bits of its numbers: the board certifies it
//! and then is its servo for so many ticks.
//!
//! The programs for the board have one scene each, with a delay that is a type; this is how a test
//! has a board play many scenes in one run, whatever their delays.

use firmware::number::Arithmetic;
use firmware::scene::Scene;
use firmware::servo::Transducers;

use crate::question::{Question, ask, read};
use crate::words::{self, MachineWords};

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

/// Words in front of a play's scene: the ticks and the machine.
const HEAD: usize = 1 + size_of::<MachineWords>() / 8;
/// A [`Play`] as words.
pub type PlayWords = [u64; HEAD + size_of::<Question>() / 8];

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
    /// Its words.
    pub fn words(&self) -> PlayWords {
        let mut words = [0; _];
        words[0] = self.ticks.into();
        words[1..HEAD].copy_from_slice(&words::ask(&self.transducers, self.arithmetic));
        words[HEAD..].copy_from_slice(&ask(&self.scene));
        words
    }

    /// The play of the words; `None` if they are none.
    pub fn read(words: &PlayWords) -> Option<Self> {
        let (&[ticks, ref machine @ ..], scene) = words.split_first_chunk::<HEAD>()?;
        let (transducers, arithmetic) = words::read(*machine)?;
        let scene = read(scene.try_into().ok()?)?;
        Some(Self { scene, transducers, arithmetic, ticks: ticks.try_into().ok()? })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use firmware::encoder::CounterWidth;
    use firmware::environment::{Environment, Wall};
    use firmware::scene::{Coupling, Device, Timing};

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
        let mut words = play.words();
        assert_eq!(Play::read(&words), Some(play));
        words[HEAD - 1] = Arithmetic::ALL.len() as u64;
        assert_eq!(Play::read(&words), None);
        for curtain in [Curtain::Open, Curtain::Refused, Curtain::Unbuildable] {
            assert_eq!(Curtain::from_bytes(curtain.to_bytes()), Some(curtain));
        }
        assert_eq!(Curtain::from_bytes([9; 8]), None);
    }
}
