//! The program as the client of a board that is a thread: `tune`, `scope`, and everything that a
//! wire may do to them.

use std::collections::HashMap;
use std::io::{BufRead, BufReader, Read, Write};
use std::num::NonZeroU32;
use std::process::{Command, Output, Stdio};
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

use crate::common::{BoardProcess, answer, haptic, program};
use analysis::board_sim::{Pacing, SimulatedBoard};
use analysis::link::{Address, Link, RequestResult};
use analysis::lockstep::PlantIo;
use analysis::program::{Program, damper_wall};
use analysis::scope::Scope;
use analysis::scope::control::{Action, Reply, Request};
use analysis::scope::poller::{BoardPoller, Event};
use haptic_servo::certificate::Parameter;
use haptic_servo::environment::Wall;
use haptic_servo::number::Format;
use haptic_servo::scene::Scene;
use haptic_servo::wire::message::Changes;
use ratatui::crossterm::event::KeyCode;
use serde_json::Value;
use tempfile::TempDir;

/// Counts inside the wall at which the device is held.
const DEPTH: i32 = 300;

/// A device held still at a count, and the codes that its motor received.
#[derive(Clone)]
struct Held(i32, Arc<Mutex<Codes>>);

#[derive(Default)]
struct Codes {
    ticks: u64,
    last: u16,
    seen: HashMap<u16, u64>,
}

impl PlantIo for Held {
    fn count(&mut self) -> Option<i32> {
        Some(self.0)
    }

    fn hold(&mut self, code: u16) {
        let mut codes = self.1.lock().unwrap();
        codes.ticks += 1;
        codes.last = code;
        *codes.seen.entry(code).or_default() += 1;
    }
}

impl Held {
    /// Forgets the codes so far.
    fn forget(&self) {
        self.1.lock().unwrap().seen.clear();
    }

    /// The code after this many more ticks.
    fn after(&self, ticks: u64) -> u16 {
        let end = self.1.lock().unwrap().ticks + ticks;
        loop {
            let codes = self.1.lock().unwrap();
            if codes.ticks >= end {
                return codes.last;
            }
            drop(codes);
            std::thread::yield_now();
        }
    }
}

/// A board with the damper wall that was armed, and where it listens.
pub struct Rig {
    held: Held,
    board: SimulatedBoard,
    _folder: TempDir,
}

impl Rig {
    fn new(pacing: Pacing) -> Self {
        let rig = Self::off(pacing);
        assert_eq!(rig.link().arm().unwrap(), RequestResult::Done);
        rig
    }

    /// The same board just after it is switched on: not armed.
    pub fn off(pacing: Pacing) -> Self {
        Self::holding("damper_wall", DEPTH, pacing)
    }

    /// A board with a program whose device is held at a count; not armed.
    pub fn holding(program: &str, count: i32, pacing: Pacing) -> Self {
        let folder = TempDir::new().unwrap();
        let address = Address::Unix(folder.path().join("board"));
        let held = Held(count, Arc::default());
        let program = Program::find(program).unwrap();
        let board = program.listen(Box::new(held.clone()), &address, pacing).unwrap();
        Self { held, board, _folder: folder }
    }

    pub fn port(&self) -> String {
        self.board.address().to_string()
    }

    pub fn link(&self) -> Link {
        Link::open(self.board.address()).unwrap()
    }

    pub fn haptic(&self, arguments: &[&str]) -> Output {
        let port = self.port();
        let (command, rest) = arguments.split_first().unwrap();
        haptic(&[&[*command, "--port", &port], rest].concat())
    }
}

pub fn text(bytes: &[u8]) -> String {
    String::from_utf8(bytes.to_vec()).unwrap()
}

fn with(stiffness: f64, damping: f64) -> Scene {
    let environment = Wall::damped(stiffness, damping, 1).behind(0.0).alone();
    Scene { environment, ..damper_wall::SCENE }
}

