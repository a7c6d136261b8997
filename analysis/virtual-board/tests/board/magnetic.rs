//! Magnetic encoders: the drivers against models of the chips, and a wall on a board that reads one.

use std::f64::consts::TAU;
use std::path::{Path, PathBuf};
use std::sync::OnceLock;

use analysis::file::{DeviceFile, Format, SceneFile, parse, parse_device, program};
use analysis::hand::HandTrajectory;
use analysis::identify::rig::{DrivenDevice, MeasuredDevice, Sensing, torque_of};
use analysis::identify::{Correction, Estimate, record, slow_turns};
use analysis::lockstep::SimulatedDevice;
use analysis::missed::Missed;
use analysis::program::turns;
use analysis::simulation::plant::Plant;
use analysis::toolchain::{
    BoardModel, NumberFormat, OtherDevice, Sources, Tools, TorqueOutput, prepare,
};
use haptic_servo::excitation::Exciter;
use haptic_servo::fault::Fault;
use haptic_servo::magnetic::{Chip, Frame, LONGEST, ReadingError};
use haptic_servo::servo::{Latched, Transducers};
use haptic_servo::wire::sweep::SweepRequest;
use virtual_board::chip::NUCLEO_G474RE;
use virtual_board::device::{Device, FixedDevice};
use virtual_board::magnetic_encoder::{Failure, MagneticEncoder};
use virtual_board::peripheral::clock::Cause;

use crate::bench::{Bench, MID_SCALE};
use crate::device::HandHeldDevice;
use crate::scenes::with_the_same_cycle;
use crate::stub::{Masks, hold_up};

/// The wall of docs/encoders.md.
const WALL: &str = include_str!("magnetic_wall.toml");
/// Counts from zero into the wall, whose face is at 261 counts.
const INTO: i64 = 300;
/// Samples in which the clamp opens.
const OPEN: u64 = 110;

/// A transfer as a master with the driver's interface makes it.
fn transfer(chip: &Chip, model: &mut MagneticEncoder, words: &Frame, now: u64) -> Frame {
    // CPHA is 1, and CPOL by the level at rest.
    model.select(now, 0b01 | u32::from(chip.interface.idle_high) << 1);
    let mut frame = [0; LONGEST];
    for (word, received) in words.iter().zip(&mut frame).take(chip.interface.words) {
        for bit in (0..chip.interface.word_bits).rev() {
            *received = *received << 1 | u16::from(model.clock(word >> bit & 1 != 0));
        }
    }
    model.release(now);
    frame
}

/// A model that is set up and has answered once.
fn started(chip: &Chip, position: i64) -> MagneticEncoder {
    let mut model = MagneticEncoder::find(chip.name, position).unwrap();
    for words in chip.set_up.iter().chain([&chip.command; 2]) {
        transfer(chip, &mut model, words, 0);
    }
    model
}

#[test]
fn each_driver_reads_its_chip() {
    for chip in Chip::ALL {
        let mut model = started(chip, 1);
        assert_eq!(f64::from(1 << model.bits()), chip.counts_per_turn(), "{}", chip.name);
        model.noise = 3;
        let read = |model: &mut MagneticEncoder, now| {
            let before = model.sampled;
            let frame = transfer(chip, model, &chip.command, now);
            let sampled = if chip.is_period_late { before } else { model.sampled };
            (sampled, chip.angle(&frame))
        };
        for now in 1..500 {
            model.turn(if now < 250 { 7919 } else { -104_729 }, 1000 * now);
            let (sampled, angle) = read(&mut model, 1000 * now);
            let dropped = sampled == 0 && angle == Err(ReadingError::Zeros);
            assert!(dropped || angle == Ok(sampled as u32), "{}: {sampled}, {angle:?}", chip.name);
        }
    }
}

/// An AS5047P predicts in its other register until the driver has switched that off.
#[test]
fn the_set_up_switches_the_prediction_off() {
    let chip = Chip::find("as5047p").unwrap();
    let compensated = [0xFFFF, 0, 0];
    let angle = |mut model: MagneticEncoder| {
        model.turn(50, 1000);
        transfer(chip, &mut model, &compensated, 1000);
        chip.angle(&transfer(chip, &mut model, &compensated, 1000))
    };
    assert_eq!(angle(MagneticEncoder::find(chip.name, 100).unwrap()), Ok(200));
    assert_eq!(angle(started(chip, 100)), Ok(150));
}

