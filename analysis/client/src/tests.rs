//! The client with a simulated board, and with ports that are no board.

use std::collections::VecDeque;
use std::io::{Read, Write};
use std::net::TcpListener;
use std::num::NonZeroU32;
use std::thread::{self, JoinHandle};
use std::time::Duration;

use haptic_model::file::{Format, parse};
use haptic_servo::host::HostTorque;
use haptic_servo::parameter::Parameter;
use haptic_servo::servo_loop::State;
use haptic_servo::torque::LimitReason;
use haptic_servo::wire::host::{HostReport, HostRequest, HostState};
use haptic_servo::wire::message::{BoardUnits, Changes, LONGEST_TO_BOARD, ToBoard, ToHost};
use haptic_servo::wire::{CHECKSUM, Decoder, PROTOCOL, encode};

use super::simulated::{Pacing, SimulatedBoard};
use super::{Address, Link, LinkError, RequestResult, StreamError, StreamTick, change};

fn loopback() -> Address {
    Address::Tcp("127.0.0.1:0".to_owned())
}

/// The board of a scene file with a wall of this stiffness.
fn board(stiffness: f64) -> Result<SimulatedBoard, String> {
    board_with(stiffness, "")
}

/// The same with other tables.
fn board_with(stiffness: f64, tables: &str) -> Result<SimulatedBoard, String> {
    let text = format!(
        r#"
        name = "wall"
        device = {{ inertia = 2.2e-5, damping = 0.022 }}
        servo = {{ period = 0.001 }}
        coupling = {{ stiffness = 43.0 }}
        environment = {{ type = "damper-wall", stiffness = {stiffness}, damping = 0.005, delay = 1 }}
        limits = {{ torque = 1.0 }}
        {tables}"#
    );
    let file = parse("wall.toml", Format::Toml, &text).unwrap();
    SimulatedBoard::of_file(&file, &loopback(), Pacing::RealTime).map_err(|error| error.to_string())
}

/// Another program at a port, which says `greeting` and returns all that it heard.
fn other(greeting: Vec<u8>) -> (Address, JoinHandle<Vec<u8>>) {
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let address = Address::Tcp(listener.local_addr().unwrap().to_string());
    let thread = thread::spawn(move || {
        let (mut stream, _) = listener.accept().unwrap();
        stream.write_all(&greeting).unwrap();
        let mut heard = Vec::new();
        stream.read_to_end(&mut heard).unwrap();
        heard
    });
    (address, thread)
}

#[test]
fn the_budget_of_a_host_changes_while_its_board_runs() {
    let host =
        "host = { energy = 0.05, power = 0.5, damping = 0.004, torque = 0.5, timeout = 0.05 }";
    let board = board_with(10.0, host).unwrap();
    let mut link = Link::open(board.address()).unwrap();
    let budget = |link: &Link| link.board().budget.unwrap();
    assert_eq!((budget(&link).energy, budget(&link).power), (0.05, 0.5));
    assert_eq!(link.arm().unwrap(), RequestResult::Done);
    let request = change::line("host.energy=0.1 host.power=0").unwrap();
    assert_eq!(link.request(request).unwrap(), RequestResult::Done);
    let changed = HostTorque { energy: 0.1, power: 0.0, ..budget(&link) };
    assert_eq!(budget(&link), changed);
    let margin = link.parameters().unwrap().margin.unwrap() + changed.damping;
    for refused in ["host.damping=0.02", "stiffness=28", "host.torque=1.5", "host.timeout=0.001"] {
        let result = link.request(change::line(refused).unwrap()).unwrap();
        let RequestResult::Refused(why) = result else { panic!("{refused} was not refused") };
        let bounds = ["below the margin of", "full scale of 1.5 N m", "two periods"];
        assert!(bounds.iter().any(|bound| why.contains(bound)), "{why}");
        if refused.contains("damping") {
            let stated = why.split("margin of ").nth(1).unwrap().split(' ').next().unwrap();
            assert!((stated.parse::<f64>().unwrap() - margin).abs() < 1e-9, "{why} {margin}");
        }
    }
    assert_eq!(budget(&link), changed);
}