/// The code of a wall of that stiffness behind the coupling at rest: two springs in series.
fn code(stiffness: f64) -> f64 {
    let transducers = damper_wall::TRANSDUCERS;
    let angle = f64::from(DEPTH) * std::f64::consts::TAU / transducers.counts_per_turn;
    let torque = (angle / (1.0 / stiffness + 1.0 / 44.0)).min(1.0);
    2048.0 - torque * 1791.0 / transducers.full_scale_torque
}

#[test]
fn tune_changes_what_is_certified_and_prints_what_runs() {
    let rig = Rig::new(Pacing::Unthrottled);
    let output = rig.haptic(&["tune"]);
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    assert!(text(&output.stdout).contains("stiffness=22 damping=0.01 face=0"), "{output:?}");
    let output = rig.haptic(&["tune", "--json", "stiffness=12.5", "damping=0.002"]);
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    let said = answer(&output);
    assert_eq!(said["program"], "damper_wall");
    assert_eq!(said["parameters"]["stiffness"], 12.5);
    assert_eq!(said["parameters"]["damping"], 0.002);
    assert_eq!(said["parameters"]["coupling.stiffness"], 44.0);
    let scene = with(12.5, 0.002);
    let margin = scene.certify_in(Format::F32).unwrap().assessment().margin(&scene);
    assert_eq!(said["margin"].as_f64(), margin);
    assert_eq!((&said["refused"], &said["sets"]), (&Value::Null, &Value::from(1)));
    assert_eq!(said["missed"], 0);
    // The clamp opens again, for as long as that takes.
    let state = said["state"].as_str().unwrap();
    assert!(["settling", "fading-in", "running"].contains(&state), "{state}");
    assert!(said.as_object().unwrap().get("power").is_some_and(Value::is_null), "{said}");
    assert!((said["longest_gap"].as_f64().unwrap() - 0.036).abs() < 1e-9, "{said}");
}

/// A hand may press on the changed wall.
#[test]
fn tune_says_for_how_long_an_armed_board_lets_go() {
    let rig = Rig::new(Pacing::Unthrottled);
    let said = "the torque was released for up to 36 ms";
    for (arguments, lets_go) in [
        (&["tune", "stiffness=12"][..], true),
        (&["tune"], false),
        (&["tune", "stiffness=30"], false),
        (&["tune", "stiffness=13", "--disarm"], false),
        (&["tune", "stiffness=14", "--arm"], false),
    ] {
        let output = rig.haptic(arguments);
        assert_eq!(text(&output.stdout).contains(said), lets_go, "{arguments:?}: {output:?}");
    }
    let help = rig.haptic(&["tune", "--help"]);
    assert!(text(&help.stdout).contains("An armed board takes the torque away"), "{help:?}");
}

#[test]
fn tune_prints_the_boards_sentence_where_it_refuses() {
    let rig = Rig::new(Pacing::Unthrottled);
    let sentence = with(30.0, 0.01).certify_in(Format::F32).unwrap_err().to_string();
    let output = rig.haptic(&["tune", "stiffness=30"]);
    assert_eq!(output.status.code(), Some(1), "{output:?}");
    assert_eq!(text(&output.stderr).trim_end(), sentence);
    assert!(text(&output.stdout).contains("stiffness=22 "), "{output:?}");
    let output = rig.haptic(&["tune", "--json", "stiffness=30", "--arm"]);
    assert_eq!(output.status.code(), Some(1), "{output:?}");
    assert_eq!(answer(&output)["refused"], sentence);
    // A parameter of another scene.
    let output = rig.haptic(&["tune", "residual=0.1"]);
    assert_eq!(output.status.code(), Some(1), "{output:?}");
    assert!(text(&output.stderr).contains("no residual; it has stiffness, damping, face"));
}

