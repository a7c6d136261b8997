//! The program that measures a device: it begins and ends as the host says, and ends by itself where
//! the device or the host is not as it should be.

use std::path::{Path, PathBuf};
use std::sync::OnceLock;

use haptic_servo::excitation::{SILENCE, SweepEnd};
use haptic_servo::wire::sweep::SweepRequest;
use virtual_board::chip::{Chip, STM32F405};
use virtual_board::device::FixedDevice;
use virtual_board::peripheral::pins::Level;

use crate::bench::{Bench, MID_SCALE, build};

/// The chip, and the program's file for it.
fn file() -> (&'static Chip, &'static Path) {
    static FILE: OnceLock<PathBuf> = OnceLock::new();
    (&STM32F405, FILE.get_or_init(|| build(&STM32F405, &["identify"]).remove(0)))
}

/// A board whose sweep was begun so many samples ago, with a host that listens.
fn playing(samples: u64) -> Bench {
    let (chip, file) = file();
    let mut bench = Bench::boot_file(chip, file, FixedDevice);
    bench.run(5);
    bench.board_mut().send(&SweepRequest::BEGIN.frame());
    bench.run(samples);
    bench
}

/// What the board has sent, as lines.
fn lines(bench: &mut Bench) -> Vec<String> {
    // Samples under way come with the next ones.
    bench.run(20);
    let sent = bench.board_mut().serial.take_sent();
    String::from_utf8(sent).unwrap().lines().map(str::to_owned).collect()
}

/// The sweep has ended in this way, the motor is off, and the record goes up to there.
fn assert_ended(bench: &mut Bench, end: SweepEnd, what: &str) {
    let lines = lines(bench);
    assert_eq!(lines[0], "time,torque,counts", "{what}");
    let last = lines.last().unwrap();
    assert!(last.starts_with(&format!("end,{},", end.as_str())), "{what}: {last}");
    let rows = &lines[1..lines.len() - 1];
    assert!(rows.iter().all(|row| row.split(',').count() == 3), "{what}");
    assert_eq!(bench.board().amplifier(), Level::Low, "{what}");
    assert_eq!(bench.board().torque(), Some(MID_SCALE), "{what}");
    let after = bench.pins().samples.len();
    bench.run(20);
    let pins = bench.pins();
    assert!(pins.samples[after..].iter().all(|sample| !sample.amplifier), "{what}: on again");
}

#[test]
fn nothing_moves_before_the_host_begins_and_the_board_says_what_it_would_play() {
    let (chip, file) = file();
    let mut bench = Bench::boot_file(chip, file, FixedDevice);
    bench.run(50);
    for request in [SweepRequest::Describe, SweepRequest::Listening, SweepRequest::Stop] {
        bench.board_mut().send(&request.frame());
    }
    assert_eq!(lines(&mut bench), ["identify,3,0.001,61440,58000,0.7,85"]);
    assert_still(&bench);
}

/// The motor has had no torque so far, and its amplifier is off.
fn assert_still(bench: &Bench) {
    assert_eq!(bench.amplifier_on(), None);
    assert!(
        bench.pins().samples.iter().all(|sample| matches!(sample.code, None | Some(MID_SCALE)))
    );
}

#[test]
fn a_sweep_ends_where_the_host_says_so_or_says_nothing() {
    let mut bench = playing(200);
    assert_eq!(bench.board().amplifier(), Level::High);
    bench.board_mut().send(&SweepRequest::Stop.frame());
    bench.run(3);
    assert_ended(&mut bench, SweepEnd::Stopped, "stopped");
    // Half a second after the last byte, which is half a second of samples.
    let patience = (SILENCE * 1000.0) as u64;
    let mut bench = playing(patience - 10);
    assert_eq!(bench.board().amplifier(), Level::High);
    bench.board_mut().send(&SweepRequest::Listening.frame());
    bench.run(patience - 10);
    assert_eq!(bench.board().amplifier(), Level::High);
    bench.run(15);
    assert_ended(&mut bench, SweepEnd::Silent, "silent");
}

#[test]
fn a_sweep_ends_where_the_device_leaves_its_limits() {
    // Counts of 0.7 rad; of 85 and of 100 rad/s in a period; and one for the encoder's step.
    let (travel, speed, jump) = (6845, 832, 978);
    for sign in [1, -1] {
        for (turns, end) in [
            (vec![500; 14], SweepEnd::Travel),
            (vec![speed + 1], SweepEnd::Speed),
            (vec![jump + 1], SweepEnd::Jump),
        ] {
            let what = format!("{end:?}, {sign}");
            let mut bench = playing(100);
            bench.pins().turns.extend(turns.iter().map(|turn| sign * turn));
            bench.run(turns.len() as u64 + 1);
            assert_ended(&mut bench, end, &what);
        }
        // Up to them it goes on.
        let mut bench = playing(100);
        bench.pins().turns.extend([speed, -speed].map(|turn| sign * turn));
        bench.pins().turns.extend([sign * travel / 10; 10]);
        bench.run(15);
        assert_eq!(bench.board().amplifier(), Level::High, "{sign}");
    }
}
