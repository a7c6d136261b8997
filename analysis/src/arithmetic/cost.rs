//! What a tick takes on the emulated board in a format.

use firmware::board::trial::{Output, Trial};
use firmware::number::Arithmetic;

use super::Motion;
use crate::command::CommandError;
use crate::emulator::Trials;

/// Instructions of a tick from count to code, on the emulated board.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cost {
    /// The most that a tick takes.
    pub most: u32,
    /// Their mean.
    pub mean: f64,
    /// Ticks whose torque and code are those of this machine, to the bit.
    pub equal: usize,
}

/// Has the board follow a motion.
///
/// # Errors
/// Where the scene cannot be had in this format, or the board fails or has no program for it.
pub fn cost(
    board: &mut Trials,
    motion: &Motion,
    arithmetic: Arithmetic,
) -> Result<Cost, CommandError> {
    let here = motion.torques(arithmetic)?;
    let units = motion.subject().units(arithmetic);
    let (scene, transducers) = motion.subject().scaled(arithmetic);
    let trial = Trial::Servo { scene, transducers, arithmetic };
    let counts: Vec<_> = motion.counts().iter().map(|count| count.cast_unsigned()).collect();
    let there = board.compute(&trial, &counts)?;
    let pairs = here.iter().zip(&there);
    let is_equal = |((torque, code), there): &(&(f64, u16), &Output)| {
        torque.to_bits() == (there.value * units.torque).to_bits() && *code == there.code
    };
    let equal = pairs.filter(is_equal).count();
    let instructions = there.iter().map(|output| output.instructions);
    let most = instructions.clone().max().unwrap_or_default();
    let mean = instructions.map(f64::from).sum::<f64>() / there.len() as f64;
    Ok(Cost { most, mean, equal })
}
