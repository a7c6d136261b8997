//! A supply of 24 V with 1 mF at the bridge, which a hand raises above the fault level when it pushes into the
//! wall and lets go.

use haptic_servo::certificate::Certified;
use haptic_servo::current::{B_G431B_ESC1, CurrentLoop, Drive, Regeneration, Supply};
use haptic_servo::environment::Wall;
use haptic_servo::output_timing::OutputTiming;
use haptic_servo::scene::{Coupling, Device, Scene};
use refusals::{DRIVE, MOTORISED, scene};

const SUPPLY: Supply = Supply {
    regeneration: Regeneration::Stores { voltage: 24.0, capacitance: 1e-3 },
    ..DRIVE.supply
};

const CURRENT_LOOP: CurrentLoop =
    CurrentLoop::checked(&Drive { supply: SUPPLY, ..DRIVE }, &B_G431B_ESC1, &MOTORISED, 0.001);

const SCENE: Scene = Scene {
    device: Device { inertia: 2.2e-5, damping: 0.022, passivity: Some(0.0194) },
    coupling: Coupling::Matched,
    latency: CURRENT_LOOP.latency(OutputTiming::Latched),
    torque_limit: Some(1.0),
    ..scene(Wall::spring(20.0, 1).alone())
};

const CERTIFIED: Certified<Scene> = SCENE.certified();

haptic_servo::scene_program! {
    scene: SCENE,
    certified: CERTIFIED,
    transducers: MOTORISED,
    float: f32,
    fixed: f32,
    bridge: CURRENT_LOOP,
}
