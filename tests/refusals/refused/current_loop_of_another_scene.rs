//! Current loops that do not serve a scene.

use haptic_servo::certificate::Certified;
use haptic_servo::current::{
    B_G431B_ESC1, CurrentLoop, Drive, EncoderIndex, IndexOffset, Motor, Winding,
};
use haptic_servo::environment::Wall;
use haptic_servo::output_timing::OutputTiming;
use haptic_servo::scene::{Coupling, Scene};
use refusals::{CURRENT_LOOP, DRIVE, MOTORISED, scene};

const SLOWER: CurrentLoop =
    CurrentLoop::checked(&Drive { bandwidth: 1000.0, ..DRIVE }, &B_G431B_ESC1, &MOTORISED, 0.001);

const SCENE: Scene = Scene {
    coupling: Coupling::Matched,
    latency: CURRENT_LOOP.latency(OutputTiming::Latched),
    torque_limit: Some(1.0),
    ..scene(Wall::spring(5.0, 1).alone())
};

const CERTIFIED: Certified<Scene> = SCENE.certified();

/// The scene declares the whole damping of its device as passivity, of which motion takes a part through the
/// current loop.
const _: () = CURRENT_LOOP.check_serves(
    &SCENE.latency,
    SCENE.timing.period,
    &MOTORISED,
    &SCENE.device,
    OutputTiming::Latched,
);

const BRUSHLESS: Drive = Drive {
    motor: Motor { winding: Winding::Brushless { pole_pairs: 7 }, ..DRIVE.motor },
    bandwidth: 1000.0,
    ..DRIVE
};

/// A phase at the index that is beyond an electrical turn of the motor's encoder.
const OFFSET: IndexOffset = IndexOffset { counts: 20_000, is_reversed: false };
const _: CurrentLoop = CurrentLoop::checked(&BRUSHLESS, &B_G431B_ESC1, &MOTORISED, 0.001)
    .with_index(EncoderIndex { offset: Some(OFFSET) });

// The scene is certified for a faster current loop than the program's.
haptic_servo::scene_program! {
    scene: SCENE,
    certified: CERTIFIED,
    transducers: MOTORISED,
    float: f32,
    fixed: f32,
    bridge: SLOWER,
}
