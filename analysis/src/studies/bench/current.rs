//! The cost of an instant of a bridge's current loop.

use std::path::Path;

use firmware_harness::bench_request::BenchRequest;
use firmware_harness::currents::{CurrentBench, Input};

use super::CORE_CLOCK;
use crate::emulator::{BenchClient, EmulatorError};

/// Instants of steps of the code, some of which end in a fault.
const INSTANTS: u32 = 4000;

/// Instants per second; and periods per second of the servo below them.
pub const INSTANT_RATE: f64 = 40e3;
/// The same of the servo.
pub const SERVO_RATE: f64 = 10e3;

/// Largest number of instructions of an instant, from a sample to compare values, of a brushed and of a
/// brushless motor.
///
/// # Errors
/// If the emulated board fails.
pub fn instant_instructions(elf: &Path) -> Result<[u32; 2], EmulatorError> {
    let mut board = BenchClient::boot(elf)?;
    let inputs: Vec<_> = (1..=INSTANTS).map(|instant| Input::of_steps(instant).0).collect();
    let mut most = [0; 2];
    for (most, bench) in most.iter_mut().zip(CurrentBench::ALL) {
        let outputs = board.compute(&BenchRequest::Current(bench), &inputs)?;
        *most = outputs.iter().map(|output| output.instructions).max().unwrap_or_default();
    }
    board.finish()?;
    Ok(most)
}

/// Instructions per second of the instants and of a servo with this number of instructions per period, in per
/// cent of the core's clock.
pub fn share_of_core(instant: f64, servo: f64) -> f64 {
    100.0 * (instant * INSTANT_RATE + servo * SERVO_RATE) / CORE_CLOCK
}
