//! A scene with its transducers, sent to a board by the bits of its numbers: the board certifies it
//! and then runs its servo for a number of ticks.
//!
//! The programs for the board have one scene each, with a delay in its type; with these requests a test runs
//! many scenes on a board, with any delay.

use haptic_servo::number::Arithmetic;
use haptic_servo::scene::Scene;
use haptic_servo::servo::Transducers;

use crate::scene_codec::{SceneWords, decode, encode};
use crate::transducer_codec::{self, TransducerWords};

/// A request to run a closed loop on the board.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LoopRequest {
    /// The scene, which the board certifies before it runs.
    pub scene: Scene,
    /// The encoder and the motor.
    pub transducers: Transducers,
    /// The servo's number format: `f32` or `I16F16`, for which a program has room.
    pub arithmetic: Arithmetic,
    /// Number of ticks, for each of which the host gives a count and takes a code.
    pub ticks: u32,
}

/// The board's reply before the first tick; ticks follow only after [`StartReply::Ready`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u64)]
pub enum StartReply {
    /// The scene is certified and its servo at rest.
    Ready = 0,
    /// The scene is not certified.
    Rejected = 1,
    /// It is certified, but its servo cannot be built with these transducers in this arithmetic.
    BuildFailed = 2,
}

/// Words in front of the scene: the ticks and the transducers.
const HEAD: usize = 1 + size_of::<TransducerWords>() / 8;
/// A [`LoopRequest`] as words.
pub type LoopRequestWords = [u64; HEAD + size_of::<SceneWords>() / 8];

impl StartReply {
    /// As bytes.
    pub const fn to_bytes(self) -> [u8; 8] {
        (self as u64).to_le_bytes()
    }

    /// From bytes; `None` if [`StartReply::to_bytes`] cannot have written them.
    pub fn from_bytes(bytes: [u8; 8]) -> Option<Self> {
        let all = [Self::Ready, Self::Rejected, Self::BuildFailed];
        all.into_iter().find(|reply| reply.to_bytes() == bytes)
    }
}

impl LoopRequest {
    /// Its words.
    pub fn encode(&self) -> LoopRequestWords {
        let mut words = [0; _];
        words[0] = self.ticks.into();
        words[1..HEAD]
            .copy_from_slice(&transducer_codec::encode(&self.transducers, self.arithmetic));
        words[HEAD..].copy_from_slice(&encode(&self.scene));
        words
    }

    /// The request of the words; `None` if they are malformed.
    pub fn decode(words: &LoopRequestWords) -> Option<Self> {
        let (&[ticks, ref machine @ ..], scene) = words.split_first_chunk::<HEAD>()?;
        let (transducers, arithmetic) = transducer_codec::decode(*machine)?;
        let scene = decode(scene.try_into().ok()?)?;
        Some(Self { scene, transducers, arithmetic, ticks: ticks.try_into().ok()? })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use haptic_servo::encoder::CounterWidth;
    use haptic_servo::environment::Wall;
    use haptic_servo::scene::{Coupling, Device, Latency, Timing};

    #[test]
    fn requests_survive_their_words() {
        let request = LoopRequest {
            scene: Scene {
                device: Device { inertia: 0.1, damping: 0.2, passivity: None },
                timing: Timing { period: 0.4, worst_period: Some(0.8) },
                coupling: Coupling::Rigid,
                environment: Wall::damped(1.0, 0.5, 4).alone(),
                latency: Latency::NONE,
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
        let mut words = request.encode();
        assert_eq!(LoopRequest::decode(&words), Some(request));
        words[HEAD - 1] = Arithmetic::ALL.len() as u64;
        assert_eq!(LoopRequest::decode(&words), None);
        for reply in [StartReply::Ready, StartReply::Rejected, StartReply::BuildFailed] {
            assert_eq!(StartReply::from_bytes(reply.to_bytes()), Some(reply));
        }
        assert_eq!(StartReply::from_bytes([9; 8]), None);
    }
}
