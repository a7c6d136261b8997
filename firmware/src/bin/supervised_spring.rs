//! A spring that pushes only while its host sends messages, and that injects damping against the energy of
//! its delay: an example of a program's options.
#![cfg_attr(target_os = "none", no_std, no_main)]

mod paddle;

use haptic_servo::certificate::Certified;
use haptic_servo::environment::Wall;
use haptic_servo::scene::{Coupling, Latency, Scene, Timing};
use haptic_servo::servo::RenderingOptions;
use haptic_servo::servo_loop::{LinkPolicy, Options};
pub use paddle::TRANSDUCERS;

/// The scene: half as stiff as the device allows, so that injected damping is possible.
pub const SCENE: Scene = Scene {
    device: paddle::DEVICE,
    timing: Timing { period: 0.001, worst_period: None },
    coupling: Coupling::Spring { stiffness: 44.0 },
    environment: Wall::spring(14.0, 1).alone(),
    latency: Latency::NONE,
    torque_limit: Some(1.0),
};

/// Its certificate: a scene that could oscillate in a hand is a compile error here.
pub const CERTIFIED: Certified<Scene> = SCENE.certified();

haptic_servo::scene_program! {
    scene: SCENE,
    certified: CERTIFIED,
    transducers: TRANSDUCERS,
    // Damping while the net energy into the hand is positive. More damping than the scene allows does not
    // compile.
    rendering: RenderingOptions { injection: Some(0.004), ..RenderingOptions::DEFAULT },
    // After a second without a message from the host the torque fades out.
    options: Options { link: LinkPolicy::Release, ..Options::DEFAULT },
}
