//! A wall on a motor board with a brushless motor, on whose shaft the handle is. The motor is aligned after each
//! reset, on request: `haptic tune --align --arm`.
#![cfg_attr(target_os = "none", no_std, no_main)]

use firmware::certificate::Certified;
use firmware::current::{B_G431B_ESC1, CurrentLoop, Drive, Motor, Supply, Winding};
use firmware::encoder::CounterWidth;
use firmware::environment::{DamperWall, Matched, OneSided};
use firmware::output_timing::OutputTiming;
use firmware::scene::{Coupling, Device, Scene, Timing};
use firmware::servo::Transducers;

/// Period of the servo in s: four of the current loop.
const PERIOD: f64 = 0.0001;

/// The encoder of the shaft, and its motor.
pub const TRANSDUCERS: Transducers = Transducers {
    counts_per_turn: 16_384.0,
    counter: CounterWidth::Bits16,
    full_scale_torque: 0.15,
    largest_speed: 60.0,
};

/// The motor between the outputs U, V and W, in any order, and its supply.
pub const DRIVE: Drive = Drive {
    motor: Motor {
        winding: Winding::Brushless { pole_pairs: 7 },
        resistance: 0.3,
        inductance: 0.06e-3,
        torque_constant: 0.05,
    },
    supply: Supply { lowest: 20.0, highest: 25.2 },
    bandwidth: 2000.0,
    largest_temperature: 80.0,
};

/// Its current loop on the board's power stage.
pub const CURRENT_LOOP: CurrentLoop =
    CurrentLoop::checked(&DRIVE, &B_G431B_ESC1, &TRANSDUCERS, PERIOD);

/// What the hand feels, behind a coupling that remembers the current loop's lag.
pub type Environment = Matched<OneSided<DamperWall<1>>, 0, 1, true>;

/// The scene.
pub const SCENE: Scene<Environment> = Scene {
    // Motion takes 0.0001 of the damping through the current loop (`CurrentLoop::motion_loss`).
    device: Device { inertia: 1.5e-5, damping: 0.0005, passivity: Some(0.00039) },
    timing: Timing { period: PERIOD, worst_period: None },
    coupling: Coupling::Matched,
    environment: Matched {
        environment: OneSided { face: 0.0, wall: DamperWall { stiffness: 2.0, damping: 0.0001 } },
    },
    latency: CURRENT_LOOP.latency(OutputTiming::Latched),
    torque_limit: Some(0.1),
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
