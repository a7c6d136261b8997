//! The program as the client of the emulated board, over its serial port, while the board's servo
//! runs in lockstep with a device that is held still.

use std::collections::BTreeSet;
use std::io::{BufReader, Read, Write};
use std::os::unix::net::UnixStream;
use std::sync::{Arc, Mutex};
use std::time::Duration;

use crate::common::haptic;
use analysis::emulator::Emulator;
use analysis::emulator::plant_thread::{PlantModel, PlantThread};
use analysis::link::frame;
use analysis::toolchain::{NumberFormat, Tools, prepare};
use haptic_servo::board::lockstep_protocol::{TickInput, TickOutput};
use haptic_servo::servo_loop::State;
use haptic_servo::wire::message::{LONGEST_TO_HOST, Status, ToBoard, ToHost};
use haptic_servo::wire::{CHECKSUM, Decoder};

/// Counts inside the wall at which the device is held.
const DEPTH: u32 = 300;
/// Counts that it moves in a tick until it is there.
const STEP: usize = 10;

/// The board's output since it was last read.
#[derive(Default)]
struct Seen {
    ticks: u64,
    last: u16,
    codes: BTreeSet<u16>,
    states: Vec<State>,
}

/// A device that is held still.
struct Held(Arc<Mutex<Seen>>);

impl PlantModel for Held {
    fn next_input(&mut self) -> TickInput {
        TickInput { count: DEPTH, missed: 0 }
    }

    fn observe(&mut self, _: TickInput, output: TickOutput) {
        let mut seen = self.0.lock().unwrap();
        seen.ticks += 1;
        seen.last = output.code;
        seen.codes.insert(output.code);
        if seen.states.last() != Some(&output.state) {
            seen.states.push(output.state);
        }
    }
}

/// An emulated board in its world.
struct Board {
    seen: Arc<Mutex<Seen>>,
    world: PlantThread,
}

impl Board {
    /// With the damper wall, and the device in it.
    fn start() -> Self {
        let tools = prepare(Tools::CompilerAndEmulator, |step| eprintln!("{step}")).unwrap();
        let elf = tools.build_scene("damper_wall", NumberFormat::F32).unwrap();
        let mut emulator = Emulator::boot(&elf).unwrap();
        emulator.arm_and_wait().unwrap();
        for count in (0..=DEPTH).step_by(STEP) {
            emulator.tick(TickInput { count, missed: 0 }).unwrap();
        }
        let seen = Arc::<Mutex<Seen>>::default();
        let board = Self { seen: seen.clone(), world: PlantThread::start(emulator, Held(seen)) };
        board.settle();
        board
    }

    /// The code after this many more ticks.
    fn after(&self, ticks: u64) -> u16 {
        let end = self.seen.lock().unwrap().ticks + ticks;
        for _ in 0..300_000 {
            let seen = self.seen.lock().unwrap();
            if seen.ticks >= end {
                return seen.last;
            }
            drop(seen);
            std::thread::sleep(Duration::from_micros(200));
        }
        panic!("the board has ended");
    }

    /// The code, once it is the same for a while: the motion of a wall in its coupling takes long to die
    /// away.
    fn settle(&self) -> u16 {
        for _ in 0..200 {
            {
                let mut seen = self.seen.lock().unwrap();
                seen.codes.clear();
                seen.states.clear();
            }
            let last = self.after(30);
            if self.seen.lock().unwrap().codes.len() == 1 {
                return last;
            }
        }
        panic!("the torque does not settle");
    }

    /// Writes bytes, waits for this many ticks, and requests the status on the same wire.
    fn disturb(&self, bytes: &[u8], ticks: u64) -> Status {
        let mut stream = UnixStream::connect(self.world.port()).unwrap();
        stream.write_all(bytes).unwrap();
        self.after(ticks);
        stream.write_all(&frame(&ToBoard::Status)).unwrap();
        let mut ear = Decoder::<{ LONGEST_TO_HOST + CHECKSUM }>::new();
        let bytes = BufReader::new(stream).bytes();
        let mut said = bytes.map(|byte| ear.push::<ToHost<String>>(byte.unwrap()));
        let status = said.find_map(|said| match said {
            Some(ToHost::Status(status)) => Some(status),
            _ => None,
        });
        status.unwrap()
    }

    /// Ends the board, which was late in no tick.
    fn end(self) {
        assert_eq!(self.world.end().unwrap().finish().unwrap().overruns, 0);
    }
}

/// Random bytes, truncated frames, wrong checksums, a flood, and a stall in the middle of a frame.
#[test]
fn the_servo_keeps_time_whatever_comes_over_the_wire() {
    let board = Board::start();
    let wanted = board.settle();
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
    let mut before = board.disturb(&[], 0);
    for (bytes, ticks, least) in [
        (noise, 0, [10, 0, 0]),
        (truncated, 0, [900, 0, 0]),
        (wrong, 0, [0, 900, 0]),
        (long, 0, [0, 0, 15]),
        (flood, 0, [1, 0, 0]),
        (stalled, 500, [1, 0, 0]),
    ] {
        let now = board.disturb(&bytes, ticks);
        assert_eq!((now.sets, now.missed, now.state), (0, 0, State::Running), "{now:?}");
        let (is, was) = (now.discarded, before.discarded);
        let more = [is.broken - was.broken, is.checksum - was.checksum, is.too_long - was.too_long];
        let is_counted = more.iter().zip(least).all(|(more, least)| *more >= least);
        assert!(is_counted, "{now:?} after {before:?}");
        before = now;
    }
    let seen = board.seen.lock().unwrap();
    assert_eq!(seen.codes, BTreeSet::from([wanted]));
    assert_eq!(seen.states, [State::Running]);
    drop(seen);
    board.end();
}

/// Tick, time, count, position, code, torque, state, limit and slack.
type Row = (u64, f64, i64, f64, u16, f64, String, String, f64);

/// The board streams the values that its world has seen.
#[test]
fn scope_records_the_emulated_board() {
    let board = Board::start();
    let port = format!("unix:{}", board.world.port().display());
    let output = haptic(&["scope", "--port", &port, "--csv", "-", "--for", "2", "--every", "1"]);
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    let mut rows = csv::Reader::from_reader(output.stdout.as_slice());
    let rows: Vec<Row> = rows.deserialize().collect::<Result<_, _>>().unwrap();
    assert!(rows.len() > 500, "{}", rows.len());
    let last = board.settle();
    for (_, _, count, _, code, _, state, limit, slack) in &rows {
        assert_eq!((*count, *code, state.as_str(), limit.as_str()), (300, last, "running", "none"));
        assert!(*slack > 0.0 && *slack <= 0.001);
    }
    board.end();
}
