//! What an instant of a bridge's current loop costs.

use std::path::Path;

use firmware_harness::bench_request::BenchRequest;
use firmware_harness::currents::{CurrentBench, Input};

use super::CORE_CLOCK;
use crate::emulator::{BenchClient, EmulatorError};

/// Instants of steps of the code, some of which end in a fault.
const INSTANTS: u32 = 4000;

/// Instants a second, and periods a second of the servo below them.
pub const INSTANT_RATE: f64 = 40e3;
/// The same of the servo.
pub const SERVO_RATE: f64 = 10e3;

/// Most instructions of an instant of a brushed motor, and of a brushless one, from a sample to compare values.
///
/// # Errors
/// Where the emulated board fails.
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

/// Instructions a second of instants and of a servo with so many instructions in a period, in per cent of the
/// core's clock.
pub fn share_of_core(instant: f64, servo: f64) -> f64 {
    100.0 * (instant * INSTANT_RATE + servo * SERVO_RATE) / CORE_CLOCK
}