/// What a driver tells of each failure of its chip; `None`: the transfer cannot tell.
#[test]
fn each_failure_is_told() {
    use ReadingError::*;
    let checked = |error| [Some(error), Some(Field), Some(Field)];
    for chip in Chip::ALL {
        let [bit, flag, weak] = match chip.name {
            "mt6701" => checked(Checksum),
            "mt6835" => [Some(Checksum), Some(Flag), Some(Field)],
            "as5048a" | "as5047p" => [Some(Parity), Some(Flag), None],
            _ => [None; 3],
        };
        for (failure, error) in [
            (Failure::Bit(9), bit),
            (Failure::Flag, flag),
            (Failure::WeakField, weak),
            (Failure::Zeros, Some(Zeros)),
            (Failure::Ones, Some(Ones)),
            (Failure::Frozen, None),
        ] {
            let mut model = started(chip, 1234);
            model.failure = Some(failure);
            transfer(chip, &mut model, &chip.command, 1);
            let told = chip.angle(&transfer(chip, &mut model, &chip.command, 1));
            assert_eq!(told.err(), error, "{}: {failure:?}", chip.name);
        }
    }
}

fn file() -> SceneFile {
    parse("magnetic_wall.toml", Format::Toml, WALL).unwrap_or_else(|error| panic!("{error}"))
}

fn transducers() -> Transducers {
    file().board_transducers(None, None).unwrap()
}

/// The file of a program that reads a chip.
fn built(name: &str, text: &str) -> PathBuf {
    let toolchain = prepare(Tools::Compiler).unwrap_or_else(|error| panic!("{error}"));
    let written = toolchain.write_scene(name, text).unwrap();
    let board = BoardModel::find(NUCLEO_G474RE.name).unwrap();
    let board = Some((board, TorqueOutput::Dac));
    let built = toolchain.build_written(&written, board, NumberFormat::F32, file().chip);
    built.unwrap_or_else(|error| panic!("{error}")).path
}

fn of_file(name: &str, file: &SceneFile) -> PathBuf {
    let transducers = file.board_transducers(None, None).unwrap();
    built(name, &program::program(file, &transducers, None, name).unwrap())
}

/// A board with the wall's program and its chip at a position.
fn boot(device: impl Device + Send + 'static, position: i64) -> Bench {
    static ELF: OnceLock<PathBuf> = OnceLock::new();
    let elf = ELF.get_or_init(|| of_file("magnetic_wall", &file()));
    boot_file(elf, device, position)
}

fn boot_file(elf: &Path, device: impl Device + Send + 'static, position: i64) -> Bench {
    let mut bench = Bench::boot_file(&NUCLEO_G474RE, elf, device);
    bench.board_mut().magnetic = MagneticEncoder::find("mt6701", position);
    bench
}

/// In the wall, armed and with the clamp open.
fn in_the_wall() -> Bench {
    let mut bench = boot(FixedDevice, INTO);
    bench.armed();
    bench.run(OPEN);
    assert_ne!(bench.last_code(), Some(MID_SCALE));
    bench
}

/// The code of each tick is that of the position at its update.
#[test]
fn the_wall_gives_the_host_s_codes() {
    let (file, transducers) = (file(), transducers());
    let trajectory = HandTrajectory::for_environment(&file.scene.environment);
    let device = SimulatedDevice::new(&file.scene, trajectory, &transducers).unwrap();
    let mut bench = boot(HandHeldDevice::with(device), 0);
    let armed = bench.armed();
    const SAMPLES: usize = 3000;
    bench.run(SAMPLES as u64 + 2);
    let samples = &bench.pins().samples[armed..];
    let codes = with_the_same_cycle::<_, Latched>(file.scene, &transducers, &samples[..SAMPLES]);
    for (tick, &code) in codes.iter().enumerate() {
        assert_eq!(samples[tick + 2].code, Some(code), "tick {tick}: {:?}", samples[tick]);
    }
    let pushed = codes.iter().filter(|&&code| code != MID_SCALE).count();
    assert!(pushed > 500, "a torque in {pushed} samples");
    // The chip is released once its last bit is sampled.
    assert_eq!(bench.board().spi.cut, 0);
}

