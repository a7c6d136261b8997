//! The program that measures a device by the bridge, and what the host makes of its record.

use std::f64::consts::TAU;
use std::fs;
use std::path::{Path, PathBuf};

use analysis::identify::Estimate;
use analysis::identify::{self, Correction, record, torque_source};
use analysis::sampled_actuator::SampledActuator;
use analysis::toolchain::{BoardModel, NumberFormat, Tools, TorqueOutput, prepare};
use haptic_servo::current::{CurrentLoop, Drive};
use haptic_servo::excitation::SWEEP_PROTOCOL;
use haptic_servo::magnetic::{Chip, MT6701};
use haptic_servo::output_timing::OutputTiming;
use haptic_servo::scene::{Device as Mechanics, Latency};
use haptic_servo::wire::sweep::SweepRequest;
use virtual_board::chip::B_G431B_ESC1;
use virtual_board::magnetic_encoder::MagneticEncoder;
use virtual_board::motor::Motor;

use super::bench::{boot_program, circuit, motor, supply};
use super::brushless::wired;
use super::paddle::{Driven, Shaft};
use super::{bridge_identify, bridge_wall, brushless_identify, brushless_wall};
use crate::bench::Bench;

/// Samples between two requests of a host that listens.
const LISTENING: u64 = 100;
/// Samples that an alignment takes at most.
const ALIGNMENT: u64 = 10_000;

/// A program, and what it is for.
struct Measurement {
    program: &'static str,
    motor: Motor,
    drive: Drive,
    device: Mechanics,
    counts_per_turn: f64,
    /// The magnetic encoder that it reads in place of a counter, and the age of its readings in s.
    chip: Option<(&'static Chip, f64)>,
    ticks: u64,
    current_loop: CurrentLoop,
    /// The least part of the device's passivity that is found.
    least: f64,
}

/// A device without a hand, whose motion is exact for a torque that stands still.
fn moves_freely(device: Mechanics) -> impl FnMut(&mut Shaft, f64, f64) + Send + 'static {
    move |shaft, torque, seconds| {
        let (settled, lag) = (torque / device.damping, device.inertia / device.damping);
        let gone = -(-seconds / lag).exp_m1();
        let off = shaft.speed - settled;
        shaft.angle += settled * seconds + off * lag * gone;
        shaft.speed -= off * gone;
    }
}

/// A board with the program.
fn booted(what: &Measurement) -> Bench {
    let device = Driven::new(what.counts_per_turn, moves_freely(what.device));
    let Some((chip, _)) = what.chip else {
        return boot_program(what.program, what.motor, device);
    };
    let mut bench = Bench::boot_file(&B_G431B_ESC1, &with_chip(what.program, chip), device);
    circuit(&mut bench).motor = Some(what.motor);
    bench.board_mut().magnetic = MagneticEncoder::find(chip.name, 0);
    bench
}

/// The file of a program for the shaft, which reads it by a chip.
fn with_chip(program: &str, chip: &Chip) -> PathBuf {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../firmware/src/bin");
    let read = |file: &str| fs::read_to_string(folder.join(file)).unwrap();
    let shaft =
        read("brushless_shaft/mod.rs").replace("CounterWidth::Bits16", "CounterWidth::Bits14");
    let name = chip.name.to_uppercase();
    let text = read(&format!("{program}.rs"))
        .replace("mod brushless_shaft;", &format!("mod brushless_shaft {{\n{shaft}}}"))
        .replace(
            "bridge: CURRENT_LOOP)",
            &format!("bridge: CURRENT_LOOP, encoder: haptic_servo::magnetic::{name})"),
        );
    let (toolchain, name) = (prepare(Tools::Compiler).unwrap(), format!("{program}_by_chip"));
    let written = toolchain.write_scene(&name, &text).unwrap();
    let output = Some((BoardModel::find(B_G431B_ESC1.name).unwrap(), TorqueOutput::Bridge));
    let built = toolchain.build_written(&written, output, NumberFormat::F32, Some(chip));
    built.unwrap_or_else(|error| panic!("{error}")).path
}

/// What a board sends of a sweep, from its description to its end.
fn recorded(what: &Measurement) -> String {
    let mut bench = booted(what);
    circuit(&mut bench).supply = supply(&what.drive);
    bench.run(20);
    bench.board_mut().send(&SweepRequest::Describe.frame());
    bench.run(LISTENING);
    bench.board_mut().send(&SweepRequest::BEGIN.frame());
    let mut sent = String::new();
    for _ in 0..(ALIGNMENT + what.ticks) / LISTENING {
        bench.run(LISTENING);
        let board = bench.board_mut();
        sent += std::str::from_utf8(&board.serial.take_sent()).unwrap();
        if sent.contains("\nend,") {
            break;
        }
        board.send(&SweepRequest::Listening.frame());
    }
    sent
}

fn assert_holds(name: &str, interval: Estimate, truth: f64) {
    let Estimate { value, lo, hi } = interval;
    println!("{name}: {truth} in {lo} to {hi}, {value}");
    assert!(lo <= truth && truth <= hi, "{name}: {truth} is not in {lo} to {hi}");
}

