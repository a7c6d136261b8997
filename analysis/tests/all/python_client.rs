//! The client in Python, which is written from `firmware/PROTOCOL.md`, against the messages of the
//! firmware and against a board that is a process.

use std::io::BufRead;
use std::process::{Command, Output, Stdio};

use crate::common::board::BoardProcess;
use crate::common::{answer, root, tool};
use haptic_servo::certificate::Parameter;
use haptic_servo::current::IndexOffset;
use haptic_servo::dac::DacCode;
use haptic_servo::encoder::CounterWidth;
use haptic_servo::environment::{Canceller, Drag, Parts, Wall};
use haptic_servo::fault::Fault;
use haptic_servo::number::Format;
use haptic_servo::power_reading::PowerReading;
use haptic_servo::scene::{Coupling, Device, Latency, Scene, Timing};
use haptic_servo::servo::{OutputTiming, RenderingOptions, Step, Transducers};
use haptic_servo::servo_loop::{Frame, State};
use haptic_servo::torque::LimitReason;
use haptic_servo::wire::description::Description;
use haptic_servo::wire::message::{
    ActiveParameters, BoardUnits, Changes, Outcome, PreviousFault, Refusal, Status, ToBoard, ToHost,
};
use haptic_servo::wire::telemetry::Batch;
use haptic_servo::wire::{Decoder, Discarded, PROTOCOL, encode};
use serde::Serialize;
use serde_json::{Value, json};

/// Runs Python beside the client.
fn python(arguments: &[&str]) -> Output {
    Command::new(tool("python3"))
        .args(arguments)
        .current_dir(root().join("analysis/examples"))
        // Leaves nothing behind in the repository.
        .env("PYTHONDONTWRITEBYTECODE", "1")
        .stdin(Stdio::null())
        .output()
        .unwrap()
}

/// The output of a few lines of Python with these arguments.
fn printed(code: &str, arguments: &[String]) -> Value {
    let arguments = arguments.iter().map(String::as_str);
    let output = python(&["-c", code].into_iter().chain(arguments).collect::<Vec<_>>());
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    answer(&output)
}

fn hex(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| format!("{byte:02x}")).collect()
}

fn framed(message: &impl Serialize) -> String {
    let mut buffer = [0; 2000];
    hex(encode(message, &mut buffer).unwrap())
}

const DECODE: &str = "import client, json, sys; print(json.dumps([client.decode(client.unframe(\
                      bytes.fromhex(frame)[1:-1])) for frame in sys.argv[1:]]))";

fn fault() -> Fault {
    Fault::EncoderJump { counts: 5000, largest: 979 }
}

fn status() -> Status {
    Status {
        state: State::Settling,
        fault: Some(fault().into()),
        link_lost: true,
        tick: u32::MAX,
        count: -70_000_000_000,
        sets: 3,
        missed: 4,
        worst_slack: 170_000,
        energy: i64::MIN,
        worst_deficit: i64::MAX,
        dropped: 5,
        thinned: 6,
        discarded: Discarded { broken: 7, too_long: 8, checksum: 9, unknown: 10 },
        stack_left: Some(2048),
        reset: haptic_servo::reset::ResetCause::Pin,
        low_brown_out: true,
        power: Some(PowerReading {
            current: -412,
            reference: i32::MIN,
            voltage: u32::MAX,
            temperature: -15,
            index: Some(IndexOffset { counts: 16_777_215, is_reversed: true }),
        }),
    }
}

fn description() -> Description {
    let wall = Wall::damped(22.0, 0.01, 300).filtered(0.5).behind(-0.1);
    let canceller = Some(Canceller::to(0.01));
    let drag = Some(Drag::of(-0.5, 2));
    Description {
        scene: Scene {
            device: Device { inertia: 0.25, damping: 0.022, passivity: Some(0.02) },
            timing: Timing { period: 0.001, worst_period: None },
            coupling: Coupling::Spring { stiffness: 44.0 },
            environment: Parts { canceller, wall: Some(wall), drag, ..Parts::NONE }.sum(),
            latency: Latency::NONE,
            torque_limit: Some(1.5),
        },
        transducers: Transducers {
            counts_per_turn: 61_440.0,
            counter: CounterWidth::Bits16,
            full_scale_torque: 2.0,
            largest_speed: Transducers::NO_HAND_IS_FASTER,
        },
        rendering: RenderingOptions::DEFAULT,
        format: Format::Fixed { fraction_bits: 24 },
        timing: OutputTiming::Latched,
    }
}