/// A host's torque and what opposes the cogging are both beside the scene's limit: more of one is refused where
/// there is no room for all three.
#[test]
fn a_host_keeps_its_room_beside_what_opposes_cogging() {
    let tables = r#"
        host = { energy = 0.05, power = 0.5, damping = 0.001, torque = 0.5, timeout = 0.05 }
        anticogging = { torque = [0, 0.01, 0.02, 0.01, 0, -0.01, -0.02, -0.01], share = 0.5 }"#;
    let board = board_with(5.0, tables).unwrap();
    let mut link = Link::open(board.address()).unwrap();
    let mut share = |share| link.request(change::line(share).unwrap()).unwrap();
    let RequestResult::Refused(why) = share("anticogging=0.6") else {
        panic!("it was not refused")
    };
    assert!(why.contains("the 1.012 N m of the scene") && why.contains("1.51 N m"), "{why}");
    assert_eq!(share("anticogging=0.4"), RequestResult::Done);
}

#[test]
fn a_scene_file_runs_on_a_board_that_is_tuned_and_watched() {
    let board = board(20.0).unwrap();
    let mut link = Link::open(board.address()).unwrap();
    let softer = Changes::from_slice(&[(Parameter::Stiffness, 12.5)]).unwrap();
    assert_eq!(link.set(softer.clone()).unwrap(), RequestResult::Done);
    assert_eq!(link.arm().unwrap(), RequestResult::Done);
    let running = link.parameters().unwrap();
    assert!(running.sets == 1 && running.values.contains(&softer[0]), "{running:?}");
    assert!(link.description().unwrap().scene.certify().is_ok());
    let refused = link.set(Changes::from_slice(&[(Parameter::Stiffness, 40.0)]).unwrap()).unwrap();
    let RequestResult::Refused(why) = refused else { panic!("it was not refused") };
    assert!(why.contains("it would pass with stiffness <= "), "{why}");
    let mut ticks = Vec::new();
    let three = NonZeroU32::new(3).unwrap();
    link.telemetry(Duration::from_secs(20), three, |sample| {
        ticks.push(sample.tick);
        ticks.len() < 100
    })
    .unwrap();
    assert!(ticks.len() == 100 && ticks.windows(2).all(|two| two[1] - two[0] == 3), "{ticks:?}");
    assert_eq!(link.disarm().unwrap(), RequestResult::Done);
    assert_eq!(link.status().unwrap().state, State::Disarmed);
    drop(board);
    let lost = link.status().unwrap_err();
    assert!(matches!(lost, LinkError::Lost { .. }), "{lost}");
}

/// A board does not send the readings of its encoder: what it refuses for their sake has no false reason.
#[test]
fn a_refusal_for_the_sake_of_the_encoder_says_so() {
    let text = include_str!("../../explore/src/presets/gimbal_knob.toml");
    let file = parse("gimbal_knob.toml", Format::Toml, text).unwrap();
    let board = SimulatedBoard::of_file(&file, &loopback(), Pacing::Unthrottled).unwrap();
    let mut link = Link::open(board.address()).unwrap();
    let mut refused = |change: &str| match link.request(change::line(change).unwrap()).unwrap() {
        RequestResult::Refused(why) => why,
        other => panic!("{change}: {other:?}"),
    };
    // Friction does not hold the mean torque through the nonlinear encoder.
    let motor = refused("torque=0.09");
    assert!(motor.contains("the readings of its encoder and its friction"), "{motor}");
    let steep = refused("count=200");
    assert!(steep.contains("N m s/rad of damping"), "{steep}");
}

/// The hand moves the gimbal knob over its cogging, and not against a friction that is stronger than the hand.
#[test]
fn the_device_of_a_file_cogs_and_rubs() {
    let text = include_str!("../../explore/src/presets/gimbal_knob.toml");
    let swing = |text: &str| {
        let file = parse("gimbal_knob.toml", Format::Toml, text).unwrap();
        let board = SimulatedBoard::of_file(&file, &loopback(), Pacing::Unthrottled).unwrap();
        let mut link = Link::open(board.address()).unwrap();
        assert_eq!(link.arm().unwrap(), RequestResult::Done);
        let (mut positions, every) = (Vec::new(), NonZeroU32::new(100).unwrap());
        link.telemetry(Duration::from_secs(60), every, |sample| {
            positions.push(sample.position);
            positions.len() < 200
        })
        .unwrap();
        positions.iter().fold(0.0, |most: f64, position| most.max(position.abs()))
    };
    let moved = swing(text);
    assert!(moved > 0.5, "{moved}");
    let stuck = swing(&text.replace("friction = 0.003", "friction = 30.0"));
    assert!(stuck < 0.01, "{stuck}");
    let (weak, strong) = ("cogging = { torque = 0.005", "cogging = { torque = 30.0");
    let held = swing(&text.replace(weak, strong));
    assert!(held < std::f64::consts::TAU / 84.0, "{held}");
}

