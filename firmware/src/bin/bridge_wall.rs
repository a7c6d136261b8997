//! The damper wall on a motor board: the board's own bridge drives a brushed motor, and the latency of its
//! current loop is the scene's.
#![cfg_attr(target_os = "none", no_std, no_main)]

mod paddle;

use firmware::certificate::Certified;
use firmware::current::{B_G431B_ESC1, CurrentLoop, Drive, Motor, Supply, Winding};
use firmware::environment::{DamperWall, Matched, OneSided};
use firmware::output_timing::OutputTiming;
use firmware::scene::{Coupling, Scene, Timing};
use firmware::servo::Transducers;

/// Period of the servo in s.
const PERIOD: f64 = 0.001;

/// The encoder of the paddle, and its motor at the handle, behind a capstan of 1 to 10.
pub const TRANSDUCERS: Transducers =
    Transducers { full_scale_torque: 1.0, largest_speed: 25.0, ..paddle::TRANSDUCERS };

/// The motor between the outputs U and V, and its supply.
pub const DRIVE: Drive = Drive {
    motor: Motor {
        winding: Winding::Brushed,
        resistance: 0.6,
        inductance: 0.12e-3,
        torque_constant: 0.29,
    },
    supply: Supply { lowest: 23.0, highest: 25.2 },
    bandwidth: 2000.0,
    largest_temperature: 80.0,
};

/// Its current loop on the board's power stage: a motor that it cannot drive stops the compiler here.
pub const CURRENT_LOOP: CurrentLoop =
    CurrentLoop::checked(&DRIVE, &B_G431B_ESC1, &TRANSDUCERS, PERIOD);

/// What the hand feels, behind a coupling that remembers the current loop's lag.
pub type Environment = Matched<OneSided<DamperWall<1>>, 0, 1, true>;

/// The scene.
pub const SCENE: Scene<Environment> = Scene {
    device: paddle::DEVICE,
    timing: Timing { period: PERIOD, worst_period: None },
    coupling: Coupling::Matched,
    environment: Matched {
        environment: OneSided { face: 0.0, wall: DamperWall { stiffness: 22.0, damping: 0.01 } },
    },
    latency: CURRENT_LOOP.latency(OutputTiming::Latched),
    torque_limit: Some(1.0),
};

/// Its certificate: a scene that could oscillate in a hand stops the compiler here.
pub const CERTIFIED: Certified<Scene<Environment>> = SCENE.certified();

/// Angles to 128 rad and torques to 128 N m, in steps of 6e-8.
pub type Fixed = fixed::types::I8F24;

firmware::scene_program! {
    scene: SCENE: Environment,
    certified: CERTIFIED,
    transducers: TRANSDUCERS,
    float: f32,
    fixed: Fixed,
    bridge: CURRENT_LOOP,
}
