//! A device whose whole damping is declared as its passivity, of which motion takes a part through the current
//! loop.

use haptic_servo::certificate::Certified;
use haptic_servo::environment::{DelayedSpring, Matched};
use haptic_servo::output_timing::OutputTiming;
use haptic_servo::scene::{Coupling, Scene};
use refusals::{CURRENT_LOOP, MOTORISED, scene};

type Environment = Matched<DelayedSpring<1>, 0, 1, true>;

const SCENE: Scene<Environment> = Scene {
    coupling: Coupling::Matched,
    latency: CURRENT_LOOP.latency(OutputTiming::Latched),
    torque_limit: Some(1.0),
    ..scene(Matched { environment: DelayedSpring { stiffness: 5.0 } })
};

const CERTIFIED: Certified<Scene<Environment>> = SCENE.certified();

haptic_servo::scene_program! {
    scene: SCENE: Environment,
    certified: CERTIFIED,
    transducers: MOTORISED,
    float: f32,
    fixed: f32,
    bridge: CURRENT_LOOP,
}
