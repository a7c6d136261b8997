//! The client with a simulated board, and with ports that are no board.

use std::io::{Read, Write};
use std::net::TcpListener;
use std::num::NonZeroU32;
use std::thread::{self, JoinHandle};
use std::time::Duration;

use haptic_model::file::{Format, parse};
use haptic_servo::parameter::Parameter;
use haptic_servo::servo_loop::State;
use haptic_servo::wire::encode;
use haptic_servo::wire::message::{Changes, ToHost};

use super::simulated::{Pacing, SimulatedBoard};
use super::{Address, Link, LinkError, RequestResult};

fn loopback() -> Address {
    Address::Tcp("127.0.0.1:0".to_owned())
}

/// The board of a scene file with a wall of this stiffness.
fn board(stiffness: f64) -> Result<SimulatedBoard, String> {
    let text = format!(
        r#"
        name = "wall"
        device = {{ inertia = 2.2e-5, damping = 0.022 }}
        servo = {{ period = 0.001 }}
        coupling = {{ stiffness = 44.0 }}
        environment = {{ type = "damper-wall", stiffness = {stiffness}, damping = 0.005, delay = 1 }}
        limits = {{ torque = 1.0 }}"#
    );
    let file = parse("wall.toml", Format::Toml, &text).unwrap();
    SimulatedBoard::of_file(&file, &loopback(), Pacing::RealTime).map_err(|error| error.to_string())
}

/// Somebody else at a port: says `greeting` and returns all that it heard.
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