/// As many readings fail in a row as the scene allows: the one before takes their place, or their ticks are missed
/// updates. One more is a fault.
#[test]
fn readings_fail_as_the_file_says() {
    const WALL: &str = r#"
        name = "wall"
        device = { inertia = 2.2e-5, damping = 0.022 }
        servo = { period = 0.001 }
        environment = { type = "damper-wall", stiffness = 4.0, damping = 0, delay = 1 }
        encoder = { dropped = 2 }
        limits = { torque = 1.0 }
        simulation = { samples = 9, dropped = { every = 3, length = 2 } }"#;
    let run = |replaced: &[(&str, &str)]| {
        let text = replaced.iter().fold(WALL.to_owned(), |text, (from, to)| text.replace(from, to));
        let file = parse("wall.toml", Format::Toml, &text).unwrap();
        let board = SimulatedBoard::of_file(&file, &loopback(), Pacing::Unthrottled).unwrap();
        let mut link = Link::open(board.address()).unwrap();
        let armed = link.arm().unwrap();
        let mut rows = Vec::new();
        link.telemetry(Duration::from_secs(60), NonZeroU32::MIN, |sample| {
            rows.push((sample.tick, sample.position));
            rows.len() < 3000
        })
        .unwrap();
        (rows, link.status().unwrap(), armed)
    };
    let (rows, held, armed) = run(&[]);
    assert_eq!((armed, held.fault, held.missed), (RequestResult::Done, None, 0));
    // One tick in three reads.
    let read = |rows: &[(u64, f64)], tick: u64| {
        let of = |two: &&[(u64, f64)]| two[1].0 % 3 == tick && two[1].0 - two[0].0 == 1;
        let moved = rows.windows(2).filter(of).filter(|two| two[0].1 != two[1].1);
        moved.count()
    };
    let mut moved = [0, 1, 2].map(|tick| read(&rows, tick));
    moved.sort_unstable();
    assert!(moved[..2] == [0, 0] && moved[2] > 100, "{moved:?}");
    let longer = ("period = 0.001", "period = 0.001, worst_period = 0.003");
    let (rows, left_out, _) = run(&[longer, ("damping = 0,", "damping = 0.001,")]);
    assert!(left_out.fault.is_none() && left_out.missed > 2000, "{left_out:?}");
    assert!(rows.windows(2).all(|two| (two[1].0 - two[0].0) % 3 == 0), "{rows:?}");
    let (.., armed) = run(&[("dropped = 2", "dropped = 1")]);
    let RequestResult::Refused(why) = armed else { panic!("{armed:?}") };
    assert!(why.contains("failed more than 1 times in a row"), "{why}");
}

#[test]
fn a_scene_that_no_board_renders_does_not_start() {
    let rejected = board(4e3).unwrap_err();
    assert!(rejected.starts_with("refused by its certificate: "), "{rejected}");
}

#[test]
fn a_port_without_a_board_is_told_from_one() {
    let nowhere = Link::open(&"unix:/nowhere/board".parse().unwrap()).err().unwrap();
    assert!(matches!(nowhere, LinkError::Open { .. }), "{nowhere}");
    let (address, mute) = other(b"220 mail.example.org ESMTP\r\n".to_vec());
    let error = Link::open(&address).err().unwrap().to_string();
    assert!(error.contains(&format!("no board answers on {address}")), "{error}");
    assert!(mute.join().unwrap().len() > 20, "it was asked more than once");
}

#[test]
fn a_board_of_another_version_is_not_used() {
    let mut buffer = [0; 64];
    let welcome = ToHost::Welcome { protocol: 9999, program: "newer" };
    let (address, heard) = other(encode(&welcome, &mut buffer).unwrap().to_vec());
    let error = Link::open(&address).err().unwrap();
    assert!(matches!(error, LinkError::Protocol(_)), "{error}");
    assert!(error.to_string().contains("9999"), "{error}");
    heard.join().unwrap();
}

