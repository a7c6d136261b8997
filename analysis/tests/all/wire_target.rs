//! The emulated board, over its serial port, while its servo runs in lockstep with a device that is held
//! still.

use std::collections::BTreeSet;
use std::io::{BufReader, Read, Write};
use std::os::unix::net::UnixStream;
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use crate::common::board::Codes;
use analysis::emulator::Emulator;
use analysis::toolchain::{NumberFormat, Tools, prepare};
use haptic_servo::board::lockstep_protocol::TickInput;
use haptic_servo::servo_loop::State;
use haptic_servo::wire::message::{LONGEST_TO_BOARD, LONGEST_TO_HOST, Status, ToBoard, ToHost};
use haptic_servo::wire::{CHECKSUM, Decoder, encode, largest_frame};

/// Counts inside the wall at which the device is held.
const DEPTH: u32 = 300;
/// Counts that it moves in a tick until it is there.
const STEP: usize = 10;

/// The emulated board with the damper wall, armed, and the device in it.
fn emulated() -> Emulator {
    let tools = prepare(Tools::CompilerAndEmulator).unwrap();
    let elf = tools.build_scene("damper_wall", NumberFormat::F32).unwrap();
    let mut emulator = Emulator::boot(&elf).unwrap();
    emulator.arm_and_wait().unwrap();
    for count in (0..=DEPTH).step_by(STEP) {
        emulator.tick(TickInput { count, missed: 0 }).unwrap();
    }
    emulator
}

/// The code, once it is the same for a while.
fn settled(codes: &Codes) -> u16 {
    for _ in 0..200 {
        codes.forget();
        let last = codes.after(30);
        if codes.seen().len() == 1 {
            return last;
        }
    }
    panic!("the torque does not settle");
}

/// Writes bytes, waits for this many ticks, and requests the status on the same wire.
fn disturb(socket: &Path, codes: &Codes, bytes: &[u8], ticks: u64) -> Status {
    let mut stream = UnixStream::connect(socket).unwrap();
    stream.write_all(bytes).unwrap();
    codes.after(ticks);
    let mut frame = [0; largest_frame(LONGEST_TO_BOARD)];
    stream.write_all(encode(&ToBoard::Status, &mut frame).unwrap()).unwrap();
    let mut ear = Decoder::<{ LONGEST_TO_HOST + CHECKSUM }>::new();
    let bytes = BufReader::new(stream).bytes();
    let mut said = bytes.map(|byte| ear.push::<ToHost<String>>(byte.unwrap()));
    let status = said.find_map(|said| match said {
        Some(ToHost::Status(status)) => Some(status),
        _ => None,
    });
    status.unwrap()
}

/// Random bytes, truncated frames, wrong checksums, a flood, and a stall in the middle of a frame.
#[test]
#[ignore = "searches for long"]
fn the_servo_keeps_time_whatever_comes_over_the_wire() {
    let (mut emulator, codes, over) = (emulated(), Codes::default(), Arc::<AtomicBool>::default());
    let socket = emulator.port();
    let world = std::thread::spawn({
        let (codes, over) = (codes.clone(), over.clone());
        move || {
            while !over.load(Ordering::Relaxed) {
                codes.receive(emulator.tick(TickInput { count: DEPTH, missed: 0 }).unwrap().code);
            }
            emulator.finish().unwrap()
        }
    });
    let wanted = settled(&codes);
    let mut random = fastrand::Rng::with_seed(5);
    let noise: Vec<u8> = (0..5000).map(|_| random.u8(..)).collect();
    // Blocks that are longer than the bytes that follow.
    let truncated = [0, 9, 9, 9, 0].repeat(1000);
    // Six bytes whose last four are not the checksum of the first two.
    let wrong = [0, 7, 1, 2, 3, 4, 5, 6, 0].repeat(1000);
    // Longer than any message.
    let long = [[1; 500].as_slice(), &[0]].concat().repeat(20);
    let flood = vec![0x55; 20_000];
    let stalled = vec![0, 5, 1];
    let mut before = disturb(&socket, &codes, &[], 0);
    for (bytes, ticks, least) in [
        (noise, 0, [10, 0, 0]),
        (truncated, 0, [900, 0, 0]),
        (wrong, 0, [0, 900, 0]),
        (long, 0, [0, 0, 15]),
        (flood, 0, [1, 0, 0]),
        (stalled, 500, [1, 0, 0]),
    ] {
        let now = disturb(&socket, &codes, &bytes, ticks);
        assert_eq!((now.sets, now.missed, now.state), (0, 0, State::Running), "{now:?}");
        let (is, was) = (now.discarded, before.discarded);
        let more = [is.broken - was.broken, is.checksum - was.checksum, is.too_long - was.too_long];
        let is_counted = more.iter().zip(least).all(|(more, least)| *more >= least);
        assert!(is_counted, "{now:?} after {before:?}");
        before = now;
    }
    assert_eq!(codes.seen(), BTreeSet::from([wanted]));
    over.store(true, Ordering::Relaxed);
    assert_eq!(world.join().unwrap().overruns, 0);
}