#[test]
fn a_bad_question_is_status_2() {
    let rig = Rig::new(Pacing::Unthrottled);
    for (arguments, part) in [
        (["tune", "stiffnes=30"], "there is no parameter `stiffnes`"),
        (["tune", "stiffness"], "NAME=VALUE"),
        (["tune", "damping=nan"], "not a finite number"),
        (["scope", "--for=-1"], "greater than 0"),
        (["scope", "--every=0"], "`0` must be a whole number from 1 to 4294967295"),
    ] {
        let output = rig.haptic(&arguments);
        assert_eq!(output.status.code(), Some(2), "{output:?}");
        assert!(text(&output.stderr).contains(part), "{output:?}");
    }
    for (port, part) in [
        ("unix:/nowhere/board", "cannot open unix:/nowhere/board"),
        ("/dev/nowhere", "serial port"),
        ("tcp://nowhere", "tcp://HOST:PORT"),
    ] {
        let output = haptic(&["tune", "--port", port]);
        assert_eq!(output.status.code(), Some(2), "{output:?}");
        assert!(text(&output.stderr).contains(part), "{output:?}");
    }
}

#[test]
fn somebody_who_is_no_board_is_told_from_one() {
    let listener = std::net::TcpListener::bind("127.0.0.1:0").unwrap();
    let port = format!("tcp://{}", listener.local_addr().unwrap());
    let mute = std::thread::spawn(move || {
        let (mut stream, _) = listener.accept().unwrap();
        stream.write_all(b"220 mail.example.org ESMTP\r\n").unwrap();
        let mut rest = Vec::new();
        stream.read_to_end(&mut rest).unwrap();
        rest
    });
    let error = Link::open(&port.parse().unwrap()).err().unwrap().to_string();
    assert!(error.contains("no board answers on tcp://127.0.0.1"), "{error}");
    assert!(mute.join().unwrap().len() > 20, "it was asked more than once");
}

#[test]
fn a_board_is_off_until_it_is_armed_and_says_why_it_was_reset() {
    let rig = Rig::off(Pacing::Unthrottled);
    assert_eq!(rig.held.after(500), 2048);
    let output = rig.haptic(&["tune"]);
    let said = text(&output.stdout);
    assert!(said.contains(": disarmed\n") && said.contains("\nlast reset: power on\n"), "{said}");
    let said = answer(&rig.haptic(&["tune", "--json"]));
    assert_eq!((&said["state"], &said["reset"]), (&"disarmed".into(), &"power-on".into()));
    let said = answer(&rig.haptic(&["tune", "--json", "--arm"]));
    assert_eq!(said["refused"], Value::Null);
    assert!((f64::from(rig.held.after(500)) - code(22.0)).abs() <= 1.0);
}

#[test]
fn arms_and_disarms() {
    let rig = Rig::new(Pacing::Unthrottled);
    let said = answer(&rig.haptic(&["tune", "--json", "--disarm"]));
    assert_eq!((&said["refused"], &said["state"]), (&Value::Null, &"disarmed".into()));
    assert_eq!(rig.held.after(10), 2048);
    // A set is taken while the motor is off, and nothing moves for it.
    let said = answer(&rig.haptic(&["tune", "--json", "stiffness=11"]));
    assert_eq!((&said["sets"], &said["state"]), (&Value::from(1), &"disarmed".into()));
    assert_eq!(rig.held.after(500), 2048);
    let said = answer(&rig.haptic(&["tune", "--json", "--arm"]));
    assert_eq!(said["refused"], Value::Null);
    assert!((f64::from(rig.held.after(500)) - code(11.0)).abs() <= 1.0);
}

