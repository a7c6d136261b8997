//! The page's end of the wire against the board's own, tick by tick and without a port.

use std::f64::consts::TAU;

use haptic_explore::wire;
use haptic_servo::board::sim_hardware::{SimHardware, SimIo};
use haptic_servo::boot::{self, Program};
use haptic_servo::dac::DacCode;
use haptic_servo::encoder::{CounterWidth, RawCount};
use haptic_servo::environment::{Environment, Wall};
use haptic_servo::number::Format;
use haptic_servo::parameter::Parameter;
use haptic_servo::scene::{Coupling, Device, Scene};
use haptic_servo::servo::{Latched, PreparedServo, RenderingOptions, Transducers};
use haptic_servo::servo_loop::{self, FrameQueue, Frames, Inbox, Mailbox, ServoLoop};
use haptic_servo::wire::message::ToHost;
use haptic_servo::wire::{BoardInfo, PROTOCOL, Session, encode};
use proptest::prelude::*;
use serde_json::{Value, json};

/// Counts at which the device is held: inside of the wall.
const DEPTH: i32 = 300;
/// Frames that wait.
const FRAMES: usize = 64;

fn scene(stiffness: f64) -> Scene {
    let wall = Wall::damped(stiffness, 0.01, 1).behind(0.0).alone();
    Scene {
        coupling: Coupling::Spring { stiffness: 44.0 },
        torque_limit: Some(1.0),
        ..Scene::of(Device::damped(2.2e-5, 0.022), 0.001, wall)
    }
}

const TRANSDUCERS: Transducers =
    Transducers { counter: CounterWidth::Bits16, ..Transducers::of(61_440.0, 2.0) };

/// A device that is held still.
struct Still;

impl SimIo for Still {
    fn count(&mut self) -> RawCount {
        RawCount::from(DEPTH)
    }
    fn write(&mut self, _: DacCode) {}
}

/// A board, its wire, and the page's time.
struct Bench {
    session: Session<'static, Environment, f32, Latched, FRAMES>,
    servo_loop: ServoLoop<Environment, f32, Latched>,
    hardware: SimHardware<Still>,
    inbox: Inbox<'static, PreparedServo<Environment, f32, Latched>>,
    frames: Frames<'static, FRAMES>,
    /// The page's time in ms.
    now: f64,
    /// Bytes to the board.
    to_board: Vec<u8>,
    /// The last state that the page has shown.
    board: Value,
    replies: Vec<String>,
    rows: String,
    lost: Option<String>,
}

impl Bench {
    /// A page that has just begun to talk to a board that was just switched on.
    fn new() -> Self {
        let program = Program {
            scene: scene(22.0),
            transducers: TRANSDUCERS,
            rendering: RenderingOptions {
                fade: 0.02,
                injection: None,
                ..RenderingOptions::DEFAULT
            },
            options: servo_loop::Options::DEFAULT,
        };
        let (requests, inbox) = Box::leak(Box::new(Mailbox::new())).split();
        let (frames, queue) = Box::leak(Box::new(FrameQueue::<FRAMES>::new())).split();
        let mut hardware = SimHardware::new(Still, 1000);
        let booted = boot::boot::<_, f32, Latched>(&program, &mut hardware, &requests).unwrap();
        let info = BoardInfo {
            name: "wall",
            timer_counts: 1000,
            reset: booted.reset,
            low_brown_out: false,
            previous_fault: booted.previous_fault,
            stack_left: || None,
            power: || None,
        };
        let session = Session::new(program, booted.margin, info, requests, queue);
        let mut bench = Self {
            session,
            servo_loop: booted.servo_loop,
            hardware,
            inbox,
            frames,
            now: 1000.0,
            to_board: Vec::new(),
            board: Value::Null,
            replies: Vec::new(),
            rows: String::new(),
            lost: None,
        };
        bench.start();
        bench
    }

    fn start(&mut self) {
        let start = json!({ "address": "the test", "now": self.now, "id": 7 }).to_string();
        self.take(&wire::start(&start, &mut Vec::new()).unwrap());
    }

    fn take(&mut self, answer: &str) {
        let mut answer: Value = serde_json::from_str(answer).unwrap();
        self.to_board.extend(answer["send"].as_str().unwrap().chars().map(|c| c as u8));
        let replies = answer["replies"].as_array().unwrap();
        self.replies.extend(replies.iter().map(|reply| reply.as_str().unwrap().to_owned()));
        self.rows += answer["rows"].as_str().unwrap();
        if !answer["board"].is_null() {
            self.board = answer["board"].take();
        }
        if let Some(lost) = answer["lost"].as_str() {
            self.lost = Some(lost.to_owned());
        }
    }

