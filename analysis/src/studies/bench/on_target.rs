//! The cost of a program's parts on the emulated board, in instructions.

use std::io::Write;
use std::path::Path;

use firmware_harness::bench_request::BenchRequest;
use firmware_harness::currents::{CurrentBench, Input};
use firmware_harness::tables::MAGNET;
use haptic_model::board::client::frame;
use haptic_servo::certificate::Parameter;
use haptic_servo::dac::DacCode;
use haptic_servo::environment::{Ends, Profile, Wall};
use haptic_servo::number::Arithmetic;
use haptic_servo::scene::{Coupling, Latency, Scene};
use haptic_servo::wire::host::{HostCommand, HostRequest};
use haptic_servo::wire::message::ToBoard;

use super::CORE_CLOCK;
use crate::emulator::plant_thread::{FixedCount, PlantThread};
use crate::emulator::{Client, Emulator, EmulatorError, EmulatorReport};
use crate::latency_limits::lag_of;
use crate::link::{Address, Link, RequestResult};
use crate::program::{damper_wall, knob};
use crate::studies::error::StudyError;
use crate::studies::number_format::Cost;

/// Instants of steps of a current loop's code, some of which end in a fault.
const INSTANTS: u32 = 4000;
/// Instants of a current loop per second; and periods per second of the servo below them.
const INSTANT_RATE: f64 = 40e3;
const SERVO_RATE: f64 = 10e3;
/// Ticks of a hand that goes in and out of a wall with varying speed.
const TICKS: u32 = 2048;
/// Ticks in which a host's torque rises, more than [`TICKS`].
const RAMP: u16 = 4096;

/// Largest number of instructions of an instant of a bridge's current loop, from a sample to compare values,
/// of a brushed and of a brushless motor.
pub fn instant_instructions(elf: &Path) -> Result<[u32; 2], EmulatorError> {
    let mut board = Client::boot(elf)?;
    let inputs: Vec<_> = (1..=INSTANTS).map(|instant| Input::of_steps(instant).0).collect();
    let mut most = [0; 2];
    for (most, bench) in most.iter_mut().zip(CurrentBench::ALL) {
        *most = Cost::of(&board.compute(&BenchRequest::Current(bench), &inputs)?).most;
    }
    board.finish()?;
    Ok(most)
}

/// Instructions per second of the instants and of a servo with this number of instructions per period, in per
/// cent of the core's clock.
pub fn share_of_core(instant: f64, servo: f64) -> f64 {
    100.0 * (instant * INSTANT_RATE + servo * SERVO_RATE) / CORE_CLOCK
}

/// Largest number of instructions of a tick behind the matched coupling, from count to code in contact, in
/// `f32`: for the damper wall without delay whose torques come 10 us after their counts, and for the same
/// with a current loop of 3 kHz.
pub fn contact_instructions(elf: &Path) -> Result<[u32; 2], EmulatorError> {
    let mut board = Client::boot(elf)?;
    let prompt = Latency::delayed(1e-5);
    let most = [
        most_in_contact(&mut board, prompt)?,
        most_in_contact(&mut board, prompt.with_actuator_lag(lag_of(3e3)))?,
    ];
    board.finish()?;
    Ok(most)
}

fn most_in_contact(board: &mut Client, latency: Latency) -> Result<u32, EmulatorError> {
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
    Ok(Cost::of(touches).most)
}

/// Swings of growing length around the face.
fn count(tick: u32) -> u32 {
    let turns = f64::from(tick) / 64.0;
    let count = 10.0 * turns * (std::f64::consts::TAU * turns).sin();
    (count as i32).cast_unsigned()
}

/// Torque profiles of 64 knots: gentle and too steep, late by one to three samples, with ends and without.
pub fn profiles() -> Vec<Scene> {
    let mut scenes = Vec::new();
    for torque in [0.02, 0.2, 20.0] {
        for delay in 1..=3 {
            for ends in [None, Some(Ends { from: -2.0, to: 2.0, stiffness: 12.0 })] {
                let profile = Profile { torque, ends, ..Profile::of(&MAGNET, delay) };
                scenes.push(Scene { environment: profile.alone(), ..knob::SCENE });
            }
        }
    }
    scenes
}

/// Largest number of instructions of a verdict on these profiles, and of the whole assessment with remedies.
pub fn verdict_instructions(elf: &Path) -> Result<[u64; 2], EmulatorError> {
    let mut board = Client::boot(elf)?;
    let mut most = [0; 2];
    for scene in profiles() {
        let reply = board.certify(&scene)?;
        let found = [reply.verdict_instructions, reply.instructions];
        most = std::array::from_fn(|i| most[i].max(found[i]));
    }
    board.finish()?;
    Ok(most)
}

/// Instructions of the whole interrupt at rest, as the emulated board measures them: of a program without a host,
/// or of one whose host's torque rises over thousands of ticks, a code every few.
pub fn at_rest(elf: &Path, torque: Option<f32>) -> Result<EmulatorReport, EmulatorError> {
    let mut board = Emulator::boot(elf)?;
    let mut port = board.arm_and_wait()?;
    let at_first = board.exchange(0)?;
    if let Some(torque) = torque {
        let command = HostCommand { number: 0, torque, ramp: RAMP };
        let bytes = frame(&ToBoard::Host(HostRequest::Torque(command)));
        port.write_all(&bytes).map_err(EmulatorError::Serial)?;
        while board.exchange(0)? == at_first {}
    }
    for _ in 0..TICKS {
        board.exchange(0)?;
    }
    board.finish()
}

/// The cost of certifying a set of parameters from a host on a running board.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LiveSet {
    /// Whether it was accepted.
    pub taken: bool,
    /// Instructions below the servo, from the frame's last byte to the answer's first.
    pub instructions: u64,
    /// Largest number of instructions of the servo's interrupt meanwhile, including requests.
    pub interrupt: u64,
    /// Bytes of the stack that were never used, before and after.
    pub stack_left: Option<u32>,
}

/// Sends a set to a program on the emulated board, whose servo runs meanwhile.
pub fn live_set(elf: &Path, changes: &[(Parameter, f64)]) -> Result<LiveSet, StudyError> {
    let mut emulator = Emulator::boot(elf)?;
    emulator.arm_and_wait()?;
    let plant = PlantThread::start(emulator, FixedCount(0));
    let mut link = Link::open(&Address::Unix(plant.port().to_owned()))?;
    let outcome = link.set(changes.iter().copied().collect())?;
    let stack_left = link.status()?.stack_left;
    let report = plant.end()?.finish()?;
    Ok(LiveSet {
        taken: outcome == RequestResult::Done,
        instructions: report.below_instructions.max,
        interrupt: report.interrupt_instructions.max,
        stack_left,
    })
}
