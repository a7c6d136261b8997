//! A magnetic encoder beside the bridge: its transfers before each update, their failures, and a motor that is aligned
//! once for ever.

use std::f64::consts::TAU;
use std::path::PathBuf;
use std::sync::{Arc, Mutex, OnceLock};

use analysis::controller::controller;
use analysis::file::bridge::MotorOnBridge;
use analysis::file::{Format, SceneFile, parse, program};
use analysis::toolchain::{BoardModel, NumberFormat, Tools, TorqueOutput, prepare};
use haptic_servo::current::IndexOffset;
use haptic_servo::fault::Fault;
use haptic_servo::magnetic::ReadingError;
use haptic_servo::servo::Transducers;
use haptic_servo::wire::message::Outcome;
use virtual_board::chip::B_G431B_ESC1;
use virtual_board::magnetic_encoder::{Failure, MagneticEncoder};
use virtual_board::peripheral::clock::Cause;
use virtual_board::power_stage::gate_log::off_since;

use super::bench::{INSTANT, circuit, code, gates, run_to_valley, supply};
use super::brushless::{Held, align, check_stays_off, check_torque_of, wired_to};
use super::paddle::shaft_of;
use crate::bench::{Bench, MID_SCALE};

/// A wall in front of a gimbal motor, read by an MT6701.
const KNOB: &str = include_str!("magnetic_knob.toml");
/// Electrical angle in rad of the magnets at the angle zero.
const MAGNETS: f64 = 0.7;
const POLE_PAIRS: f64 = 7.0;
const COUNTS: f64 = 16_384.0;

/// The scene with its motor, and the file of its program.
struct Knob {
    file: SceneFile,
    transducers: Transducers,
    bridge: MotorOnBridge,
    program: PathBuf,
}

impl Knob {
    fn build(name: &str, text: &str) -> Self {
        let file = parse(name, Format::Toml, text).unwrap_or_else(|error| panic!("{error}"));
        let transducers = file.board_transducers(None, None).unwrap();
        let bridge = file.on_bridge(&transducers).unwrap();
        let text = program::program(&file, &transducers, Some(&bridge), name).unwrap();
        let toolchain = prepare(Tools::Compiler).unwrap_or_else(|error| panic!("{error}"));
        let board = BoardModel::find(B_G431B_ESC1.name).unwrap();
        let written = toolchain.write_scene(name, &text).unwrap();
        let output = Some((board, TorqueOutput::Bridge));
        let built = toolchain.build_written(&written, output, NumberFormat::F32, true);
        let program = built.unwrap_or_else(|error| panic!("{error}")).path;
        Self { file, transducers, bridge, program }
    }
}

/// What a board tells of the motor: the electrical angle at the angle zero, in counts.
fn offset() -> IndexOffset {
    let counts = (MAGNETS / TAU * COUNTS / POLE_PAIRS).round() as u32;
    IndexOffset { counts, is_reversed: false }
}

/// Without the phase, and with the phase that the motor has.
fn knobs() -> &'static [Knob; 2] {
    static KNOBS: OnceLock<[Knob; 2]> = OnceLock::new();
    KNOBS.get_or_init(|| {
        let IndexOffset { counts, is_reversed } = offset();
        let index = format!("index_offset = {{ counts = {counts}, is_reversed = {is_reversed} }}");
        let aligned = KNOB.replace("[motor]\n", &format!("[motor]\n{index}\n"));
        [Knob::build("magnetic_knob", KNOB), Knob::build("aligned_knob", &aligned)]
    })
}

/// A board with a program, whose motor has its magnets there.
fn boot(knob: &Knob, magnets: f64) -> Held {
    let Knob { file, transducers, bridge, program } = knob;
    let drive = bridge.current_loop.drive();
    let hand = Arc::<Mutex<f64>>::default();
    let device = shaft_of(file.scene.device, transducers.counts_per_turn, hand.clone());
    let mut bench = Bench::boot_file(&B_G431B_ESC1, program, device);
    let circuit = circuit(&mut bench);
    circuit.motor = Some(wired_to(drive, [0, 1, 2], magnets));
    circuit.supply = supply(drive);
    let board = bench.board_mut();
    (board.magnetic, board.gates) = (MagneticEncoder::find("mt6701", 0), Some(Vec::new()));
    bench.run(200);
    Held { bench, hand }
}

fn told(bench: &mut Bench) -> Option<IndexOffset> {
    bench.status().power.and_then(|power| power.index)
}

/// A hand leans against the wall, and comes to rest with the torque of its code.
fn leaning() -> Held {
    let mut held = boot(&knobs()[1], MAGNETS);
    check_torque_of(&mut held, &knobs()[0].transducers, "by the stated phase");
    held
}

