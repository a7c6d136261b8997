//! The program as the client of the emulated board, over its serial port, while the board's servo
//! runs in lockstep with a device that is held still.

use std::collections::BTreeSet;
use std::io::{BufReader, Read, Write};
use std::os::unix::net::UnixStream;
use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex};
use std::thread::JoinHandle;
use std::time::Duration;

use crate::common::{answer, haptic};
use analysis::emulator::{Emulator, EmulatorReport};
use analysis::link::{Address, Link};
use analysis::program::damper_wall;
use analysis::toolchain::{NumberFormat, Tools, prepare};
use haptic_servo::board::lockstep_protocol::TickInput;
use haptic_servo::environment::Wall;
use haptic_servo::number::Format;
use haptic_servo::scene::Scene;
use haptic_servo::servo_loop::State;
use haptic_servo::wire::message::{LONGEST_TO_BOARD, LONGEST_TO_HOST, Status, ToBoard, ToHost};
use haptic_servo::wire::{CHECKSUM, Decoder, encode, largest_frame};

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

/// An emulated board, and the thread that is its world.
struct Board {
    seen: Arc<Mutex<Seen>>,
    over: Arc<AtomicBool>,
    world: Option<JoinHandle<EmulatorReport>>,
    socket: PathBuf,
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
        let socket = emulator.port();
        let (seen, over) = (Arc::<Mutex<Seen>>::default(), Arc::<AtomicBool>::default());
        let world = std::thread::spawn({
            let (seen, over) = (seen.clone(), over.clone());
            move || hold(emulator, &seen, &over)
        });
        let board = Self { seen, over, world: Some(world), socket };
        board.settle();
        board
    }

    /// The code after this many more ticks.
    fn after(&self, ticks: u64) -> u16 {
        let end = self.seen.lock().unwrap().ticks + ticks;
        loop {
            let seen = self.seen.lock().unwrap();
            if seen.ticks >= end {
                return seen.last;
            }
            drop(seen);
            std::thread::sleep(Duration::from_micros(200));
            assert!(!self.world.as_ref().unwrap().is_finished(), "the board has ended");
        }
    }

    /// The code, once it is the same for a while: the motion of a wall in its coupling after a swap takes
    /// long to die away where its damping is near the certified limit.
    fn settle(&self) -> u16 {
        for _ in 0..200 {
            self.forget();
            let last = self.after(30);
            if self.seen.lock().unwrap().codes.len() == 1 {
                return last;
            }
        }
        panic!("the torque does not settle");
    }

    fn forget(&self) {
        let mut seen = self.seen.lock().unwrap();
        seen.codes.clear();
        seen.states.clear();
    }

    fn tune(&self, arguments: &[&str]) -> std::process::Output {
        let port = format!("unix:{}", self.socket.display());
        haptic(&[&["tune", "--json", "--port", &port], arguments].concat())
    }

    fn link(&self) -> Link {
        Link::open(&Address::Unix(self.socket.clone())).unwrap()
    }

    /// Writes bytes, waits for this many ticks, and requests the status on the same wire.
    fn disturb(&self, bytes: &[u8], ticks: u64) -> Status {
        let mut stream = UnixStream::connect(&self.socket).unwrap();
        stream.write_all(bytes).unwrap();
        self.after(ticks);
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

    /// Ends the board; returns its report.
    fn end(mut self) -> EmulatorReport {
        self.over.store(true, Ordering::Relaxed);
        self.world.take().unwrap().join().unwrap()
    }
}

/// A world in which the device is held still.
fn hold(mut emulator: Emulator, seen: &Mutex<Seen>, over: &AtomicBool) -> EmulatorReport {
    while !over.load(Ordering::Relaxed) {
        let output = emulator.tick(TickInput { count: DEPTH, missed: 0 }).unwrap();
        let mut seen = seen.lock().unwrap();
        seen.ticks += 1;
        seen.last = output.code;
        seen.codes.insert(output.code);
        if seen.states.last() != Some(&output.state) {
            seen.states.push(output.state);
        }
    }
    emulator.finish().unwrap()
}

/// The code of a wall of that stiffness behind the coupling at rest: two springs in series.
fn code(stiffness: f64) -> f64 {
    let transducers = damper_wall::TRANSDUCERS;
    let angle = f64::from(DEPTH) * std::f64::consts::TAU / transducers.counts_per_turn;
    let torque = (angle / (1.0 / stiffness + 1.0 / 44.0)).min(1.0);
    2048.0 - torque * 1791.0 / transducers.full_scale_torque
}

fn with(stiffness: f64, damping: f64) -> Scene {
    let environment = Wall::damped(stiffness, damping, 1).behind(0.0).alone();
    Scene { environment, ..damper_wall::SCENE }
}

/// Half of them inadmissible; the verdict on each is made here, apart from the board.
#[test]
fn of_a_thousand_sets_none_is_rendered_that_is_not_certified() {
    let board = Board::start();
    let mut random = fastrand::Rng::with_seed(3);
    let (mut running, mut refused) = (22.0, 0);
    for i in 0..1000 {
        let is_soft = i % 2 == 0;
        let stiffness = if is_soft { 0.5 + 19.0 * random.f64() } else { 44.0 * random.f64() };
        let damping = if is_soft { 0.001 } else { 0.02 + 0.02 * random.f64() };
        let output =
            board.tune(&[&format!("stiffness={stiffness}"), &format!("damping={damping}")]);
        let said = answer(&output);
        match with(stiffness, damping).certify_in(Format::F32) {
            Ok(_) => {
                assert_eq!(output.status.code(), Some(0), "set {i}: {output:?}");
                running = stiffness;
            }
            Err(rejection) => {
                assert_eq!(output.status.code(), Some(1), "set {i}: {output:?}");
                assert_eq!(said["refused"], rejection.to_string(), "set {i}");
                refused += 1;
                // Not for a single tick.
                let last = board.after(20);
                let codes = board.seen.lock().unwrap().codes.clone();
                assert_eq!(codes, BTreeSet::from([last]), "set {i}");
            }
        }
        assert_eq!(said["parameters"]["stiffness"], running, "set {i}");
        let last = board.settle();
        assert!((f64::from(last) - code(running)).abs() <= 1.0, "set {i}: {last}");
    }
    assert!((400..600).contains(&refused), "{refused}");
    let status = board.link().status().unwrap();
    assert_eq!((status.sets, status.missed), (1000 - refused, 0));
    assert_eq!(status.discarded.total(), 0, "{status:?}");
    let report = board.end();
    assert_eq!(report.overruns, 0);
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
    assert_eq!(board.end().overruns, 0);
}

/// Tick, time, count, position, code, torque, state, limit and slack.
type Row = (u64, f64, i64, f64, u16, f64, String, String, f64);

/// The board streams the values that its world has seen.
#[test]
fn scope_records_the_emulated_board() {
    let board = Board::start();
    let port = format!("unix:{}", board.socket.display());
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
    assert_eq!(board.end().overruns, 0);
}