#[test]
fn a_wall_stays_where_it_is_through_a_reset() {
    let mut bench = in_the_wall();
    let code = bench.last_code();
    // By whole turns, which a chip does not know.
    for _ in 0..32 {
        bench.turn(1 << 10);
    }
    bench.run(40);
    assert_eq!(bench.status().count, INTO + (1 << 15));
    bench.machine.reset(Cause::Pin);
    bench.armed();
    bench.run(OPEN);
    assert_eq!(bench.status().count, INTO);
    assert_eq!(bench.last_code(), code);
}

/// The scene allows one reading in a row to fail.
#[test]
fn a_failed_reading_is_held_and_two_are_a_fault() {
    for (failure, error) in [
        (Failure::Bit(3), ReadingError::Checksum),
        (Failure::Zeros, ReadingError::Zeros),
        (Failure::Ones, ReadingError::Ones),
        (Failure::WeakField, ReadingError::Field),
    ] {
        let mut bench = in_the_wall();
        let fail = |bench: &mut Bench, failure, samples| {
            bench.board_mut().magnetic.as_mut().unwrap().failure = failure;
            bench.run(samples);
        };
        let code = bench.last_code();
        for _ in 0..5 {
            fail(&mut bench, Some(failure), 1);
            fail(&mut bench, None, 1);
        }
        assert_eq!((bench.fault(), bench.last_code()), (None, code), "{failure:?}");
        let now = bench.now();
        fail(&mut bench, Some(failure), 4);
        let fault = bench.fault();
        let off = bench.amplifier_off(now);
        let off = off.unwrap_or_else(|| panic!("{failure:?}: on, {fault:?}")) - now;
        assert!(off < 3 * bench.period(), "{failure:?}: {off}");
        let error = error as u32;
        assert_eq!(bench.fault(), Some(Fault::EncoderReading { error, allowed: 1 }));
        fail(&mut bench, None, 20);
        bench.armed();
    }
}

/// Of a chip with a checksum that the board's own unit checks, and a noise that never rests: that unit begins anew after
/// a wrong one, and an angle that stands still is a fault.
#[test]
fn a_chip_that_stops_is_a_fault() {
    let text = WALL.replace("mt6701", "mt6835").replace("noise = 2", "noise = 10");
    let file = parse("stops.toml", Format::Toml, &text).unwrap_or_else(|error| panic!("{error}"));
    let mut bench = boot_file(&of_file("stops", &file), FixedDevice, INTO << 7);
    bench.board_mut().magnetic = MagneticEncoder::find("mt6835", INTO << 7);
    let fail = |bench: &mut Bench, failure, samples| {
        let chip = bench.board_mut().magnetic.as_mut().unwrap();
        (chip.noise, chip.failure) = (10, failure);
        bench.run(samples);
    };
    fail(&mut bench, None, 1);
    bench.armed();
    for _ in 0..50 {
        fail(&mut bench, Some(Failure::Bit(3)), 1);
        fail(&mut bench, None, 9);
    }
    assert_eq!(bench.fault(), None);
    assert_ne!(bench.last_code(), Some(MID_SCALE));
    // A reading that fails has no step, too.
    fail(&mut bench, Some(Failure::Frozen), 50);
    fail(&mut bench, Some(Failure::Bit(3)), 1);
    fail(&mut bench, Some(Failure::Frozen), 45);
    assert_eq!(bench.fault(), None);
    fail(&mut bench, Some(Failure::Frozen), 106);
    let error = ReadingError::Frozen as u32;
    assert_eq!(bench.fault(), Some(Fault::EncoderReading { error, allowed: 99 }));
}