#[test]
#[cfg_attr(no_python, ignore = "this machine has no python3, and set-up may not install it")]
fn reads_every_message_to_the_host() {
    let frame = |tick, count, code| {
        let (limit, state) = (LimitReason::Ramp, State::FadingOut);
        Frame { tick, count, code: DacCode::new(code).unwrap(), limit, state, slack: 79 }
    };
    let mut batch = Batch::new();
    batch.push(frame(u32::MAX, -40, 4095)).unwrap();
    batch.push(frame(1, i32::MAX, 0)).unwrap();
    let mut values = Changes::new();
    values.push((Parameter::TorqueLimit, 0.1)).unwrap();
    let numbers = BoardUnits {
        period: 0.001,
        timer_counts: 170_000,
        counts_per_turn: 61_440.0,
        full_scale_torque: 2.0,
        energy_step: 0.25,
        longest_gap: 0.036,
    };
    let remembered = PreviousFault { fault: fault().into(), tick: 300, count: -1 };
    let running = ActiveParameters { sets: 2, margin: None, values };
    let refused = Outcome::Refused(Refusal::Set(Step::Servo));
    let unarmed = Outcome::Refused(Refusal::Fault(fault().into()));
    let messages = [
        ToHost::Welcome { protocol: PROTOCOL, program: "damper_wall" },
        ToHost::Board(numbers),
        ToHost::ActiveParameters(running),
        ToHost::Status(status()),
        ToHost::Answer { id: 65_535, outcome: refused },
        ToHost::Answer { id: 7, outcome: unarmed },
        ToHost::Answer { id: 0, outcome: Outcome::Done },
        ToHost::PreviousFault(remembered),
        ToHost::Telemetry(batch),
        ToHost::Described(description()),
    ];
    let read = include_str!("messages.txt").replace("PROTOCOL", &PROTOCOL.to_string());
    let read: Value = serde_json::from_str(&read).unwrap();
    assert_eq!(printed(DECODE, &messages.map(|message| framed(&message))), read);
}

#[test]
#[cfg_attr(no_python, ignore = "this machine has no python3, and set-up may not install it")]
fn frames_are_those_of_the_board() {
    let code = "import client, json, sys; print(json.dumps([[client.frame(\
                client.unframe(bytes.fromhex(frame)[1:-1])).hex(), client.unframe(bytes.fromhex(\
                frame)[1:-3]) is None] for frame in sys.argv[1:]]))";
    // Around the length of a block, ended by a zero of the length or of the end.
    let long = (240..260).flat_map(|length| [(length, 1), (length, 0)]);
    let mut messages: Vec<Vec<u8>> = long.map(|(length, first)| vec![first; length]).collect();
    messages.extend([vec![], vec![0], vec![1, 0, 2, 0]]);
    let frames: Vec<String> = messages.iter().map(framed).collect();
    let found = printed(code, &frames);
    for (frame, found) in frames.iter().zip(found.as_array().unwrap()) {
        assert_eq!(found, &json!([frame, true]));
    }
}

