//! The current of a duty against a load whose switches are computed edge by edge.

use super::rig::Rig;
use super::*;

const LOAD: Drive =
    Drive { motor: Motor { resistance: 1.1, inductance: 0.1e-3, ..DRIVE.motor }, ..DRIVE };
const DUTY: f64 = 0.1;

/// A load that is off by this much at a duty, settled: the current at an instant, and the mean of those at the
/// edges between.
fn settled(load: &Drive, resistance: f64, bus: f64, duty: f64) -> f64 {
    let mut rig = Rig::off(&BRUSHED);
    rig.motor = Motor { resistance, ..load.motor };
    rig.bus = bus;
    let expected = load.current_at_duty(&STAGE, INSTANT, duty.abs(), 0.1).unwrap();
    for _ in 0..expected.settling {
        rig.hold(BRUSHED.duties_at(duty));
    }
    rig.current
}

#[test]
fn a_load_takes_the_current_of_its_duty() {
    let expected = LOAD.current_at_duty(&STAGE, INSTANT, DUTY, 0.1).unwrap();
    for sign in [1.0, -1.0] {
        for (part, bus) in [(0.9, 26.0), (0.9, 22.0), (1.0, 24.0), (1.1, 26.0), (1.1, 22.0)] {
            let current = sign * settled(&LOAD, part * LOAD.motor.resistance, bus, sign * DUTY);
            println!("{part} {bus}: {current}, {expected:?}");
            assert!(current > expected.least && current < expected.most, "{part} {bus}: {current}");
        }
        // A third more of the resistance, and half of the voltage, are not within.
        let far = sign * settled(&LOAD, 1.7 * LOAD.motor.resistance, 24.0, sign * DUTY);
        assert!(far < expected.least, "{far}");
        let twice = sign * settled(&LOAD, LOAD.motor.resistance, 24.0, 2.0 * sign * DUTY);
        assert!(twice > expected.most, "{twice}");
    }
}

/// The numbers of the first power-on in `boards.md`, in mA.
#[test]
fn the_instructions_state_the_bounds_of_their_loads() {
    let load = |resistance, lowest, highest| Drive {
        motor: Motor { resistance, ..LOAD.motor },
        supply: Supply::sinking(lowest, highest),
        ..LOAD
    };
    let resistor = load(1.05, 11.4, 12.6);
    for (duty, bounds) in [
        (0.10, [110, 938]),
        (0.15, [604, 1605]),
        (0.20, [1097, 2272]),
        (0.30, [2084, 3605]),
        (0.40, [3071, 4938]),
    ] {
        let expected = resistor.current_at_duty(&B_G431B_ESC1, INSTANT, duty, 0.1).unwrap();
        let milliamps = |amps: f64| (amps * 1e3) as i32;
        assert_eq!([expected.least, expected.most].map(milliamps), bounds, "{duty}");
    }
    let trips = load(0.55, 14.2, 15.8).current_at_duty(&B_G431B_ESC1, INSTANT, 0.70, 0.1);
    assert!(trips.is_ok_and(|current| current.least > 10.0), "{trips:?}");
}

/// Without a tolerance but that of the dead time the middle of the bounds is the current itself.
#[test]
fn the_bounds_are_on_both_sides_of_the_current() {
    let supply = Supply::sinking(24.0, 24.0);
    let load = Drive { supply, ..LOAD };
    let expected = load.current_at_duty(&STAGE, INSTANT, DUTY, 0.0).unwrap();
    let current = settled(&load, load.motor.resistance, 24.0, DUTY);
    let middle = 0.5 * (expected.least + expected.most);
    // Compare values are whole numbers.
    let step = 24.0 / f64::from(BRUSHED.timer_counts()) / load.motor.resistance;
    assert!((current - middle).abs() < step, "{current} {middle} {step}");
    assert!(expected.most - expected.least < 0.2 * middle, "{expected:?}");
}

#[test]
fn a_duty_without_a_current_is_refused_with_its_bound() {
    let refused = |load: &Drive, duty: f64, tolerance: f64| {
        load.current_at_duty(&STAGE, INSTANT, duty, tolerance).unwrap_err().to_string()
    };
    let motor = |motor: Motor| Drive { motor, ..LOAD };
    let cases = [
        (LOAD, 0.02, 0.1, "the duty must be above 0.024"),
        (LOAD, 1.0, 0.1, "and is 1"),
        (LOAD, f64::NAN, 0.1, "and is NaN"),
        (LOAD, 0.1, 1.0, "the tolerance must be from 0 to below 1, and is 1"),
        (motor(Motor { resistance: 0.0, ..LOAD.motor }), 0.1, 0.1, "the load's resistance must be"),
        (motor(Motor { resistance: 0.02, ..LOAD.motor }), 0.1, 0.1, "the power stage bears 40 A"),
        (
            motor(Motor { winding: Winding::Brushless { pole_pairs: 7 }, ..LOAD.motor }),
            0.1,
            0.1,
            "two terminals",
        ),
    ];
    for (load, duty, tolerance, words) in cases {
        let sentence = refused(&load, duty, tolerance);
        assert!(sentence.contains(words), "{sentence}");
    }
}
