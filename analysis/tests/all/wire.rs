//! The program as the client of a board that is a thread: `tune`, `scope`, and everything that a
//! wire may do to them.

use std::collections::HashMap;
use std::io::{BufRead, BufReader};
use std::num::NonZeroU32;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use crate::common::board::{BoardProcess, Codes, Rig};
use crate::common::{answer, complaint, haptic, program};
use analysis::board_sim::Pacing;
use analysis::link::{BoardPoller, Event, Reply, Request, RequestResult};
use analysis::lockstep::PlantIo;
use analysis::program::{Program, damper_wall};
use analysis::scope::Scope;
use analysis::scope::control::Action;
use analysis::scope::keys::Key;
use haptic_servo::certificate::Parameter;
use serde_json::Value;
use tempfile::TempDir;

/// Counts inside the wall at which the device is held.
const DEPTH: i32 = 300;

/// A device held still, and the codes that its motor received.
struct Held(Codes);

impl PlantIo for Held {
    fn count(&mut self) -> Option<i32> {
        Some(DEPTH)
    }

    fn hold(&mut self, code: u16) {
        self.0.receive(code);
    }
}

/// A board with the damper wall just after it is switched on: not armed.
pub fn off(pacing: Pacing) -> (Codes, Rig) {
    let held = Codes::default();
    (held.clone(), Rig::start("damper_wall", Held(held), pacing))
}

/// The same board, armed.
fn armed(pacing: Pacing) -> (Codes, Rig) {
    let (held, rig) = off(pacing);
    assert_eq!(rig.link().arm().unwrap(), RequestResult::Done);
    (held, rig)
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8(bytes.to_vec()).unwrap()
}

/// The code of a wall of that stiffness behind the coupling at rest: two springs in series.
fn code(stiffness: f64) -> f64 {
    let transducers = damper_wall::TRANSDUCERS;
    let angle = f64::from(DEPTH) * std::f64::consts::TAU / transducers.counts_per_turn;
    let torque = (angle / (1.0 / stiffness + 1.0 / 44.0)).min(1.0);
    2048.0 - torque * 1791.0 / transducers.full_scale_torque
}

/// The motor follows what `tune` says.
#[test]
fn a_board_is_off_until_it_is_armed_and_when_it_is_disarmed() {
    let (held, rig) = off(Pacing::Unthrottled);
    let tune = |argument: &str| answer(&rig.haptic(&["tune", "--json", argument]));
    assert_eq!(held.after(500), 2048);
    tune("--arm");
    assert!((f64::from(held.after(500)) - code(22.0)).abs() <= 1.0);
    assert_eq!(tune("--disarm")["state"], "disarmed");
    assert_eq!(held.after(10), 2048);
    // A set is taken while the motor is off, and nothing moves for it.
    assert_eq!(tune("stiffness=11")["sets"], 1);
    assert_eq!(held.after(500), 2048);
    tune("--arm");
    assert!((f64::from(held.after(500)) - code(11.0)).abs() <= 1.0);
}

#[test]
fn scope_records_rows_and_ends_quietly() {
    let (_, rig) = armed(Pacing::RealTime);
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
    let (_, rig) = armed(Pacing::RealTime);
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
    let (held, rig) = armed(Pacing::RealTime);
    let (address, folder) = (rig.board.address().clone(), rig.folder);
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
    let program = Program::find("damper_wall").unwrap();
    let _again = program.listen(Box::new(Held(held)), &address, Pacing::RealTime).unwrap();
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
    let (_, rig) = armed(Pacing::RealTime);
    let mut scope = Scope::new(rig.port(), 1.0);
    let poller = BoardPoller::start(rig.link(), NonZeroU32::MIN);
    let mut press = |text: &str, said: &str, is_so: fn(&Scope) -> bool| {
        for letter in text.chars() {
            let key = if letter == '\n' { Key::Enter } else { Key::Letter(letter) };
            if let Action::Request(request) = scope.control.press(key) {
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
    let (_, rig) = armed(Pacing::RealTime);
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
    let (_, rig) = armed(Pacing::RealTime);
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

#[test]
fn a_simulated_board_is_there_to_try_things_on() {
    let mut board = BoardProcess::start("free_mode", &["--for", "3"]);
    let running = answer(&board.haptic(&["tune", "--json", "residual=0.004"]));
    assert_eq!((&running["refused"], &running["program"]), (&Value::Null, &"free_mode".into()));
    assert_eq!(running["parameters"]["residual"], 0.004);
    // The port is in use.
    let said = complaint(haptic(&["board-sim", "free_mode", "--port", &board.port]));
    assert!(said.contains("cannot listen on unix:"), "{said}");
    assert!(said.ends_with("another program listens there\n"), "{said}");
    assert_eq!(board.running.0.wait().unwrap().code(), Some(0));
}

#[test]
fn a_scene_file_is_a_simulated_board() {
    let knob = concat!(env!("CARGO_MANIFEST_DIR"), "/explore/src/presets/gimbal_knob.toml");
    let board = BoardProcess::start(knob, &["--for", "30"]);
    let running = answer(&board.haptic(&["tune", "--json", "torque=0.02"]));
    let expected = (&Value::Null, &"gimbal knob with MT6701".into());
    assert_eq!((&running["refused"], &running["program"]), expected);
    assert_eq!(running["parameters"]["torque"], 0.02);
    let beyond = haptic(&["tune", "--port", &board.port, "--json", "torque_limit=0.2"]);
    assert_eq!(beyond.status.code(), Some(1), "{beyond:?}");
    let why = answer(&beyond)["refused"].to_string();
    assert!(why.contains("oppose the cogging and the scene's limit of 0.2 N m"), "{why}");
    let refused = haptic(&["board-sim", "none.toml", "--port", &board.port]);
    assert!(complaint(refused).contains("none.toml"));
    let folder = TempDir::new().unwrap();
    let steep = folder.path().join("steep.toml");
    let text = std::fs::read_to_string(knob).unwrap().replace("count = 24", "count = 400");
    std::fs::write(&steep, text).unwrap();
    let refused = haptic(&["board-sim", steep.to_str().unwrap(), "--port", &board.port]);
    assert_eq!(refused.status.code(), Some(1), "{refused:?}");
}

#[test]
fn a_simulated_board_that_is_told_to_end_or_killed_is_in_nobodys_way() {
    let folder = TempDir::new().unwrap();
    let path = folder.path().join("board");
    let port = format!("unix:{}", path.display());
    let start = || BoardProcess::at(&port, "free_mode", &["--for", "60"]);
    drop(start());
    assert!(path.exists());
    let mut told = start();
    let id = told.0.id().to_string();
    assert!(Command::new("kill").args(["-TERM", &id]).status().unwrap().success());
    assert_eq!(told.0.wait().unwrap().code(), Some(0));
    assert!(!path.exists());
    // A foreign file is not removed.
    std::fs::write(&path, "a scene").unwrap();
    let said = complaint(haptic(&["board-sim", "free_mode", "--port", &port]));
    assert!(said.contains("a file with this name exists, and is not a socket"), "{said}");
    assert_eq!(std::fs::read_to_string(&path).unwrap(), "a scene");
}
