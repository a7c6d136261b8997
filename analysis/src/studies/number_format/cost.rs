//! The cost of a tick on the emulated board in a format.

use firmware_harness::bench_request::BenchRequest;
use haptic_servo::number::Arithmetic;

use super::{FormatError, Motion};
use crate::emulator::BenchClient;

/// Instructions of a tick from count to code, on the emulated board.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cost {
    /// The largest number.
    pub most: u32,
    /// Their mean.
    pub mean: f64,
}

/// Runs a motion on the board and on this machine.
///
/// # Errors
/// If the scene cannot be represented in this format, if the board fails or has no program for it, or if a
/// torque or a code of the board differs from this machine's in any bit.
pub fn cost(
    board: &mut BenchClient,
    motion: &Motion,
    arithmetic: Arithmetic,
) -> Result<Cost, FormatError> {
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
        return Err(FormatError::Differs { format: arithmetic.name(), tick });
    }
    let instructions = there.iter().map(|output| output.instructions);
    let most = instructions.clone().max().unwrap_or_default();
    let mean = instructions.map(f64::from).sum::<f64>() / there.len() as f64;
    Ok(Cost { most, mean })
}