/// A board that takes torques, and moves by 0.1 rad in each tick of 1 ms that takes a torque. It is gone after
/// so many, and returns them. It answers each after that number of further ones, so many at a time.
fn streamed(ticks: usize, late: usize, at_a_time: usize) -> (Link, JoinHandle<Vec<f32>>) {
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let address = Address::Tcp(listener.local_addr().unwrap().to_string());
    let thread = thread::spawn(move || {
        let (mut stream, _) = listener.accept().unwrap();
        let mut decoder = Decoder::<{ LONGEST_TO_BOARD + CHECKSUM }>::new();
        let (mut torques, mut waiting) = (Vec::new(), VecDeque::new());
        while torques.len() < ticks {
            let mut byte = [0];
            if stream.read_exact(&mut byte).is_err() {
                break;
            }
            let Some(asked) = decoder.push(byte[0]) else { continue };
            waiting.extend(answers(&asked, &mut torques));
            let answered = match asked {
                ToBoard::Host(_) if waiting.len() < late + at_a_time => 0,
                ToBoard::Host(_) => at_a_time,
                _ => waiting.len(),
            };
            for message in waiting.drain(..answered) {
                let mut buffer = [0; 128];
                // A client that has left waits for no answer.
                if stream.write_all(encode(&message, &mut buffer).unwrap()).is_err() {
                    return torques;
                }
            }
        }
        torques
    });
    (Link::open(&address).unwrap(), thread)
}

fn answers(asked: &ToBoard, torques: &mut Vec<f32>) -> Vec<ToHost<&'static str>> {
    let units = BoardUnits {
        period: 0.001,
        timer_counts: 1000,
        counts_per_turn: std::f64::consts::TAU * 10.0,
        full_scale_torque: 2.0,
        energy_step: 1e-6,
        longest_gap: 0.036,
    };
    let budget =
        HostTorque { energy: 0.05, power: 0.5, damping: 0.004, torque: 0.5, timeout: 0.05 };
    match asked {
        ToBoard::Hello => vec![
            ToHost::Welcome { protocol: PROTOCOL, program: "hosted" },
            ToHost::Host(HostReport::Budget(budget)),
            ToHost::Board(units),
        ],
        ToBoard::Host(HostRequest::Torque(command)) => {
            let tick = torques.len() as u32;
            torques.push(command.torque);
            vec![ToHost::Host(HostReport::State(HostState {
                number: command.number,
                tick: tick.wrapping_sub(3),
                count: i32::MAX.wrapping_add_unsigned(tick),
                velocity: 100.0,
                energy: 0.04,
                torque: command.torque,
                refused: 0.0,
                limit: LimitReason::None,
                state: State::Running,
                invalid: 0,
            }))]
        }
        _ => Vec::new(),
    }
}

/// So slow in Hz that an answer comes before the next command.
const RATE: f64 = 50.0;

/// The times and torques of a stream until 5 ms.
fn until_5_ms(torque: f64) -> impl FnMut(&StreamTick) -> Result<Option<f64>, StreamError> {
    move |tick| Ok((tick.time < 4.5e-3).then_some(torque))
}

#[test]
fn a_stream_gets_the_motion_and_ends_at_zero() {
    let (mut link, board) = streamed(usize::MAX, 0, 1);
    let mut ticks = Vec::new();
    let mut torque = until_5_ms(0.25);
    let streamed = link.stream(RATE, true, |tick| {
        ticks.push(*tick);
        torque(tick)
    });
    streamed.unwrap();
    assert_eq!(ticks.len(), 6);
    for (i, two) in ticks.windows(2).enumerate() {
        assert!((two[0].time - 0.001 * i as f64).abs() < 1e-12, "{ticks:?}");
        assert!((two[1].position - two[0].position - 0.1).abs() < 1e-6, "{ticks:?}");
    }
    drop(link);
    assert_eq!(board.join().unwrap(), [0.0, 0.25, 0.25, 0.25, 0.25, 0.25, 0.0]);
}

