//! The neighbour of `supply_that_takes_nothing_back`: enough capacitance for what the hand returns.

use haptic_servo::certificate::Certified;
use haptic_servo::current::{B_G431B_ESC1, CurrentLoop, Drive, Regeneration, Supply};
use haptic_servo::environment::{DelayedSpring, Matched};
use haptic_servo::output_timing::OutputTiming;
use haptic_servo::scene::{Coupling, Device, Scene};
use refusals::{DRIVE, MOTORISED, scene};

const SUPPLY: Supply = Supply {
    regeneration: Regeneration::Stores { voltage: 24.0, capacitance: 10e-3 },
    ..DRIVE.supply
};

const CURRENT_LOOP: CurrentLoop =
    CurrentLoop::checked(&Drive { supply: SUPPLY, ..DRIVE }, &B_G431B_ESC1, &MOTORISED, 0.001);

type Environment = Matched<DelayedSpring<1>, 0, 1, true>;

const SCENE: Scene<Environment> = Scene {
    device: Device { inertia: 2.2e-5, damping: 0.022, passivity: Some(0.0194) },
    coupling: Coupling::Matched,
    latency: CURRENT_LOOP.latency(OutputTiming::Latched),
    torque_limit: Some(1.0),
    ..scene(Matched { environment: DelayedSpring { stiffness: 20.0 } })
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
