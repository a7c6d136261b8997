//! The program that measures a device by the bridge, and what the host makes of its record.

use std::f64::consts::TAU;

use analysis::identify::Estimate;
use analysis::identify::{self, Correction, record, torque_source};
use analysis::sampled_actuator::SampledActuator;
use haptic_servo::excitation::SWEEP_PROTOCOL;
use haptic_servo::output_timing::OutputTiming;
use haptic_servo::scene::{Device as Mechanics, Latency};
use haptic_servo::wire::sweep::SweepRequest;
use virtual_board::motor::Motor;

use super::bench::{boot_program, motor};

use super::bridge_identify::{CURRENT_LOOP, LIMITS, PERIOD, SWEEP, TRANSDUCERS};
use super::bridge_wall::{DRIVE, SCENE};
use super::paddle::{Driven, Shaft};

/// That of `bridge_wall`, which the program is for.
const DEVICE: Mechanics = SCENE.device;

/// Samples between two requests of a host that listens.
const LISTENING: u64 = 100;

/// The device without a hand, whose motion is exact for a torque that stands still.
fn moves_freely(shaft: &mut Shaft, torque: f64, seconds: f64) {
    let (settled, lag) = (torque / DEVICE.damping, DEVICE.inertia / DEVICE.damping);
    let gone = -(-seconds / lag).exp_m1();
    let off = shaft.speed - settled;
    shaft.angle += settled * seconds + off * lag * gone;
    shaft.speed -= off * gone;
}

/// What a board with this motor sends of a sweep, from its description to its end.
fn recorded(motor: Motor) -> String {
    let device = Driven::new(TRANSDUCERS.counts_per_turn, moves_freely);
    let mut bench = boot_program("bridge_identify", motor, device);
    bench.run(20);
    bench.board_mut().send(&SweepRequest::Describe.frame());
    bench.run(LISTENING);
    bench.board_mut().send(&SweepRequest::BEGIN.frame());
    let mut sent = Vec::new();
    for _ in 0..SWEEP.ticks() / LISTENING + 2 {
        bench.run(LISTENING);
        let board = bench.board_mut();
        sent.extend(board.serial.take_sent());
        board.send(&SweepRequest::Listening.frame());
    }
    String::from_utf8(sent).unwrap()
}

fn assert_holds(name: &str, interval: Estimate, truth: f64) {
    let Estimate { value, lo, hi } = interval;
    println!("{name}: {truth} in {lo} to {hi}, {value}");
    assert!(lo <= truth && truth <= hi, "{name}: {truth} is not in {lo} to {hi}");
}

/// All of a sweep, as a host reads it from the wire: it finds the device beside the current loop, and measures how
/// late its torque is, which is what the certificate of `bridge_wall` takes. Zero crossings of the current make the
/// value a little small.
#[test]
fn the_host_measures_the_device_and_how_late_its_torque_is() {
    let said = recorded(motor(&DRIVE));
    if let Ok(path) = std::env::var("BRIDGE_RECORD") {
        std::fs::write(path, &said).unwrap();
    }
    let (description, rest) = said.split_once('\n').unwrap();
    let head = format!(
        "identify,{SWEEP_PROTOCOL},{PERIOD},{},{},{},{},",
        TRANSDUCERS.counts_per_turn,
        SWEEP.ticks(),
        LIMITS.travel,
        LIMITS.speed
    );
    let numbers = description.strip_prefix(&head).unwrap_or_else(|| panic!("{description}"));
    let (rows, end) = rest.trim_end().rsplit_once('\n').unwrap();
    assert!(end.starts_with("end,done,"), "{end}");
    let record =
        record::parse("bridge_identify", rows.as_bytes(), TAU / TRANSDUCERS.counts_per_turn)
            .unwrap();
    assert_eq!(record.torque.len() as u64, SWEEP.ticks());
    let source = torque_source::parse(numbers);
    assert!(source.is_some(), "{numbers}");
    let correction = Correction { source, ..Correction::of_encoder(TRANSDUCERS.counts_per_turn) };
    let found = identify::identify(&record, &correction).unwrap();
    println!("{found:?}");
    assert!(found.is_rigid(), "{}", found.misfit);
    assert_holds("inertia", found.inertia, DEVICE.inertia);
    assert_holds("damping", found.damping, DEVICE.damping);
    // The delay is a period of the modulation, and the lag is updated in each.
    let latency = CURRENT_LOOP.latency(OutputTiming::Latched);
    let mean = latency.output_delay.middle() + mean_lag(&latency);
    assert_holds("delay", found.mean_delay, mean);
    let Estimate { value, lo, .. } = found.mean_delay;
    assert!(
        (value - mean).abs() < 0.15 * mean && lo > 0.45 * mean,
        "{value} is not a measurement of {mean}"
    );
    let passivity = found.passivity().expect("it can be certified with");
    assert!(passivity < DEVICE.damping - CURRENT_LOOP.motion_loss());
    assert!(passivity > 0.95 * DEVICE.passivity.unwrap(), "{passivity}");
    // Without the current loop, a part of what it does is taken for the device.
    let plain = identify::identify(&record, &Correction { source: None, ..correction }).unwrap();
    let mass = plain.inertia.value - DEVICE.inertia;
    assert!(mass > 0.4 * DEVICE.inertia, "{mass}");
}

/// The mean delay in s of the lag with its updates, from its phase at a low frequency.
fn mean_lag(latency: &Latency) -> f64 {
    const SLOW: f64 = 1.0;
    -SampledActuator::of(latency, PERIOD).unwrap().response(SLOW).arg() / SLOW
}
