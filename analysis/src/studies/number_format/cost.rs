//! The cost of a tick on the emulated board in a format.

use firmware_harness::bench_request::{BenchRequest, Output};
use haptic_servo::number::Arithmetic;

use super::Motion;
use crate::emulator::Client;
use crate::studies::error::StudyError;

/// Instructions of a tick from count to code, on the emulated board.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cost {
    /// The largest number.
    pub most: u32,
    /// Their mean.
    pub mean: f64,
}

impl Cost {
    /// Of a board's outputs.
    pub fn of<'o>(outputs: impl IntoIterator<Item = &'o Output>) -> Self {
        let all: Vec<_> = outputs.into_iter().map(|output| output.instructions).collect();
        let sum: f64 = all.iter().copied().map(f64::from).sum();
        Self { most: all.iter().copied().max().unwrap_or(0), mean: sum / all.len() as f64 }
    }
}

/// Runs a motion on the board and on this machine.
pub fn cost(
    board: &mut Client,
    motion: &Motion,
    arithmetic: Arithmetic,
) -> Result<Cost, StudyError> {
    let here = motion.torques(arithmetic)?;
    let units = motion.problem().units(arithmetic);
    let (scene, transducers) = motion.problem().scaled(arithmetic);
    let request = BenchRequest::Servo { scene, transducers, arithmetic };
    let counts: Vec<_> = motion.counts().iter().map(|count| count.cast_unsigned()).collect();
    let there = board.compute(&request, &counts)?;
    let bits = |torque: f64, code| (torque.to_bits(), code);
    let mut pairs = here.iter().zip(&there);
    let differs = pairs.position(|(&(torque, code), there)| {
        bits(torque, code) != bits(there.value * units.torque, there.code)
    });
    if let Some(tick) = differs {
        return Err(StudyError::Differs { format: arithmetic.name(), tick });
    }
    Ok(Cost::of(&there))
}