#[test]
fn scope_records_rows_and_ends_quietly() {
    let rig = Rig::new(Pacing::RealTime);
    let output = rig.haptic(&["scope", "--csv", "-", "--for", "0.6", "--every", "1"]);
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    assert_eq!(text(&output.stderr), "");
    let mut rows = csv::Reader::from_reader(output.stdout.as_slice());
    let header: Vec<String> = rows.headers().unwrap().iter().map(str::to_owned).collect();
    let wanted = "tick,time,count,position,code,torque,state,limit,slack";
    assert_eq!(header.join(","), wanted);
    let rows: Vec<HashMap<String, String>> = rows.deserialize().collect::<Result<_, _>>().unwrap();
    assert!(rows.len() > 300, "{}", rows.len());
    let number = |row: &HashMap<String, String>, key: &str| row[key].parse::<f64>().unwrap();
    for two in rows.windows(2) {
        assert_eq!(number(&two[1], "tick"), number(&two[0], "tick") + 1.0);
    }
    let last = rows.last().unwrap();
    assert_eq!((last["state"].as_str(), last["limit"].as_str()), ("running", "none"));
    assert_eq!(number(last, "count"), f64::from(DEPTH));
    assert!((number(last, "code") - code(22.0)).abs() <= 1.0);
    // The coupling torque: the motor applies its negative.
    let torque = (2048.0 - number(last, "code")) / 1791.0 * 2.0;
    assert!((number(last, "torque") - torque).abs() < 1e-12);
    assert!((number(last, "slack") - 0.001).abs() < 1e-12);
}

#[test]
fn scope_ends_quietly_when_nobody_reads_on() {
    let rig = Rig::new(Pacing::RealTime);
    let mut child = program(&["scope", "--port", &rig.port()])
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let mut lines = BufReader::new(child.stdout.take().unwrap()).lines();
    for _ in 0..20 {
        lines.next().unwrap().unwrap();
    }
    drop(lines);
    let output = child.wait_with_output().unwrap();
    assert_eq!((output.status.code(), text(&output.stderr).as_str()), (Some(0), ""));
}

#[test]
fn scope_says_that_the_link_is_lost_and_goes_on_when_it_is_back() {
    let rig = Rig::new(Pacing::RealTime);
    let (address, folder) = (rig.board.address().clone(), rig._folder);
    let csv = folder.path().join("ticks.csv");
    let mut child = program(&["scope", "--port", &address.to_string(), "--for", "4", "--csv"])
        .arg(&csv)
        .stderr(Stdio::piped())
        .stdout(Stdio::null())
        .spawn()
        .unwrap();
    let mut said = BufReader::new(child.stderr.take().unwrap()).lines().map(Result::unwrap);
    let rows = || std::fs::read_to_string(&csv).unwrap_or_default().lines().count();
    wait_for(|| rows() > 10);
    drop(rig.board);
    assert!(said.next().unwrap().contains("is lost"));
    let before = rows();
    let wall = Program::find("damper_wall").unwrap();
    let _again = wall.listen(Box::new(rig.held), &address, Pacing::RealTime).unwrap();
    wait_for(|| rows() > before + 10);
    let rest: Vec<String> = said.collect();
    assert!(rest.iter().any(|line| line == "connected again"), "{rest:?}");
    assert!(rest.last().unwrap().ends_with("ticks recorded"), "{rest:?}");
    assert_eq!(child.wait().unwrap().code(), Some(0));
}

fn wait_for(mut is_so: impl FnMut() -> bool) {
    let end = Instant::now() + Duration::from_secs(30);
    while !is_so() {
        assert!(Instant::now() < end, "it takes too long");
        std::thread::sleep(Duration::from_millis(10));
    }
}

/// The requests of the scope's keys, from the typed line to the shown reply.
#[test]
fn the_scope_tunes_arms_and_disarms_the_board_that_it_shows() {
    let rig = Rig::new(Pacing::RealTime);
    let mut scope = Scope::new(rig.port(), 1.0);
    let poller = BoardPoller::start(rig.link(), NonZeroU32::MIN);
    let mut press = |text: &str, said: &str, is_so: fn(&Scope) -> bool| {
        for letter in text.chars() {
            let key = if letter == '\n' { KeyCode::Enter } else { KeyCode::Char(letter) };
            if let Action::Request(request) = scope.control.press(key.into()) {
                poller.request(request);
            }
        }
        let end = Instant::now() + Duration::from_secs(20);
        while !(is_so(&scope) && scope.control.message.as_ref().is_some_and(|s| s.contains(said))) {
            assert!(Instant::now() < end, "{text:?}: {:?}", scope.control.message);
            if let Some(event) = poller.next(Duration::from_millis(10)) {
                scope.take(event, |_| Ok::<(), std::convert::Infallible>(())).unwrap();
            }
        }
    };
    let softer: fn(&Scope) -> bool = |scope| {
        let running = scope.parameters.as_ref();
        running.is_some_and(|r| r.values.contains(&(Parameter::Stiffness, 12.5)))
    };
    press("tstiffness = 12.5\n", "stiffness=12.5: done", softer);
    press("tstiffness = 4000\n", "stiffness=4000: rejected", softer);
    press("d", "disarm: done", |scope| scope.status.is_some_and(|(s, _)| !s.state.is_armed()));
    press("A", "arm: done", |scope| scope.status.is_some_and(|(s, _)| s.state.is_armed()));
}

