//! A brushless motor whose phase is known.

use super::super::phase::Turn;
use super::rig::ThreePhases;
use super::*;

/// Largest deviations, along and across the magnets, from the certified current.
fn deviations(rig: &mut ThreePhases, steps: &[(usize, i16)], begin: usize, end: usize) -> [f64; 2] {
    let mut most = [0.0_f64; 2];
    for instant in 0..end {
        let [along, across] = rig.currents();
        if instant >= begin {
            let off = across - certified_current(&BRUSHLESS, steps, instant);
            most = [most[0].max(along.abs()), most[1].max(off.abs())];
        }
        rig.instant(code_at(steps, instant)).unwrap();
    }
    most
}

#[test]
fn the_current_across_the_magnets_is_the_certified_one_and_none_is_along_them() {
    for angle in 0..12 {
        let mut rig = ThreePhases::started(&BRUSHLESS);
        rig.offset = f64::from(angle) / 12.0 * std::f64::consts::TAU;
        rig = rig.aligned();
        let [along, across] = deviations(&mut rig, &STEPS, 0, 600);
        let crossing = BRUSHLESS.resolution().zero_crossing / BRUSHLESS.torque_per_amp();
        let allowed = allowed(&BRUSHLESS) + crossing;
        assert!(along < allowed && across < allowed, "{angle}: {along}, {across} of {allowed}");
        assert!(across > 0.1 * allowed, "{angle}: {across}");
    }
}

#[test]
fn at_the_largest_speed_it_is_the_same_once_the_speed_is_known() {
    for speed in [100.0, -100.0] {
        let mut rig = ThreePhases::started(&BRUSHLESS);
        // From rest, as a hand would.
        for instant in 0..4000 {
            rig.speed = speed * f64::from(instant) / 4000.0;
            rig.instant(0).unwrap();
        }
        rig.speed = speed;
        for _ in 0..400 {
            rig.instant(0).unwrap();
        }
        let [along, across] = deviations(&mut rig, &STEPS, 0, 600);
        // What two terms of the small angle and the turning magnets leave of a step.
        assert!(along < 0.2 && across < 0.2, "{speed}: {along}, {across}");
        let [along, across] = deviations(&mut rig, &[(0, 0)], 100, 400);
        assert!(along < allowed(&BRUSHLESS) && across < allowed(&BRUSHLESS), "{along}, {across}");
    }
}

/// Largest deviations along and across, of a constant torque while the phases' currents change their signs, of a
/// loop that is designed for this dead time. The stage has 0.2 microseconds of it.
fn turning_slowly(dead_time: f64) -> [f64; 2] {
    let stage = PowerStage { dead_time, ..STAGE };
    let design = CurrentLoop::checked(&BRUSHLESS_DRIVE, &stage, &TRANSDUCERS, PERIOD);
    let mut rig = ThreePhases::started(&design);
    rig.speed = 10.0;
    let mut most = [0.0_f64; 2];
    for instant in 0..6000 {
        rig.instant(300).unwrap();
        let [along, across] = rig.currents();
        if instant > 600 {
            let off = across - 300.0 / 1791.0 * 4.0;
            most = [most[0].max(along.abs()), most[1].max(off.abs())];
        }
    }
    most
}

#[test]
fn the_dead_time_is_given_back_phase_by_phase() {
    let ([along, across], plain) = (turning_slowly(STAGE.dead_time), turning_slowly(0.0));
    println!("{along} A and {across} A, and {plain:?} without");
    assert!(along < allowed(&BRUSHLESS) && across < allowed(&BRUSHLESS), "{along}, {across}");
    assert!(plain[0] > 3.0 * along && plain[1] > across, "{plain:?}, {along}, {across}");
}

