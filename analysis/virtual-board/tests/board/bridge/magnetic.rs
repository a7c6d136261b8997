//! Magnetic encoders beside the bridge: their transfers before each update, their failures, a chip that is not there,
//! and a motor that is aligned once for ever.

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
use haptic_servo::wire::message::{FaultCode, Outcome, Refusal, ToBoard};
use virtual_board::chip::B_G431B_ESC1;
use virtual_board::magnetic_encoder::{Failure, MagneticEncoder};
use virtual_board::peripheral::clock::Cause;
use virtual_board::power_stage::gate_log::{any_high, off_since};

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
        let bridge = file.on_bridge(&transducers).unwrap().unwrap();
        let text = program::program(&file, &transducers, Some(&bridge), name).unwrap();
        let toolchain = prepare(Tools::Compiler).unwrap_or_else(|error| panic!("{error}"));
        let board = BoardModel::find(B_G431B_ESC1.name).unwrap();
        let written = toolchain.write_scene(name, &text).unwrap();
        let output = Some((board, TorqueOutput::Bridge));
        let built = toolchain.build_written(&written, output, NumberFormat::F32, file.chip);
        let program = built.unwrap_or_else(|error| panic!("{error}")).path;
        Self { file, transducers, bridge, program }
    }

    /// The chip, whose noise is what its driver takes for granted.
    fn encoder(&self) -> MagneticEncoder {
        let chip = self.file.chip.unwrap();
        let mut encoder = MagneticEncoder::find(chip.name, 0).unwrap();
        encoder.noise = if chip.frozen_after.is_some() { 3 } else { 0 };
        encoder
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
    let chip = knob.encoder();
    let mut held = off(knob, magnets, Some(chip));
    held.bench.run(200);
    held
}

/// The same before its first instruction, with a chip or without one.
fn off(knob: &Knob, magnets: f64, chip: Option<MagneticEncoder>) -> Held {
    let Knob { file, transducers, bridge, program } = knob;
    let drive = bridge.current_loop.drive();
    let hand = Arc::<Mutex<f64>>::default();
    let device = shaft_of(file.scene.device, transducers.counts_per_turn, hand.clone());
    let mut bench = Bench::boot_file(&B_G431B_ESC1, program, device);
    let circuit = circuit(&mut bench);
    circuit.motor = Some(wired_to(drive, [0, 1, 2], magnets));
    circuit.supply = supply(drive);
    let board = bench.board_mut();
    (board.magnetic, board.gates) = (chip, Some(Vec::new()));
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
    check_codes(&knobs()[1]);
}

