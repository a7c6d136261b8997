//! Motors that throw a free device to and fro: its back-EMF changes faster than the feedback follows.

use super::rig::{Handle, Rig, ThreePhases};
use super::*;

/// Full scale is 3.45 A.
const TRANSDUCERS: Transducers =
    Transducers { full_scale_torque: 1.0, largest_speed: 25.0, ..super::TRANSDUCERS };

/// A large back-EMF beside a small resistance, as of `bridge_paddle`.
const MOTOR: Motor = Motor {
    winding: Winding::Brushed,
    resistance: 0.6,
    inductance: 0.12e-3,
    torque_constant: 0.29,
};

/// Of three phases, two of them in series.
const THREE: Motor = Motor {
    winding: Winding::Brushless { pole_pairs: 7 },
    resistance: 0.3,
    inductance: 0.06e-3,
    torque_constant: 0.29,
};

fn design(motor: Motor) -> CurrentLoop {
    let supply = Supply::sinking(23.0, 26.0);
    let drive = Drive { motor, supply, bandwidth: 2000.0, ..DRIVE };
    CurrentLoop::checked(&drive, &STAGE, &TRANSDUCERS, PERIOD)
}

/// Full torque until the largest speed, then full torque back, as soon as the servo can.
struct Thrower {
    code: i16,
}

impl Thrower {
    fn code(&mut self, speed: f64) -> i16 {
        let most = 0.95 * TRANSDUCERS.largest_speed;
        if speed.abs() > most {
            self.code = if speed > 0.0 { -FULL_SCALE } else { FULL_SCALE };
        }
        self.code
    }
}

/// A brushed motor with a free device of this inertia in kg m^2, in the direction of the next instant.
fn instant(rig: &mut Rig, inertia: f64, code: i16) -> Result<(), PowerFault> {
    let before = rig.instant(code)?;
    let torque = rig.motor.torque_constant * 0.5 * (before + rig.current);
    rig.speed += torque / inertia * INSTANT;
    Ok(())
}

fn brushed(motor: Motor) -> Rig {
    let mut rig = Rig::started(&design(MOTOR));
    rig.motor = motor;
    rig
}

/// The least inertia for which a program compiles, without damping: by equation 64.
fn least_inertia(design: &CurrentLoop) -> f64 {
    1.25 * TRANSDUCERS.full_scale_torque / design.largest_acceleration()
}

/// Also with a motor whose numbers are off.
#[test]
fn a_motor_that_throws_a_free_device_is_no_fault() {
    let least = least_inertia(&design(MOTOR));
    for (resistance, inductance, torque) in
        [(1.0, 1.0, 1.0), (1.3, 0.8, 1.0), (0.8, 1.3, 1.0), (1.0, 1.0, 0.9), (1.0, 1.0, 1.1)]
    {
        for inertia in [least, 2.2e-5, 3e-5, 4e-5] {
            let mut rig = brushed(Motor {
                winding: Winding::Brushed,
                resistance: MOTOR.resistance * resistance,
                inductance: MOTOR.inductance * inductance,
                torque_constant: MOTOR.torque_constant * torque,
            });
            let mut thrower = Thrower { code: FULL_SCALE };
            for _ in 0..4000 {
                let code = thrower.code(rig.speed);
                let told = instant(&mut rig, inertia, code);
                assert_eq!(told, Ok(()), "{inertia}, {:?}", rig.motor);
            }
        }
    }
}

/// Whichever way the encoder counts.
#[test]
fn three_phases_that_throw_a_free_device_are_no_fault() {
    let least = least_inertia(&design(THREE));
    for (inertia, is_reversed) in [(least, false), (2.2e-5, false), (2.2e-5, true), (4e-5, true)] {
        let mut rig = ThreePhases::off(&design(THREE)).measured();
        (rig.motor, rig.encoder) = (THREE, if is_reversed { -1.0 } else { 1.0 });
        rig = rig.aligned();
        rig.handle = Some(Handle { inertia, damping: 0.0, friction: 0.0, cogging: (0.0, 0.0) });
        let mut thrower = Thrower { code: FULL_SCALE };
        for _ in 0..4000 {
            let code = thrower.code(rig.encoder * rig.speed);
            assert_eq!(rig.instant(code), Ok(()), "{inertia}, {is_reversed}");
        }
    }
}

/// Held, it is the time in which a deviation has to end. Thrown, no torque accelerates the device any more, so that
/// the motion explains no more of the deviation.
#[test]
fn a_wire_that_breaks_under_torque_is_found_at_rest_and_in_motion() {
    for (inertia, most) in [(f64::INFINITY, 34), (2.2e-5, 48)] {
        for begin in [60, 80] {
            let mut rig = brushed(MOTOR);
            for _ in 0..40 {
                instant(&mut rig, inertia, 0).unwrap();
            }
            for _ in 40..begin {
                instant(&mut rig, inertia, FULL_SCALE).unwrap();
            }
            rig.motor.resistance = 1e6;
            let found = (0..100)
                .find_map(|k| instant(&mut rig, inertia, FULL_SCALE).err().map(|fault| (k, fault)));
            let Some((instants, PowerFault::CurrentNotFollowing { .. })) = found else {
                panic!("{found:?}")
            };
            println!("{instants} instants, {inertia} kg m^2");
            assert!(instants <= most, "{instants} of {most}, {inertia} kg m^2, {begin}");
        }
    }
}

/// Of 45 000 rad/s^2 and more.
#[test]
fn the_largest_acceleration_is_that_of_its_formula() {
    let found = design(MOTOR).largest_acceleration();
    let per_count = std::f64::consts::TAU / 61_440.0 / INSTANT;
    let (feedback, decay) = (0.25, (-0.125_f64).exp());
    let amps = 0.29 / (feedback * 0.6);
    let allowed = 32.0 * 0.25 / 0.29 - 2.0 * (1.0 - decay) * amps * per_count;
    let expected = allowed / (2.0 * 3.0 * amps * INSTANT);
    assert!((found / expected - 1.0).abs() < 1e-6, "{found}, {expected}");
    assert!(found > 80e3, "{found}");
}

#[test]
#[should_panic(expected = "its back-EMF looks like a broken wire: take an inertia of at least ")]
fn a_device_that_is_too_light_for_its_motor_is_refused() {
    let design = design(MOTOR);
    let timing = crate::output_timing::OutputTiming::Latched;
    let device = crate::scene::Device { inertia: 1e-5, damping: 0.1, passivity: Some(0.01) };
    design.check_serves(&design.latency(timing), PERIOD, &TRANSDUCERS, &device, timing);
}