#[test]
fn a_motor_that_is_off_by_a_third_settles() {
    for (resistance, inductance) in [(1.4, 1.0), (1.0, 0.7), (1.0, 1.3), (1.4, 0.7), (1.4, 1.3)] {
        let mut rig = ThreePhases::started(&BRUSHLESS);
        rig.motor.resistance *= resistance;
        rig.motor.inductance *= inductance;
        let steps = [(3, FULL_SCALE), (100, -FULL_SCALE)];
        let [along, across] = deviations(&mut rig, &steps, 0, 200);
        assert!(along < 1.0 && across < 2.4, "{resistance}, {inductance}: {along}, {across}");
        for _ in 0..200 {
            rig.instant(-FULL_SCALE).unwrap();
        }
        let settled = (rig.currents()[1] + 4.0).abs();
        assert!(settled < allowed(&BRUSHLESS), "{resistance}, {inductance}: {settled}");
    }
}

#[test]
fn a_voltage_that_is_not_enough_stays_in_the_circle() {
    let mut rig = ThreePhases::started(&BRUSHLESS);
    let fault = (0..4000).find_map(|instant| {
        rig.speed = 0.3 * f64::from(instant);
        rig.instant(FULL_SCALE).err()
    });
    let Some(PowerFault::SaturatedDuty { .. }) = fault else { panic!("{fault:?}, {}", rig.speed) };
    // 24 V of a circle are 12 V, less 1.2 V and what a ramp takes.
    assert!((250.0..420.0).contains(&rig.speed), "{}", rig.speed);
}

#[test]
fn needs_an_alignment() {
    let mut rig = ThreePhases::off(&BRUSHLESS).measured();
    assert_eq!(rig.controller.start(), Err(PowerFault::NotAligned { by_index: false }));
    assert_eq!(rig.instant(0), Err(PowerFault::NotAligned { by_index: false }));
}

/// Against 128 bits, after millions of turns both ways.
#[test]
fn a_phase_does_not_drift() {
    for (counts, pole_pairs) in
        [(61_440_u32, 7_u16), (4096, 11), (1000, 3), (8191, 21), (16_777_213, 5)]
    {
        let mut turn = Turn::new(counts, pole_pairs);
        let mut position = 0_i64;
        for k in 0..2_000_000_i64 {
            let step = (k * k * 7919 % 2003 - 900) as i32 % (counts as i32 - 1);
            turn.move_by(step);
            position += i64::from(step);
        }
        for step in [counts as i32 * 3 + 5, -(counts as i32) * 100, i32::MAX, i32::MIN, 0, 1, -1] {
            turn.move_by(step);
            position += i64::from(step);
            let within = position.rem_euclid(i64::from(counts)) as u128;
            assert_eq!(turn.count as u128, within);
            let exact = ((within * u128::from(pole_pairs)) << 32) / u128::from(counts);
            let off = turn.angle().wrapping_sub(exact as u32).cast_signed();
            assert!(off.abs() <= 1, "{counts}, {pole_pairs}: {off}");
        }
    }
}

#[test]
fn refusals_of_a_brushless_motor_name_the_value_and_its_bound() {
    let refused = |pole_pairs: u16, transducers: Transducers| {
        let motor = Motor { winding: Winding::Brushless { pole_pairs }, ..BRUSHLESS_DRIVE.motor };
        let drive = Drive { motor, ..BRUSHLESS_DRIVE };
        CurrentLoop::design(&drive, &STAGE, &transducers, PERIOD).unwrap_err()
    };
    let coarse = Transducers { counts_per_turn: 1000.0, ..TRANSDUCERS };
    for pole_pairs in [0, 16] {
        let error = DriveError::PolePairs { pole_pairs, largest: 15 };
        assert_eq!(refused(pole_pairs, coarse), error);
    }
    let broken = Transducers { counts_per_turn: 1000.5, ..TRANSDUCERS };
    assert!(matches!(refused(7, broken), DriveError::Counts { counts: 1000.5, .. }));
    let told = refused(100, Transducers { largest_speed: 100.0, ..TRANSDUCERS }).to_string();
    assert!(told.contains("1591.549431 electrical turns a second"), "{told}");
    assert!(told.ends_with(" 1250: it would pass with a largest speed of at most 78.5 rad/s"));
}