#[test]
#[cfg_attr(no_python, ignore = "this machine has no python3, and set-up may not install it")]
fn what_it_sends_is_a_message_to_the_board() {
    let code = "import client, json
class Told(client.Board):
    def __init__(self): self.sent, self.id = [], 299
    def ask(self, message, *_, **__):
        self.sent.append(client.frame(message).hex())
        return {'id': self.id, 'refused': None}
board = Told()
board.set([('stiffness', 12.5), ('torque_limit', -1)])
board.request(client.ARM)
print(json.dumps(board.sent))";
    let sent = printed(code, &[]);
    let mut decoder = Decoder::<200>::new();
    let mut hear = |frame: &Value| -> Option<ToBoard> {
        let digits = frame.as_str().unwrap().as_bytes();
        let byte = |two: &[u8]| u8::from_str_radix(std::str::from_utf8(two).unwrap(), 16).unwrap();
        digits.chunks(2).find_map(|two| decoder.push(byte(two)))
    };
    let changes = [(Parameter::Stiffness, 12.5), (Parameter::TorqueLimit, -1.0)];
    let changes = Changes::from_slice(&changes).unwrap();
    assert_eq!(hear(&sent[0]), Some(ToBoard::Set { id: 300, changes }));
    assert_eq!(hear(&sent[1]), Some(ToBoard::Arm { id: 301 }));
}

#[test]
#[cfg_attr(no_python, ignore = "this machine has no python3, and set-up may not install it")]
fn says_how_it_is_used() {
    let usage =
        |text: &[u8]| String::from_utf8_lossy(text).starts_with("A client of a haptic board");
    let help = python(&["client.py", "--help"]);
    assert!(help.status.code() == Some(0) && usage(&help.stdout), "{help:?}");
    let nothing = python(&["client.py"]);
    assert!(nothing.status.code() == Some(2) && usage(&nothing.stderr), "{nothing:?}");
}

#[test]
#[cfg_attr(no_python, ignore = "this machine has no python3, and set-up may not install it")]
fn talks_to_a_board() {
    let board = BoardProcess::start("damper_wall", &["--for", "60"]);
    let ask = |arguments: &[&str]| python(&[&["client.py", &board.port], arguments].concat());
    let running = answer(&ask(&["set", "stiffness=12.5", "damping=0.002"]));
    assert_eq!((&running["program"], &running["sets"]), (&"damper_wall".into(), &1.into()));
    assert_eq!(running["values"]["stiffness"], 12.5);
    let refused = ask(&["set", "stiffness=300"]);
    assert_eq!(refused.status.code(), Some(1), "{refused:?}");
    let reason = String::from_utf8_lossy(&refused.stderr);
    assert_eq!(reason, "refused by its certificate; `haptic tune` says why\n");
    let described = answer(&ask(&["describe"]));
    assert_eq!(described["scene"]["environment"]["wall"]["stiffness"], 12.5);
    assert_eq!(described["timing"]["type"], "latched");
    let status = answer(&ask(&["disarm"]));
    assert_eq!((&status["state"], &status["sets"]), (&"disarmed".into(), &1.into()));
    assert_eq!(answer(&ask(&["arm"]))["fault"], Value::Null);
    let stream = ask(&["stream", "30", "7"]);
    let ticks: Vec<Value> =
        stream.stdout.lines().map(|line| serde_json::from_str(&line.unwrap()).unwrap()).collect();
    assert_eq!(ticks.len(), 30, "{stream:?}");
    let later =
        |pair: &[Value]| pair[1]["tick"].as_u64().unwrap() - pair[0]["tick"].as_u64().unwrap();
    assert!(ticks.windows(2).all(|pair| later(pair) == 7), "{ticks:?}");
    for (wrong, words) in [
        (&["fly"][..], "there is no command fly"),
        (&["set", "stifness=3"], "there is no parameter `stifness`; there are coupling.stiffness,"),
        (&["set", "stiffness"], "`stiffness` is not NAME=VALUE"),
        (&["set", "stiffness=much"], "`much` is not a number for stiffness"),
        (&["set"], "set takes a NAME=VALUE or more"),
        (&["stream"], "stream takes two numbers: TICKS and EVERY"),
        (&[], "a command must follow the port"),
    ] {
        let said = ask(wrong);
        assert_eq!(said.status.code(), Some(2), "{wrong:?}");
        assert!(String::from_utf8_lossy(&said.stderr).starts_with(words), "{said:?}");
    }
}