/// As on a serial line, where a command, its tick and its report take more than the period of a stream at 1 kHz; and
/// with a rate that beats with the board's ticks, so that two reports come between two commands, and then none.
#[test]
fn a_stream_keeps_its_rate_where_answers_are_late() {
    for (late, at_a_time) in [(3, 1), (0, 2), (2, 2)] {
        let (mut link, board) = streamed(usize::MAX, late, at_a_time);
        let mut times = Vec::new();
        let streamed = link.stream(100.0, true, |tick| {
            times.push(tick.time);
            Ok::<_, StreamError>((times.len() < 20).then_some(0.1))
        });
        streamed.unwrap();
        drop(link);
        // Waiting for each answer, three further commands late, would take four commands for a call; the newest of
        // two answers alone, two.
        let (commands, calls) = (board.join().unwrap().len(), times.len());
        assert!((calls..calls + 10).contains(&commands), "{commands} commands for {calls} calls");
        assert!(times.is_sorted_by(|before, after| before < after), "{times:?}");
    }
}

#[test]
fn a_stream_that_fails_switches_its_torque_off() {
    for wrong in [f64::NAN, f64::INFINITY, 1e300] {
        let (mut link, board) = streamed(usize::MAX, 0, 1);
        let wrong_at_2_ms = |tick: &StreamTick| {
            Ok::<_, StreamError>(Some(if tick.time < 1.5e-3 { 0.1 } else { wrong }))
        };
        let error = link.stream(RATE, false, wrong_at_2_ms).unwrap_err().to_string();
        assert!(error.contains(&format!("a torque of {wrong:?} N m at 0.002 s")), "{error}");
        drop(link);
        assert_eq!(board.join().unwrap(), [0.0, 0.1, 0.1, 0.0]);
    }
}

#[test]
fn a_stream_without_a_board_or_a_rate_has_a_reason() {
    let (mut link, board) = streamed(3, 0, 1);
    let lost = link.stream(1000.0, true, until_5_ms(0.1)).unwrap_err();
    assert!(matches!(lost, StreamError::Link(LinkError::Lost { .. })), "{lost}");
    board.join().unwrap();
    for rate in [0.0, -1.0, f64::NAN, 39.9, 1001.0] {
        let error = link.stream(rate, true, until_5_ms(0.1)).unwrap_err().to_string();
        assert!(error.contains(&format!("{rate} Hz; it must be from 40 to 1000 Hz")), "{error}");
    }
    let board = self::board(20.0).unwrap();
    let mut link = Link::open(board.address()).unwrap();
    let error = link.stream(100.0, true, until_5_ms(0.1)).unwrap_err().to_string();
    assert!(error.contains("the program wall takes no torque from a host"), "{error}");
}

/// A host that pushes along the velocity is limited by the tank; a torque that is no number is none.
#[test]
fn a_scene_file_with_a_host_takes_the_torques_of_a_stream() {
    let host = |damping: f64| {
        format!(
            "host = {{ energy = 0.01, power = 0.1, damping = {damping}, torque = 0.5, timeout = 0.05 }}"
        )
    };
    let greedy = board_with(5.0, &host(0.05)).unwrap_err();
    assert!(greedy.contains("the host's share of damping is 0.05 N m s/rad"), "{greedy}");
    let board = board_with(5.0, &host(0.004)).unwrap();
    let mut link = Link::open(board.address()).unwrap();
    assert_eq!(link.arm().unwrap(), RequestResult::Done);
    let mut ticks = Vec::new();
    let stiffer = [(Parameter::Stiffness, 10.0), (Parameter::Damping, 0.01)];
    let refused = link.set(Changes::from_slice(&stiffer).unwrap()).unwrap();
    let RequestResult::Refused(why) = refused else { panic!("{refused:?}") };
    assert!(
        why.contains("the host's share of damping is 0.004 N m s/rad, and must be below"),
        "{why}"
    );
    let streamed = link.stream(500.0, false, |tick| {
        ticks.push(*tick);
        let torque = if tick.velocity >= 0.0 { 0.5 } else { -0.5 };
        Ok::<_, StreamError>((tick.time < 1.0).then_some(torque))
    });
    streamed.unwrap();
    let running = ticks.iter().filter(|tick| tick.state == State::Running);
    let limited = running.clone().filter(|tick| tick.limit == LimitReason::Energy).count();
    assert!(running.clone().any(|tick| tick.torque.abs() > 0.1) && limited > 10, "{limited}");
    assert!(running.clone().all(|tick| tick.torque.abs() <= 0.5 && tick.energy <= 0.01));
}