fn check_codes(knob: &Knob) {
    // The hand goes to either side.
    const PERIODS: usize = 2000;
    let Knob { file, transducers, .. } = knob;
    let chip = file.chip.unwrap();
    let certified = file.scene.certify().unwrap();
    let mut host = controller::<_, f32>(&certified, transducers).unwrap();
    let mut held = boot(knob, MAGNETS);
    assert_eq!(held.bench.arm(), Outcome::Done, "{:?}", held.bench.fault());
    held.bench.run(600);
    let (mut pushed, mut count) = (0, 0);
    let turn = transducers.counts_per_turn as i32;
    for period in 0..PERIODS {
        held.push(0.08 * (period as f64 * 0.004).sin());
        held.bench.run(1);
        let encoder = held.bench.board().magnetic.as_ref().unwrap();
        // The answer in this transfer is that of the one before.
        let angle = if chip.is_period_late { encoder.answered } else { encoder.sampled };
        // The hand turns it by more than half a turn.
        let step = (angle as i32 - count).rem_euclid(turn);
        count += if step < turn / 2 { step } else { step - turn };
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
    check_failures(
        &knobs()[1],
        [
            (Failure::Bit(3), ReadingError::Checksum),
            (Failure::Zeros, ReadingError::Zeros),
            (Failure::Ones, ReadingError::Ones),
            (Failure::WeakField, ReadingError::Field),
        ],
    );
}

fn check_failures<const N: usize>(knob: &Knob, failures: [(Failure, ReadingError); N]) {
    let mut held = boot(knob, MAGNETS);
    check_torque_of(&mut held, &knob.transducers, "by the stated phase");
    held.push(0.0);
    let bench = &mut held.bench;
    bench.run(1000);
    let fail = |bench: &mut Bench, failure, instants: u64| {
        bench.board_mut().magnetic.as_mut().unwrap().failure = failure;
        bench.run_for(instants * INSTANT);
    };
    for (failure, error) in failures {
        // The flag of an AS504x is in the next transfer, and stays until it is read.
        let stays = error == ReadingError::Flag && knob.file.chip.unwrap().is_period_late;
        run_to_valley(bench);
        for _ in 0..if stays { 0 } else { 50 } {
            fail(bench, Some(failure), 1);
            fail(bench, None, 1);
        }
        assert_eq!((bench.fault(), bench.is_on()), (None, true), "{failure:?}");
        run_to_valley(bench);
        fail(bench, Some(failure), 3 + u64::from(stays));
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

/// The scene with another chip.
fn knob_with(chip: &str, age: &str, noise: u32) -> Knob {
    let IndexOffset { counts, is_reversed } = offset();
    let counts = match chip {
        "mt6835" => counts << 7,
        "ma702" => counts << 2,
        _ => counts,
    };
    let text = KNOB
        .replace("mt6701", chip)
        .replace("age = [4.5e-6, 4.2e-5]", &format!("age = {age}"))
        .replace("noise = 2\n", &format!("noise = {noise}\n"))
        .replace(
            "[motor]\n",
            &format!(
                "[motor]\nindex_offset = {{ counts = {counts}, is_reversed = {is_reversed} }}\n"
            ),
        );
    Knob::build(&format!("{chip}_knob"), &text)
}

#[test]
fn an_mt6835_is_read_beside_the_bridge() {
    let knob = knob_with("mt6835", "[4.5e-6, 4.2e-5]", 3);
    check_codes(&knob);
    check_failures(
        &knob,
        [
            (Failure::Bit(9), ReadingError::Checksum),
            (Failure::Zeros, ReadingError::Zeros),
            (Failure::WeakField, ReadingError::Field),
            (Failure::Flag, ReadingError::Flag),
        ],
    );
}

/// Its failures are those of an AS5047P.
#[test]
fn an_as5048a_is_read_beside_the_bridge() {
    check_codes(&knob_with("as5048a", "[1.06e-4, 2.51e-4]", 3));
}

/// The model of the chip reads without its filter, which the certificate has.
#[test]
fn an_ma_chip_is_read_beside_the_bridge() {
    let knob = knob_with("ma702", "[4.5e-6, 4.2e-5]\nlag = 5.3e-5", 3);
    check_codes(&knob);
    check_failures(&knob, [(Failure::Zeros, ReadingError::Zeros)]);
}

#[test]
fn an_as5047p_is_read_beside_the_bridge() {
    let knob = knob_with("as5047p", "[1.05e-4, 1.64e-4]", 3);
    check_codes(&knob);
    check_failures(
        &knob,
        [
            (Failure::Bit(9), ReadingError::Parity),
            (Failure::Zeros, ReadingError::Zeros),
            (Failure::Ones, ReadingError::Ones),
            (Failure::Flag, ReadingError::Flag),
        ],
    );
    // No angle tells that there is no magnet: asked once, it stays a fault until the next reset.
    let mut encoder = knob.encoder();
    encoder.failure = Some(Failure::WeakField);
    let mut held = off(&knob, MAGNETS, Some(encoder));
    check_refused(&mut held.bench, ReadingError::Field);
    held.bench.board_mut().magnetic.as_mut().unwrap().failure = None;
    check_refused(&mut held.bench, ReadingError::Field);
    held.bench.machine.reset(Cause::Pin);
    held.bench.run(200);
    assert_eq!(held.bench.arm(), Outcome::Done);
}

/// Neither armed nor aligned: no gate is high, and the answers name the fault.
fn check_refused(bench: &mut Bench, error: ReadingError) {
    bench.run(200);
    let fault = FaultCode::from(Fault::EncoderReading { error: error as u32, allowed: 1 });
    for _ in 0..2 {
        assert_eq!(bench.arm(), Outcome::Refused(Refusal::Fault(fault)));
        bench.run(50);
        let told = bench.request(|id| ToBoard::Align { id });
        assert_eq!(told, Outcome::Refused(Refusal::NotAligning(Some(fault))));
        bench.run(50);
    }
    assert!(!any_high(gates(bench), 0, u64::MAX), "{error:?}: a gate was high");
}

/// A wire at ground, an open wire, and no magnet, before any torque; and then all is well.
#[test]
fn a_chip_that_is_not_there_is_a_fault_before_any_torque() {
    for (failure, error) in [
        (Some(Failure::Zeros), ReadingError::Zeros),
        (Some(Failure::Ones), ReadingError::Ones),
        (Some(Failure::WeakField), ReadingError::Field),
        (None, ReadingError::Ones),
    ] {
        for knob in knobs() {
            let mut encoder = knob.encoder();
            encoder.failure = failure;
            // Its zero is where a word of zeros is an angle.
            let mut held = off(knob, MAGNETS, failure.map(|_| encoder));
            check_refused(&mut held.bench, error);
        }
    }
    let mut held = off(&knobs()[1], MAGNETS, None);
    check_refused(&mut held.bench, ReadingError::Ones);
    held.bench.board_mut().magnetic = Some(knobs()[1].encoder());
    held.bench.run(20);
    assert_eq!(held.bench.arm(), Outcome::Done);
    held.bench.run(600);
    assert_eq!((held.bench.fault(), held.bench.is_on()), (None, true));
    // It disappears.
    run_to_valley(&mut held.bench);
    held.bench.board_mut().magnetic = None;
    held.bench.run_for(3 * INSTANT);
    assert!(off_since(gates(&held.bench)).is_some());
    let error = ReadingError::Ones as u32;
    assert_eq!(held.bench.fault(), Some(Fault::EncoderReading { error, allowed: 1 }));
}

/// All words of a handle that rests at zero are zeros. A wire at ground there is told by its level.
#[test]
fn a_knob_may_rest_at_zero() {
    let mut held = boot(&knobs()[1], MAGNETS);
    let bench = &mut held.bench;
    assert_eq!(bench.status().count, 0);
    assert_eq!(bench.arm(), Outcome::Done);
    bench.run(600);
    // The pulses that check the phase have moved it by some counts.
    bench.board_mut().magnetic = Some(knobs()[1].encoder());
    bench.run(4000);
    assert_eq!((bench.fault(), bench.is_on(), bench.status().count), (None, true, 0));
    run_to_valley(bench);
    bench.board_mut().magnetic.as_mut().unwrap().failure = Some(Failure::Zeros);
    bench.run_for(4 * INSTANT);
    assert!(off_since(gates(bench)).is_some());
    let error = ReadingError::Zeros as u32;
    assert_eq!(bench.fault(), Some(Fault::EncoderReading { error, allowed: 1 }));
}
