//! Any changes to scenes of every kind: from the bytes of a frame to a changed scene.
//!
//! Without the certificate, which takes a hundred times as long as all of this: `wire/session/tests.rs` has
//! random sets in a running servo.

use haptic_servo::certificate::Parameter;
use haptic_servo::environment::{Canceller, Environment, Parts, Side, Wall};
use haptic_servo::scene::{Coupling, Device, Scene};
use haptic_servo::tuning::{self, TUNABLE, TuningError};
use haptic_servo::wire::message::{LONGEST_TO_BOARD, ToBoard};
use haptic_servo::wire::{CHECKSUM, Decoder, encode, largest_frame};

/// The first byte says which scene, the rest is a message.
pub fn run(data: &[u8]) {
    let Some((kind, rest)) = data.split_first() else { return };
    let Ok((message, _)) = postcard::take_from_bytes::<ToBoard>(rest) else { return };
    let mut buffer = [0; largest_frame(LONGEST_TO_BOARD)];
    let frame = encode(&message, &mut buffer).expect("what was read fits a frame");
    let mut decoder = Decoder::<{ LONGEST_TO_BOARD + CHECKSUM }>::new();
    let heard = frame.iter().find_map(|&byte| decoder.push::<ToBoard>(byte));
    let Some(ToBoard::Set { changes, .. }) = heard else { return };
    let wall = Wall::damped(22.0, 0.01, 1);
    let filtered = wall.filtered(0.5).behind(0.1);
    let free = |wall| Parts { canceller: Some(Canceller::to(0.01)), wall, ..Parts::NONE }.sum();
    let environment = match kind % 9 {
        0 => wall.behind(0.0).alone(),
        1 => Wall { side: Side::Displaced(0.5), ..wall }.alone(),
        2 => Wall::spring(3.0, 2).alone(),
        3 => Wall::damped(3.0, 0.1, 1).filtered(0.5).alone(),
        4 => free(None),
        5 => free(Some(wall.behind(0.0))),
        6 => filtered.alone(),
        7 => Wall::spring(22.0, 1).behind(0.1).alone(),
        _ => free(Some(filtered)),
    };
    change(environment, &changes);
}

/// All of the changes or none, and nothing else.
fn change(environment: Environment, changes: &[(Parameter, f64)]) {
    let scene = Scene {
        coupling: Coupling::Spring { stiffness: 44.0 },
        torque_limit: Some(1.0),
        ..Scene::of(Device::damped(2.2e-5, 0.022), 0.001, environment)
    };
    let has = |parameter| tuning::get(&scene, parameter).is_some();
    let count = |parameter| changes.iter().filter(|(each, _)| *each == parameter).count();
    let is_tunable = |parameter| TUNABLE.iter().any(|(_, each)| *each == parameter);
    match tuning::apply(&scene, changes) {
        Ok(changed) => {
            for (_, parameter) in TUNABLE {
                let told = changes.iter().find(|(each, _)| *each == parameter);
                let before = tuning::get(&scene, parameter);
                let after = tuning::get(&changed, parameter);
                let wanted = told.map_or(before, |(_, value)| Some(*value));
                assert_eq!(after.map(f64::to_bits), wanted.map(f64::to_bits));
                assert!(count(parameter) <= 1);
            }
            assert!(changes.iter().all(|(parameter, _)| is_tunable(*parameter)));
            assert_eq!((changed.device, changed.timing), (scene.device, scene.timing));
        }
        Err(error) => {
            assert!(!error.to_string().is_empty());
            match error {
                TuningError::Fixed { parameter } => assert!(!is_tunable(parameter)),
                TuningError::Absent { parameter, .. } => assert!(!has(parameter)),
                TuningError::Twice { parameter } => assert!(count(parameter) > 1),
            }
        }
    }
}