/// After one alignment a board tells the phase at the encoder's zero; a program that states it needs no other, and no
/// turn of the handle either.
#[test]
fn a_motor_is_aligned_once() {
    let mut held = boot(&knobs()[0], MAGNETS);
    check_stays_off(&mut held.bench);
    let fault = held.bench.fault().unwrap().to_string();
    assert!(fault.contains("not been aligned with its encoder: align it"), "{fault}");
    align(&mut held.bench);
    let found = told(&mut held.bench).unwrap();
    println!("{found:?} of {:?}", offset());
    assert!(found.counts.abs_diff(offset().counts) < 30 && !found.is_reversed);
    check_torque_of(&mut held, &knobs()[0].transducers, "aligned");
    let mut held = leaning();
    assert_eq!(told(&mut held.bench), Some(offset()));
    held.push(0.0);
    held.bench.machine.reset(Cause::Pin);
    held.bench.run(200);
    assert_eq!(told(&mut held.bench), Some(offset()));
    check_torque_of(&mut held, &knobs()[0].transducers, "after a reset");
}

/// A pulse of torque moves the handle not at all, or the wrong way.
#[test]
fn the_phase_of_another_motor_is_found_out() {
    let mut held = boot(&knobs()[1], MAGNETS + 1.2);
    held.bench.arm();
    held.bench.run(200);
    let fault = held.bench.fault();
    assert_eq!(fault.map(Fault::as_str), Some("index-offset"), "{fault:?}");
}

/// Each code is that of the angle that was read for its period.
#[test]
fn the_codes_are_the_host_s() {
    const PERIODS: usize = 4000;
    let Knob { file, transducers, .. } = &knobs()[1];
    let certified = file.scene.certify().unwrap();
    let mut host = controller::<_, f32>(&certified, transducers).unwrap();
    let mut held = boot(&knobs()[1], MAGNETS);
    assert_eq!(held.bench.arm(), Outcome::Done);
    held.bench.run(600);
    let (mut pushed, mut count) = (0, 0);
    for period in 0..PERIODS {
        held.push(0.08 * (period as f64 * 0.004).sin());
        held.bench.run(1);
        let board = held.bench.board();
        let angle = board.magnetic.as_ref().unwrap().sampled;
        // The hand turns it by more than half a turn.
        let step = (angle as i32 - count).rem_euclid(1 << 14);
        count += if step < 1 << 13 { step } else { step - (1 << 14) };
        // The code that the current loop follows from here on; the scene is late by the period before.
        let (code, expected) = (code(&mut held.bench), host.tick(count).code);
        if period > 10 {
            assert_eq!(code, expected, "period {period}, angle {angle}");
            pushed += usize::from(code != MID_SCALE);
        }
    }
    assert!(pushed > PERIODS / 10, "{pushed}");
    assert_eq!(held.bench.fault(), None);
}

/// The stated age leaves room for one transfer that fails: it is held. A second one takes the gates away.
#[test]
fn a_failed_transfer_is_held_and_two_are_a_fault() {
    let mut held = leaning();
    held.push(0.0);
    let bench = &mut held.bench;
    bench.run(1000);
    let fail = |bench: &mut Bench, failure, instants: u64| {
        bench.board_mut().magnetic.as_mut().unwrap().failure = failure;
        bench.run_for(instants * INSTANT);
    };
    for (failure, error) in [
        (Failure::Bit(3), ReadingError::Checksum),
        (Failure::Zeros, ReadingError::Zeros),
        (Failure::Ones, ReadingError::Ones),
        (Failure::WeakField, ReadingError::Field),
    ] {
        run_to_valley(bench);
        for _ in 0..50 {
            fail(bench, Some(failure), 1);
            fail(bench, None, 1);
        }
        assert_eq!((bench.fault(), bench.is_on()), (None, true), "{failure:?}");
        run_to_valley(bench);
        fail(bench, Some(failure), 3);
        let (now, off) = (bench.now(), off_since(gates(bench)));
        // The second transfer ends at the second update, and the interrupt comes a us later.
        let off = off.unwrap_or_else(|| panic!("{failure:?}: on"));
        let late = INSTANT as i64 - (now - off) as i64;
        println!("{failure:?}: off {late} clocks after the update of the second failure");
        assert!((0..1000).contains(&late), "{late}");
        let error = error as u32;
        assert_eq!(bench.fault(), Some(Fault::EncoderReading { error, allowed: 1 }));
        fail(bench, None, 1);
        bench.run(20);
        assert_eq!(bench.arm(), Outcome::Done);
        bench.run(600);
    }
}
