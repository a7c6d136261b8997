//! The cost of a tick behind the matched coupling.

use std::path::Path;

use firmware_harness::bench_request::BenchRequest;
use haptic_servo::dac::DacCode;
use haptic_servo::environment::Wall;
use haptic_servo::number::Arithmetic;
use haptic_servo::scene::{Coupling, Latency, Scene};

use crate::emulator::{BenchClient, EmulatorError};
use crate::latency_limits::lag_of;
use crate::program::damper_wall;

/// Ticks of a hand that goes in and out of the wall with varying speed.
const TICKS: u32 = 2048;

/// Largest number of instructions of a tick from count to code in contact, in `f32`: for the damper wall
/// without delay whose torques come 10 us after their counts, and for the same with a current loop of 3 kHz.
///
/// # Errors
/// If the emulated board fails.
pub fn contact_instructions(elf: &Path) -> Result<[u32; 2], EmulatorError> {
    let mut board = BenchClient::boot(elf)?;
    let prompt = Latency::delayed(1e-5);
    let most = [
        most_in_contact(&mut board, prompt)?,
        most_in_contact(&mut board, prompt.with_actuator_lag(lag_of(3e3)))?,
    ];
    board.finish()?;
    Ok(most)
}

fn most_in_contact(board: &mut BenchClient, latency: Latency) -> Result<u32, EmulatorError> {
    let scene = damper_wall::SCENE;
    let environment = Wall::damped(22.0, 0.01, 0).behind(0.0).alone();
    let request = BenchRequest::Servo {
        scene: Scene { environment, coupling: Coupling::Matched, latency, ..scene },
        transducers: damper_wall::TRANSDUCERS,
        arithmetic: Arithmetic::F32,
    };
    let counts: Vec<_> = (0..TICKS).map(count).collect();
    let outputs = board.compute(&request, &counts)?;
    let touches = outputs.iter().filter(|output| output.code != DacCode::MID_SCALE.get());
    Ok(touches.map(|output| output.instructions).max().unwrap_or_default())
}

/// Swings of growing length around the face.
fn count(tick: u32) -> u32 {
    let turns = f64::from(tick) / 64.0;
    let count = 10.0 * turns * (std::f64::consts::TAU * turns).sin();
    (count as i32).cast_unsigned()
}