/// A key that was pressed while the link was lost does nothing once it is back.
#[test]
fn what_is_asked_without_a_link_is_not_done_later() {
    let rig = Rig::new(Pacing::RealTime);
    let poller = BoardPoller::start(rig.link(), NonZeroU32::MIN);
    let wait = |is_it: fn(&Event) -> bool| {
        let end = Instant::now() + Duration::from_secs(20);
        while !poller.next(Duration::from_millis(10)).is_some_and(|event| is_it(&event)) {
            assert!(Instant::now() < end, "it takes too long");
        }
    };
    drop(rig.board);
    wait(|event| matches!(event, Event::Lost(_)));
    poller.request(Request::Arm);
    wait(|event| matches!(event, Event::Reply(Request::Arm, Reply::NoLink)));
}

#[test]
fn a_second_client_hears_that_the_port_is_in_use() {
    let rig = Rig::new(Pacing::RealTime);
    let first = rig.link();
    let second = rig.haptic(&["tune"]);
    assert_eq!(second.status.code(), Some(2), "{second:?}");
    let said = text(&second.stderr);
    assert!(said.contains("is in use by another program") && said.contains("press t"), "{said}");
    drop(first);
    assert_eq!(rig.haptic(&["tune"]).status.code(), Some(0));
}

#[test]
#[cfg_attr(no_terminals, ignore = "this machine has no pseudo-terminals")]
fn a_serial_port_that_another_program_has_open_is_said_with_its_name() {
    use serialport::SerialPort;
    let (_master, slave) = serialport::TTYPort::pair().unwrap();
    let port = slave.name().unwrap();
    // As a logger does it: without a lock, and taking the bytes that the board sends.
    let mut other = std::process::Command::new("sleep")
        .arg("30")
        .stdin(std::fs::File::open(&port).unwrap())
        .spawn()
        .unwrap();
    let held = haptic(&["tune", "--port", &port]);
    drop(slave);
    let silent = haptic(&["tune", "--port", &port]);
    let named = format!("sleep (process {})", other.id());
    other.kill().unwrap();
    other.wait().unwrap();
    for output in [held, silent] {
        assert_eq!(output.status.code(), Some(2), "{output:?}");
        let said = text(&output.stderr);
        assert!(said.contains("is in use by") && said.contains(&named), "{said}");
    }
}