    fn turn(&mut self, bytes: &[u8]) {
        let letters: String = bytes.iter().copied().map(char::from).collect();
        let answer = wire::turn(&format!("{}\n{letters}", self.now), &mut Vec::new()).unwrap();
        self.take(&answer);
    }

    /// Runs so many ticks of 1 ms. `spoil` may change what the board says.
    fn run_with(&mut self, ticks: usize, mut spoil: impl FnMut(usize, &mut Vec<u8>)) {
        for tick in 0..ticks {
            self.now += 1.0;
            self.servo_loop.run(&mut self.hardware, &mut self.inbox, &mut self.frames);
            self.session.receive(&std::mem::take(&mut self.to_board));
            self.session.poll();
            let mut bytes = self.session.outgoing().to_vec();
            self.session.sent(bytes.len());
            spoil(tick, &mut bytes);
            self.turn(&bytes);
        }
    }

    fn run(&mut self, ticks: usize) {
        self.run_with(ticks, |_, _| {});
    }

    /// Asks as the page does.
    fn request(&mut self, request: &str, changes: &str) -> Result<(), String> {
        let question = json!({ "now": self.now, "request": request, "changes": changes });
        let answer = wire::request(&question.to_string(), &mut Vec::new())?;
        self.take(&answer);
        Ok(())
    }

    fn number(&self, name: &str) -> &Value {
        let numbers = self.board["numbers"].as_array().unwrap();
        &numbers.iter().find(|number| number["name"] == name).unwrap()["value"]
    }
}

#[test]
fn the_page_shows_what_runs_on_the_board() {
    let mut bench = Bench::new();
    bench.run(400);
    assert_eq!(bench.lost, None);
    assert_eq!(bench.board["program"], "wall");
    assert_eq!(bench.board["address"], "the test");
    assert_eq!((&bench.board["is_armed"], &bench.board["fault"]), (&false.into(), &Value::Null));
    assert_eq!(bench.number("stiffness"), 22.0);
    let margin = scene(22.0).certify_in(Format::F32).unwrap();
    let margin = margin.assessment().margin(&scene(22.0)).unwrap();
    assert_eq!(bench.board["margin"].as_f64(), Some(margin));
    let shown: Value = serde_json::from_str(&wire::scene("", &mut Vec::new()).unwrap()).unwrap();
    assert_eq!(
        (&shown["name"], &shown["environment"]["stiffness"]),
        (&json!("wall"), &json!(22.0))
    );
    let mut curves = Vec::new();
    wire::curves("100", &mut curves).unwrap();
    // The angle at which the device is held, by another computation, and no torque.
    assert!((curves[2] - f64::from(DEPTH) / 61_440.0 * TAU).abs() < 1e-12, "{curves:?}");
    let points = curves[0] as usize;
    let torque = &curves[1 + 2 * points..];
    assert_eq!((torque[0] as usize, torque[2]), (points, 0.0));
}

/// Whether a refusal has the words of the certificate, with remedies that can be set on the board.
fn is_refusal(words: &str, scene: &Scene) -> bool {
    let reason = scene.certify_in(Format::F32).unwrap_err().reason_in(Format::F64);
    let remedies = words.strip_prefix(reason.as_str()).unwrap_or_default();
    remedies.contains("; it would pass with ") && !remedies.contains("device damping")
}

#[test]
fn a_set_that_the_certificate_refuses_is_not_sent() {
    let mut bench = Bench::new();
    bench.run(300);
    let sentence = wire::judge("stiffness=30", &mut Vec::new()).unwrap_err();
    assert!(is_refusal(&sentence, &scene(30.0)), "{sentence}");
    bench.to_board.clear();
    assert_eq!(bench.request("set", "stiffness=30"), Err(sentence));
    assert!(bench.to_board.is_empty(), "{:?}", bench.to_board);
    assert!(
        bench.request("set", "stiffness=x").unwrap_err().contains("`x` is not a finite number")
    );
    assert!(bench.request("set", "residual=1").unwrap_err().contains("it has stiffness, damping"));
    assert!(bench.request("jump", "").unwrap_err().contains("the requests are set, arm"));

    assert_eq!(wire::judge("stiffness=12.5", &mut Vec::new()), Ok(String::new()));
    bench.request("set", "stiffness = 12.5").unwrap();
    bench.run(300);
    assert_eq!(bench.replies, ["stiffness=12.5 ...", "stiffness=12.5: done"]);
    assert_eq!(bench.number("stiffness"), 12.5);
    // The next numbers are judged beside the running numbers.
    let next = scene(12.5).with(Parameter::Damping, 1.0).unwrap();
    let sentence = wire::judge("damping=1", &mut Vec::new()).unwrap_err();
    assert!(is_refusal(&sentence, &next), "{sentence}");
}

