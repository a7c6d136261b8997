//! A stream of torques from a host to a board whose own bridge drives the motor.

use analysis::file::{Format, parse, program};
use analysis::link::Message;
use analysis::toolchain::{BoardModel, NumberFormat, Tools, TorqueOutput, prepare};
use haptic_servo::certificate::Parameter;
use haptic_servo::current::{CurrentLoop, PowerFault};
use haptic_servo::fault::Fault;
use haptic_servo::servo_loop::State;
use haptic_servo::wire::host::{HostCommand, HostReport, HostRequest, HostState};
use haptic_servo::wire::message::{Outcome, ToBoard};
use virtual_board::chip::B_G431B_ESC1;
use virtual_board::device::FixedDevice;

use super::bench::{armed, circuit, motor, supply};
use crate::bench::Bench;

/// A board with the program of the file, and the current loop of its motor.
fn boot() -> (Bench, CurrentLoop) {
    let text = include_str!("hosted.toml");
    let file = parse("hosted.toml", Format::Toml, text).unwrap_or_else(|error| panic!("{error}"));
    let transducers = file.board_transducers(None, None).unwrap();
    let bridge = file.on_bridge(&transducers).unwrap().unwrap();
    let text = program::program(&file, &transducers, Some(&bridge), "hosted.toml").unwrap();
    let toolchain = prepare(Tools::Compiler).unwrap_or_else(|error| panic!("{error}"));
    let written = toolchain.write_scene("hosted_bridge", &text).unwrap();
    let board = BoardModel::find(B_G431B_ESC1.name).unwrap();
    let board = Some((board, TorqueOutput::Bridge));
    let built = toolchain.build_written(&written, board, NumberFormat::F32, file.chip);
    let elf = built.unwrap_or_else(|error| panic!("{error}")).path;
    let mut bench = Bench::boot_file(&B_G431B_ESC1, &elf, FixedDevice);
    let drive = bridge.current_loop.drive();
    let circuit = circuit(&mut bench);
    circuit.motor = Some(motor(drive));
    circuit.supply = supply(drive);
    (bench, bridge.current_loop)
}

/// A tick with a command; the reports that came.
fn sent(bench: &mut Bench, number: u16, torque: f32) -> Vec<HostState> {
    let command = HostCommand { number, torque, ramp: 0 };
    bench.say(&ToBoard::Host(HostRequest::Torque(command)));
    bench.run(1);
    let state = |message| match message {
        Message::Host(HostReport::State(state)) => Some(state),
        _ => None,
    };
    bench.hear().into_iter().filter_map(state).collect()
}

/// Also that the motor makes the torque, and that a fault of the bridge empties the tank.
#[test]
fn a_stream_at_1_khz_loses_no_tick_and_a_fault_of_the_bridge_empties_the_tank() {
    let (mut bench, current_loop) = boot();
    armed(&mut bench);
    bench.run(125);
    bench.hear();
    let torque = |number: u16| 0.12 * (f32::from(number) * 0.02).sin();
    let mut states = Vec::new();
    for number in 1..=1000 {
        states.extend(sent(&mut bench, number, torque(number)));
    }
    let status = bench.status();
    assert_eq!((status.missed, status.dropped, status.state), (0, 0, State::Running));
    assert!(states.len() >= 995, "{} reports", states.len());
    assert!(states.windows(2).all(|two| two[1].number == two[0].number + 1));
    assert!(states.iter().all(|state| state.refused == 0.0 && state.energy > 0.03), "{states:?}");
    println!("worst slack: {} timer counts", status.worst_slack);
    // A set is certified in the deepest stack.
    let changes = [(Parameter::Stiffness, 0.4)].into_iter().collect();
    assert_eq!(bench.request(|id| ToBoard::Set { id, changes }), Outcome::Done);
    let left = bench.status().stack_left;
    assert!(left.is_some_and(|left| left >= 1024), "{left:?} bytes of stack");
    println!("{left:?} bytes of stack left");
    bench.run(60);
    // The torque of the currents at the end of a stream that stays.
    for number in 1001..1020 {
        sent(&mut bench, number, -0.12);
    }
    let made = circuit(&mut bench).mean_torque();
    let off = current_loop.resolution();
    println!("{made} N m, {off:?}");
    assert!((made + 0.12).abs() < 0.01, "{made} N m");
    // A broken wire.
    if let Some(motor) = &mut circuit(&mut bench).motor {
        motor.resistance = 1e3;
    }
    bench.run(20);
    let fault = bench.fault();
    assert!(
        matches!(fault, Some(Fault::Power(PowerFault::CurrentNotFollowing { .. }))),
        "{fault:?}"
    );
    let states: Vec<_> = (1020..1030).flat_map(|number| sent(&mut bench, number, 0.1)).collect();
    assert!(states.iter().all(|state| state.energy < 0.03), "{states:?}");
}