/// Readings fail by the law of a simulation: the codes are those of the readings before.
#[test]
fn failing_readings_give_the_codes_of_a_simulation_s() {
    let (file, transducers) = (file(), transducers());
    let trajectory = HandTrajectory::for_environment(&file.scene.environment);
    let device = SimulatedDevice::new(&file.scene, trajectory, &transducers).unwrap();
    let mut bench = boot(HandHeldDevice::with(device), 0);
    let armed = bench.armed();
    const SAMPLES: usize = 1500;
    let fails: Vec<_> = Missed::Every { count: 3, length: 1 }.ticks().take(SAMPLES).collect();
    // The chip is selected at the beginning of the sample that runs next, which has its count already.
    let first = bench.pins().samples.len() - armed - 1;
    for fail in &fails {
        let chip = bench.board_mut().magnetic.as_mut().unwrap();
        chip.failure = fail.then_some(Failure::Bit(3));
        bench.run(1);
    }
    bench.board_mut().magnetic.as_mut().unwrap().failure = None;
    bench.run(2);
    let mut samples = bench.pins().samples[armed..].to_vec();
    let mut last = samples[first - 1].count;
    for (sample, fail) in samples[first..].iter_mut().zip(&fails) {
        sample.count = if *fail { last } else { sample.count };
        last = sample.count;
    }
    let codes = with_the_same_cycle::<_, Latched>(file.scene, &transducers, &samples[..SAMPLES]);
    let wrong =
        (0..SAMPLES - 2).filter(|&tick| samples[tick + 2].code != Some(codes[tick])).count();
    assert_eq!((wrong, bench.fault()), (0, None));
    assert!(codes.iter().filter(|&&code| code != MID_SCALE).count() > 300);
}

/// A wall with a damper: its certificate is that of missed updates, and the tick is left out.
#[test]
fn a_failed_reading_of_a_damped_wall_is_a_missed_update() {
    let text = WALL.replace("damping = 0.0\n", "damping = 0.001\n");
    let file = parse("damped.toml", Format::Toml, &text).unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(file.scene.timing.worst_period, Some(0.002));
    let mut bench = boot_file(&of_file("damped", &file), FixedDevice, INTO);
    bench.armed();
    bench.run(OPEN);
    let fail = |bench: &mut Bench, failure, samples| {
        bench.board_mut().magnetic.as_mut().unwrap().failure = failure;
        bench.run(samples);
    };
    let (code, missed) = (bench.last_code(), bench.status().missed);
    for _ in 0..5 {
        fail(&mut bench, Some(Failure::Bit(3)), 1);
        fail(&mut bench, None, 1);
    }
    assert_eq!((bench.fault(), bench.last_code()), (None, code));
    assert_eq!(bench.status().missed, missed + 5);
    fail(&mut bench, Some(Failure::Bit(3)), 5);
    let error = ReadingError::Checksum as u32;
    let fault = bench.fault();
    assert_eq!(fault, Some(Fault::EncoderReading { error, allowed: 1 }));
}

/// The flashed program of a device, and the file.
fn measuring(program: &str, text: &str) -> (PathBuf, DeviceFile) {
    let file =
        parse_device("knob.toml", Format::Toml, text).unwrap_or_else(|error| panic!("{error}"));
    let transducers = file.transducers.of_board().unwrap();
    let module = program::device_module(&file.device, &transducers, file.chip, "knob.toml");
    let device = OtherDevice { module, chip: file.chip };
    let text = Sources::find().unwrap().on_device(program, &device).unwrap();
    (built(&format!("magnetic_{program}"), &text), file)
}

