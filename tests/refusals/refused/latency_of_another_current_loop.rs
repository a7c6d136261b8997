//! A scene that is certified for a faster current loop than its own.

use haptic_servo::certificate::Certified;
use haptic_servo::current::{B_G431B_ESC1, CurrentLoop, Drive};
use haptic_servo::environment::{DelayedSpring, Matched};
use haptic_servo::output_timing::OutputTiming;
use haptic_servo::scene::{Coupling, Scene};
use refusals::{CURRENT_LOOP, DRIVE, MOTORISED, scene};

const SLOWER: CurrentLoop = CurrentLoop::checked(
    &Drive { bandwidth: 1000.0, ..DRIVE },
    &B_G431B_ESC1,
    &MOTORISED,
    0.001,
);

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
    bridge: SLOWER,
}
