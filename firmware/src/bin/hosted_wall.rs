//! A wall that leaves room for the torque of a host: a game or a notebook adds what it likes, and the hand
//! gets at most the energy of the budget from it.
#![cfg_attr(target_os = "none", no_std, no_main)]

mod paddle;

use haptic_servo::certificate::Certified;
use haptic_servo::environment::Wall;
use haptic_servo::host::HostTorque;
use haptic_servo::scene::{Coupling, Latency, Scene, Timing};
pub use paddle::TRANSDUCERS;

/// The scene.
pub const SCENE: Scene = Scene {
    device: paddle::DEVICE,
    timing: Timing { period: 0.001, worst_period: None },
    coupling: Coupling::Spring { stiffness: 44.0 },
    environment: Wall::damped(10.0, 0.002, 1).behind(0.0).alone(),
    latency: Latency::NONE,
    torque_limit: Some(1.0),
};

/// Its certificate: a scene that could oscillate in a hand is a compile error here.
pub const CERTIFIED: Certified<Scene> = SCENE.certified();

/// What a host may do: a share that the scene does not leave over is a compile error in the program.
pub const HOST: HostTorque =
    HostTorque { energy: 0.05, power: 0.5, damping: 0.004, torque: 0.5, timeout: 0.05 };

haptic_servo::scene_program! {
    scene: SCENE,
    certified: CERTIFIED,
    host: HOST,
    transducers: TRANSDUCERS,
}