/// The program `turns` on a board that reads the chip of a gimbal motor: the host finds the motor's friction,
/// damping, inertia and cogging in what the board sends.
#[test]
fn slow_turns_measure_a_gimbal_motor() {
    const FULL_SCALE: f64 = 0.2;
    let text = "[device]\ninertia = 3e-5\ndamping = 0.001\nfriction = 0.003\n\
                cogging = { torque = 0.005, count = 84 }\n[encoder]\nchip = \"mt6701\"\nage = [0, 1e-5]\n\
                noise = 2.0\n[limits]\nfull_scale = 0.2\n";
    let (elf, file) = measuring("turns", text);
    let sensing = Sensing {
        disturbance: file.disturbance,
        encoder: file.reading,
        torque_noise: 5e-4,
        ..Sensing::ideal(1e-3, 16_384.0)
    };
    let device = MeasuredDevice::new(&Plant::of(&file.chain), &sensing).unwrap();
    let device = HandHeldDevice::with(DrivenDevice { device, full_scale: FULL_SCALE });
    let mut bench = boot_file(&elf, device, 0);
    bench.run(50);
    bench.board_mut().send(&SweepRequest::BEGIN.frame());
    let mut sent = String::new();
    while !sent.contains("\nend,") {
        bench.run(100);
        let board = bench.board_mut();
        sent += std::str::from_utf8(&board.serial.take_sent()).unwrap();
        board.send(&SweepRequest::Listening.frame());
        assert!(sent.len() < 10_000_000, "it does not end");
    }
    let (rows, end) = sent.trim_end().rsplit_once('\n').unwrap();
    assert!(end.starts_with("end,done,"), "{end}");
    let record = record::parse("turns", rows.as_bytes(), TAU / 16_384.0).unwrap();
    assert_eq!(record.torque.len(), 160_000);
    let sweep = turns::sweep(&file.transducers.of_board().unwrap());
    let (mut host, step) = (Exciter::new(&sweep), torque_of(MID_SCALE + 1, FULL_SCALE));
    // A row has the code that the DAC puts out in its tick, which is that of the tick before.
    for (tick, torque) in record.torque[1..].iter().enumerate() {
        let code = f64::from(host.next().code.offset());
        assert_eq!((torque / step).round(), code, "tick {tick}");
    }
    let found = slow_turns(&record, &Correction::of_encoder(16_384.0)).unwrap();
    let holds = |name: &str, Estimate { value, lo, hi }: Estimate, truth: f64| {
        println!("{name}: {truth} in {lo} to {hi}, {value}");
        assert!(lo <= truth && truth <= hi, "{name}: {truth} is not in {lo} to {hi}");
    };
    holds("friction", found.friction, 0.003);
    holds("damping", found.damping, 0.001);
    holds("inertia", found.inertia, 3e-5);
    let cogging = found.harmonics[0];
    assert_eq!(cogging.count, 84);
    holds("cogging", cogging.amplitude, 0.005);
    for (sample, torque) in found.map.iter().enumerate() {
        let truth = file.disturbance.cogging.at(TAU * sample as f64 / found.map.len() as f64);
        // The interval has room for the harmonics that the record does not show, and there are none.
        let most = found.uncertainty.min(7.5e-4);
        assert!((torque - truth).abs() < most, "{sample}: {torque} {truth} {}", found.uncertainty);
    }
    assert!(found.tells_cogging(), "{}", found.uncertainty);
}

/// The program `identify` for a device with a chip plays its sweep, and ends it at a reading that fails.
#[test]
fn a_sweep_reads_the_chip() {
    let text = "[device]\ninertia = 2.2e-5\ndamping = 0.02\n[encoder]\nchip = \"mt6701\"\nage = [0, 1e-5]\n\
                [limits]\nfull_scale = 1.0\n";
    let (elf, _) = measuring("identify", text);
    let mut bench = boot_file(&elf, FixedDevice, INTO);
    bench.run(50);
    let sent = |bench: &mut Bench, request: SweepRequest, samples| {
        bench.board_mut().send(&request.frame());
        bench.run(samples);
        String::from_utf8(bench.board_mut().serial.take_sent()).unwrap()
    };
    let about = sent(&mut bench, SweepRequest::Describe, 50);
    assert!(about.starts_with("identify,3,0.001,16384,"), "{about}");
    let rows = sent(&mut bench, SweepRequest::BEGIN, 100);
    assert!(rows.starts_with("time,torque,counts\n"), "{rows}");
    let counts = rows.lines().skip(1).filter_map(|row| row.split(',').nth(2));
    assert!(counts.clone().count() > 50 && counts.clone().all(|it| it == "300"), "{rows}");
    bench.board_mut().magnetic.as_mut().unwrap().failure = Some(Failure::Ones);
    let end = sent(&mut bench, SweepRequest::Listening, 50);
    assert!(end.contains("end,output-fault,300\n"), "{end}");
}

/// An MT6701 may be as quiet at rest as if it had stopped, so that this is no fault.
#[test]
fn a_device_at_rest_is_no_fault() {
    let mut bench = in_the_wall();
    bench.run(2000);
    assert_eq!(bench.fault(), None);
}

/// Registers of DMA1: those of its channels, which receive, send, select the chip, begin and end a transfer.
const CHANNELS: [u32; 5] = [0x4002_0008, 0x4002_001C, 0x4002_0030, 0x4002_0044, 0x4002_0058];
const RECEIVES: usize = 0;
const BEGINS: usize = 3;
const ENDS: usize = 4;
/// The data register of SPI2.
const DATA: u32 = 0x4000_380C;