/// All of a sweep, as a host reads it from the wire: it finds the device beside the current loop, and measures how
/// late its torque is, which is what the certificate takes. Zero crossings of the current make the value a little
/// small.
fn measured(what: &Measurement) -> (record::Record, Correction) {
    let said = recorded(what);
    if let Ok(path) = std::env::var("BRIDGE_RECORD") {
        std::fs::write(path, &said).unwrap();
    }
    let (description, rest) = said.split_once('\n').unwrap();
    let head =
        format!("identify,{SWEEP_PROTOCOL},{PERIOD},{},{},", what.counts_per_turn, what.ticks);
    let limits = description.strip_prefix(&head).unwrap_or_else(|| panic!("{description}"));
    let numbers = limits.splitn(3, ',').last().unwrap();
    let (rows, end) = rest.trim_end().rsplit_once('\n').unwrap();
    assert!(end.starts_with("end,done,"), "{end}");
    let record = record::parse(what.program, rows.as_bytes(), TAU / what.counts_per_turn).unwrap();
    assert_eq!(record.torque.len() as u64, what.ticks);
    let source = torque_source::parse(numbers);
    assert!(source.is_some(), "{numbers}");
    let correction = Correction { source, ..Correction::of_encoder(what.counts_per_turn) };
    let found = identify::identify(&record, &correction).unwrap();
    println!("{found:?}");
    assert!(found.is_rigid(), "{}", found.misfit);
    assert_holds("inertia", found.inertia, what.device.inertia);
    assert_holds("damping", found.damping, what.device.damping);
    // The delay is a period of the modulation, and the lag is updated in each.
    let latency = what.current_loop.latency(OutputTiming::Latched);
    let age = what.chip.map_or(0.0, |(_, age)| age);
    let mean = latency.output_delay.middle() + mean_lag(&latency) + age;
    assert_holds("delay", found.mean_delay, mean);
    let Estimate { value, lo, .. } = found.mean_delay;
    assert!(
        (value - mean).abs() < 0.15 * mean && lo > 0.45 * mean,
        "{value} is not a measurement of {mean}"
    );
    let passivity = found.passivity().expect("it can be certified with");
    assert!(passivity < what.device.damping - what.current_loop.motion_loss());
    assert!(passivity > what.least * what.device.passivity.unwrap(), "{passivity}");
    (record, correction)
}

#[test]
fn the_host_measures_the_device_and_how_late_its_torque_is() {
    let device = bridge_wall::SCENE.device;
    let (record, correction) = measured(&Measurement {
        program: "bridge_identify",
        motor: motor(&bridge_wall::DRIVE),
        drive: bridge_wall::DRIVE,
        device,
        counts_per_turn: bridge_wall::TRANSDUCERS.counts_per_turn,
        chip: None,
        ticks: bridge_identify::SWEEP.ticks(),
        current_loop: bridge_identify::CURRENT_LOOP,
        least: 0.95,
    });
    // Without the current loop, a part of what it does is taken for the device.
    let plain = identify::identify(&record, &Correction { source: None, ..correction }).unwrap();
    let mass = plain.inertia.value - device.inertia;
    assert!(mass > 0.4 * device.inertia, "{mass}");
}

/// An update: the virtual board moves a motor's shaft at each update, so that the chip, which is selected 5.5 us
/// before it, has the position of the update before.
const AGE: f64 = 2.5e-5;

/// A brushless motor, aligned by the program itself; the numbers of its motor are those of a phase. An MT6701
/// reads its angle, which makes the delay longer.
#[test]
fn the_host_measures_a_device_with_a_brushless_motor_by_a_chip() {
    measured(&brushless());
}

/// A reading that fails beyond a late one ends the sweep, with the gates off.
#[test]
fn a_sweep_ends_where_the_chip_disappears() {
    let what = brushless();
    let mut bench = booted(&what);
    circuit(&mut bench).supply = supply(&what.drive);
    bench.run(20);
    bench.board_mut().send(&SweepRequest::BEGIN.frame());
    bench.run(LISTENING);
    assert!(bench.is_on());
    bench.board_mut().magnetic = None;
    bench.run(LISTENING);
    let sent = String::from_utf8(bench.board_mut().serial.take_sent()).unwrap();
    assert!(sent.contains("end,output-fault,"), "{sent}");
    assert!(!bench.is_on());
}

fn brushless() -> Measurement {
    Measurement {
        program: "brushless_identify",
        motor: wired([1, 0, 2], 0.7),
        drive: brushless_wall::DRIVE,
        device: brushless_wall::SCENE.device,
        counts_per_turn: brushless_wall::TRANSDUCERS.counts_per_turn,
        chip: Some((&MT6701, AGE)),
        ticks: brushless_identify::SWEEP.ticks(),
        current_loop: brushless_identify::CURRENT_LOOP,
        // Of little damping a sweep at these codes finds less.
        least: 0.8,
    }
}

/// Period in s of both programs.
const PERIOD: f64 = bridge_identify::PERIOD;

/// The mean delay in s of the lag with its updates, from its phase at a low frequency.
fn mean_lag(latency: &Latency) -> f64 {
    const SLOW: f64 = 1.0;
    -SampledActuator::of(latency, PERIOD).unwrap().response(SLOW).arg() / SLOW
}