/// Half of them inadmissible; the verdict on each is made here, apart from the wire.
#[test]
fn of_a_thousand_sets_none_is_rendered_that_is_not_certified() {
    let rig = Rig::new(Pacing::Unthrottled);
    let mut link = rig.link();
    let mut random = fastrand::Rng::with_seed(7);
    let (mut running, mut refused) = (22.0, 0);
    rig.held.after(500);
    for i in 0..1000 {
        let stiffness = if i % 2 == 0 { 0.5 + 19.0 * random.f64() } else { 44.0 * random.f64() };
        let damping = if i % 2 == 0 { 0.001 } else { 0.02 + 0.02 * random.f64() };
        let changes = [(Parameter::Stiffness, stiffness), (Parameter::Damping, damping)];
        rig.held.forget();
        let outcome = link.set(Changes::from_slice(&changes).unwrap()).unwrap();
        match with(stiffness, damping).certify_in(Format::F32) {
            Ok(_) => {
                assert_eq!(outcome, RequestResult::Done, "set {i}");
                running = stiffness;
                // Near its limit a certified wall rings at half the sample rate for a long time: it has not
                // reached its torque at rest.
                if stiffness * 0.001 / 2.0 + damping > 0.9 * 0.022 {
                    continue;
                }
            }
            Err(rejection) => {
                assert_eq!(outcome, RequestResult::Refused(rejection.to_string()), "set {i}");
                refused += 1;
                // Not for a single tick.
                let last = rig.held.after(150);
                let seen: Vec<u16> = rig.held.1.lock().unwrap().seen.keys().copied().collect();
                assert_eq!(seen, [last], "set {i}");
            }
        }
        let last = rig.held.after(150);
        assert!((f64::from(last) - code(running)).abs() <= 1.0, "set {i}: {last}");
    }
    assert!((400..600).contains(&refused), "{refused}");
    let status = link.status().unwrap();
    assert_eq!((status.sets, status.missed, status.dropped), (1000 - refused, 0, 0));
}

#[test]
fn a_twin_is_a_board_to_try_things_on() {
    let mut board = BoardProcess::start("free_mode", &["--for", "3"]);
    let port = board.port.clone();
    let (_, running) = board.tune(&["residual=0.004"]);
    assert_eq!((&running["refused"], &running["program"]), (&Value::Null, &"free_mode".into()));
    assert_eq!(running["parameters"]["residual"], 0.004);
    // The port is in use.
    let second = haptic(&["twin", "free_mode", "--port", &port]);
    assert_eq!(second.status.code(), Some(2), "{second:?}");
    let said = text(&second.stderr);
    assert!(said.contains("cannot listen on unix:"), "{said}");
    assert!(said.ends_with("another program listens there\n"), "{said}");
    assert_eq!(board.process.wait().unwrap().code(), Some(0));
    let unknown = haptic(&["twin", "freemode", "--port", &port]);
    assert!(
        text(&unknown.stderr)
            .contains("the programs are bridge_wall, brushless_index, brushless_wall, damper_wall"),
        "{unknown:?}"
    );
}

#[test]
fn a_twin_that_is_told_to_end_or_killed_is_in_nobodys_way() {
    let folder = TempDir::new().unwrap();
    let path = folder.path().join("board");
    let port = format!("unix:{}", path.display());
    let start = || {
        let mut board = program(&["twin", "free_mode", "--port", &port, "--for", "60"])
            .stdout(Stdio::piped())
            .spawn()
            .unwrap();
        let mut said = BufReader::new(board.stdout.take().unwrap()).lines();
        assert_eq!(said.next().unwrap().unwrap(), format!("free_mode listens on {port}"));
        board
    };
    let mut killed = start();
    killed.kill().unwrap();
    killed.wait().unwrap();
    assert!(path.exists());
    let mut told = start();
    let id = told.id().to_string();
    assert!(Command::new("kill").args(["-TERM", &id]).status().unwrap().success());
    assert_eq!(told.wait().unwrap().code(), Some(0));
    assert!(!path.exists());
    // A foreign file is not removed.
    std::fs::write(&path, "a scene").unwrap();
    for (arguments, words) in [
        (["free_mode", "--port", &port], "a file with this name exists, and is not a socket"),
        (["free_mode", "--port", "/dev/ttyACM0"], "tcp://HOST:PORT or unix:PATH"),
        (
            [path.to_str().unwrap(), "--port", &port],
            "is a file; a simulated board needs the name of a scene's program",
        ),
    ] {
        let output = haptic(&[&["twin"][..], &arguments].concat());
        assert_eq!(output.status.code(), Some(2), "{output:?}");
        let said = text(&output.stderr);
        assert!(said.contains(words) && !said.contains("no such file"), "{said}");
    }
    assert_eq!(std::fs::read_to_string(&path).unwrap(), "a scene");
}