/// Enables a channel, or disables it, as a failure may.
fn enable(bench: &mut Bench, channel: usize, is: bool) {
    let control = bench.board_mut().read(CHANNELS[channel], 4) & !1;
    bench.board_mut().write(CHANNELS[channel], 4, control | u32::from(is));
}

/// Without the end of a transfer there is no tick, and the watchdog takes the torque away.
#[test]
fn a_transfer_that_never_ends_resets_the_board() {
    for channel in RECEIVES..=BEGINS {
        let mut bench = in_the_wall();
        enable(&mut bench, channel, false);
        let now = bench.now();
        bench.run(60);
        let off = bench.amplifier_off(now).unwrap_or_else(|| panic!("{channel}: on"));
        assert!(off - now < 40 * bench.period(), "{channel}: {}", off - now);
        let resets: Vec<_> = bench.machine.resets().iter().map(|(_, cause)| *cause).collect();
        assert_eq!(resets, [Cause::Watchdog], "{channel}");
    }
}

/// A chip that is not released gives no angle.
#[test]
fn a_chip_that_stays_selected_is_a_fault() {
    let mut bench = in_the_wall();
    enable(&mut bench, ENDS, false);
    bench.run(5);
    let error = ReadingError::Ones as u32;
    assert_eq!(bench.fault(), Some(Fault::EncoderReading { error, allowed: 1 }));
}

/// An update whose request is lost: the scene tolerates no missed update.
#[test]
fn a_transfer_that_does_not_begin_is_a_missed_tick() {
    let mut bench = in_the_wall();
    bench.run_to_update();
    let half = bench.period() / 2;
    bench.run_for(half);
    enable(&mut bench, BEGINS, false);
    bench.run_for(2 * half);
    enable(&mut bench, BEGINS, true);
    bench.run(3);
    assert_eq!(bench.fault(), Some(Fault::MissedTick { missed: 1, tolerated: 0 }));
}

/// The word that comes too much is not taken for that of the next transfer: a fault, and then the readings are right.
#[test]
fn a_word_that_is_lost_is_a_fault_and_the_next_transfers_are_in_step() {
    let mut bench = in_the_wall();
    bench.run_to_update();
    enable(&mut bench, RECEIVES, false);
    bench.machine.run_until("a word", 2000, |board| board.spi.requests_taking()).unwrap();
    bench.board_mut().read(DATA, 2);
    enable(&mut bench, RECEIVES, true);
    bench.run(3);
    let told = bench.fault();
    assert!(matches!(told, Some(Fault::EncoderReading { .. })), "{told:?}");
    bench.run(20);
    bench.armed();
    bench.run(OPEN);
    assert_eq!((bench.fault(), bench.status().count), (None, INTO));
}

/// A tick that begins late, at any time of the next transfer, reads that transfer, and is the only one with it.
#[test]
fn a_late_tick_reads_the_words_of_one_transfer() {
    let text = WALL
        .replace("period = 0.001\n", "period = 0.001\nworst_period = 0.002\n")
        .replace("dropped = 1\n", "dropped = 0\n");
    let file = parse("late.toml", Format::Toml, &text).unwrap_or_else(|error| panic!("{error}"));
    let elf = of_file("late", &file);
    // Also words of zeros.
    for (position, turn) in [(INTO, 13), (0, 0)] {
        let mut bench = boot_file(&elf, FixedDevice, position);
        bench.armed();
        bench.run(OPEN);
        let (period, half) = (bench.period(), bench.period() / 2);
        let (mut missed, mut count) = (bench.status().missed, position);
        for late in (0..1800).step_by(100) {
            bench.run_to_update();
            bench.run_for(half);
            hold_up(&mut bench, half + period + late, Masks::All);
            bench.run_for(period);
            // Between the transfer whose tick is late and that in which it begins.
            bench.turn(turn);
            bench.run(4);
            (missed, count) = (missed + 1, count + i64::from(turn));
            let status = bench.status();
            assert_eq!(
                (bench.fault(), status.missed, status.count),
                (None, missed, count),
                "{late}"
            );
        }
        assert_eq!(bench.board().spi.cut, 0);
    }
}
