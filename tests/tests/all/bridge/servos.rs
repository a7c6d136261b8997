//! Servos for a [`Rig`](super::rig::Rig): as a board runs them, by counts, and without steps.

use haptic_servo::boot::Program;
use haptic_servo::certificate::Certified;
use haptic_servo::dac::DacCode;
use haptic_servo::encoder::RawCount;
use haptic_servo::scene::Scene;
use haptic_servo::servo::{Latched, RenderingOptions, Servo};
use haptic_servo::servo_loop::Options;
use tests::replica::Replica;

use super::rig::{Codes, Machine, Torques};

/// A servo that gives a code for the instant of its count: that of a board's tick before.
pub fn counted(machine: &Machine, scene: &Certified<Scene>) -> Codes {
    let machine = *machine;
    let mut servo = Servo::<_, f32>::new(scene, &machine.transducers).unwrap();
    Box::new(move |angle| servo.tick(RawCount::from(machine.count(angle))).code.offset())
}

/// The torque of a motor on a servo that knows its angles.
pub fn exact(machine: &Machine, scene: &Certified<Scene>) -> Torques {
    let mut servo = Servo::<_, f64>::new(scene, &machine.transducers).unwrap();
    Box::new(move |angle| -servo.tick_at(angle).unwrap())
}

/// Codes of a motor on a servo that knows its angles.
pub fn rounded(machine: &Machine, mut exact: Torques) -> Codes {
    let codes = f64::from(DacCode::CODES_TO_FULL_SCALE) / machine.transducers.full_scale_torque;
    Box::new(move |angle| (exact(angle) * codes).round() as i16)
}

/// What a board's interrupt runs, armed in its first tick. It puts a code out at the next count.
pub fn board(machine: &Machine, scene: &Scene) -> Codes {
    let machine = *machine;
    let mut replica = Replica::<_, Latched>::boot(Program {
        scene: *scene,
        transducers: machine.transducers,
        rendering: RenderingOptions::DEFAULT,
        options: Options::DEFAULT,
    });
    replica.arm();
    let mut code = DacCode::MID_SCALE.get();
    Box::new(move |angle| {
        let latched = code.cast_signed() - DacCode::MID_SCALE.get().cast_signed();
        code = replica.tick(machine.count(angle)).0;
        latched
    })
}