#[test]
fn a_board_is_armed_and_disarming_waits_for_nothing() {
    let mut bench = Bench::new();
    bench.run(300);
    bench.request("arm", "").unwrap();
    let busy = bench.request("set", "stiffness=12").unwrap_err();
    assert!(busy.contains("has not answered the last request yet"), "{busy}");
    bench.run(200);
    assert_eq!(bench.board["is_armed"], true);
    assert!(bench.replies.contains(&"arm: done".to_owned()), "{:?}", bench.replies);
    bench.request("set", "stiffness=12").unwrap();
    bench.request("disarm", "").unwrap();
    bench.run(300);
    assert_eq!(bench.board["is_armed"], false);
    assert!(bench.replies.contains(&"disarm: done".to_owned()), "{:?}", bench.replies);
}

#[test]
fn a_record_has_a_row_for_each_tick() {
    let mut bench = Bench::new();
    bench.run(300);
    assert_eq!(bench.rows, "");
    wire::record("on", &mut Vec::new()).unwrap();
    bench.run(240);
    wire::record("off", &mut Vec::new()).unwrap();
    let ticks: Vec<u64> =
        bench.rows.lines().map(|row| row.split(',').next().unwrap().parse().unwrap()).collect();
    assert!(ticks.len() >= 220 && ticks.is_sorted(), "{ticks:?}");
    let columns = bench.rows.lines().next().unwrap().split(',').count();
    let facts: Value = serde_json::from_str(&wire::facts("", &mut Vec::new()).unwrap()).unwrap();
    assert_eq!(facts["columns"].as_str().unwrap().split(',').count(), columns);
    assert!(bench.rows.contains(",disarmed,"), "{}", bench.rows);
    bench.rows.clear();
    bench.run(100);
    assert_eq!(bench.rows, "");
}

#[test]
fn lost_bytes_are_asked_for_again() {
    let mut bench = Bench::new();
    let spoil = |tick: usize, bytes: &mut Vec<u8>| {
        if tick.is_multiple_of(3) {
            bytes.truncate(bytes.len() / 2);
        }
    };
    bench.run_with(3000, spoil);
    assert_eq!((bench.number("stiffness"), &bench.lost), (&22.0.into(), &None));
    bench.request("set", "stiffness=11").unwrap();
    bench.run_with(5000, spoil);
    assert_eq!(bench.number("stiffness"), 11.0);
}

#[test]
fn a_silent_board_is_lost_and_its_request_unanswered() {
    let mut bench = Bench::new();
    bench.run(300);
    bench.request("arm", "").unwrap();
    bench.now += 2900.0;
    bench.turn(&[]);
    assert_eq!(bench.lost, None);
    bench.now += 200.0;
    bench.turn(&[]);
    let lost = bench.lost.take().unwrap();
    assert_eq!(
        lost,
        "the board on the test has not answered the request for its status within 3 s"
    );
    assert!(bench.replies.last().unwrap().contains("it may have executed"), "{:?}", bench.replies);
    let unsent = bench.request("disarm", "").unwrap_err();
    assert_eq!(unsent, "disarm: not sent; there was no link to the board");
    // And again from the beginning.
    bench.start();
    bench.run(300);
    assert_eq!(bench.board["program"], "wall");
}

#[test]
fn no_board_and_another_version_are_said() {
    let mut bench = Bench::new();
    bench.now += 3100.0;
    bench.turn(&[]);
    let lost = bench.lost.take().unwrap();
    assert!(lost.starts_with("no board answers on the test within 3 s"), "{lost}");
    bench.start();
    let theirs = PROTOCOL + 1;
    let welcome = ToHost::Welcome { protocol: theirs, program: "wall" };
    let mut buffer = [0; 64];
    bench.turn(encode(&welcome, &mut buffer).unwrap());
    let lost = bench.lost.take().unwrap();
    assert_eq!(
        lost,
        format!(
            "the board on the test runs `wall` with version {theirs} of the protocol, but this program \
             speaks version {PROTOCOL}: flash the board again"
        )
    );
}

proptest! {
    #[test]
    fn any_bytes_are_taken(bytes in prop::collection::vec(any::<u8>(), 0..2000)) {
        let mut bench = Bench::new();
        bench.run(200);
        bench.turn(&bytes);
        bench.run(200);
        prop_assert_eq!(&bench.lost, &None);
        prop_assert_eq!(&bench.board["program"], "wall");
    }

    #[test]
    fn any_question_has_an_answer(question in ".{0,60}") {
        for function in [wire::start, wire::turn, wire::request, wire::judge, wire::curves, wire::record] {
            let _ = function(&question, &mut Vec::new());
        }
    }
}
