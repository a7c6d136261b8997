//! What switches a power stage off, and what does not: motors that throw a free device to and fro, whose back-EMF
//! changes faster than the feedback follows.

use proptest::prelude::*;

use super::rig::{Handle, Rig, ThreePhases};
use super::*;
use crate::encoder::RawCount;

#[test]
fn does_not_start_without_offsets_in_range() {
    let mut rig = Rig::off(&BRUSHED);
    let none = PowerFault::CurrentOffset { phase: 0, count: 0 };
    assert_eq!(rig.controller.start(), Err(none));
    rig.offsets[1] = 2048.0;
    for _ in 0..256 {
        rig.controller.measure_offset(&rig.sample());
    }
    let broken = PowerFault::CurrentOffset { phase: 1, count: 2048 };
    assert_eq!(rig.controller.start(), Err(broken));
    rig.offsets[1] = 2540.0;
    for _ in 0..256 {
        rig.controller.measure_offset(&rig.sample());
    }
    assert_eq!(rig.controller.start(), Ok(()));
}

#[test]
fn does_not_start_with_a_supply_or_a_temperature_out_of_range() {
    let started = |bus: f64, celsius: f64| {
        let mut rig = Rig::started(&BRUSHED);
        (rig.bus, rig.celsius) = (bus, celsius);
        rig.controller.measure_offset(&rig.sample());
        rig.controller.start()
    };
    assert_eq!(started(24.0, 30.0), Ok(()));
    let Err(PowerFault::UnderVoltage { voltage: 20_000..20_010, lowest: 22_000..22_010 }) =
        started(20.0, 30.0)
    else {
        panic!()
    };
    let Err(PowerFault::OverVoltage { voltage: 27_990..28_010, highest: 25_990..=26_000 }) =
        started(28.0, 30.0)
    else {
        panic!()
    };
    let Err(PowerFault::OverTemperature { temperature: 990..1010, largest: 895..905 }) =
        started(24.0, 100.0)
    else {
        panic!("{:?}", started(24.0, 100.0))
    };
}

#[test]
fn one_sample_of_noise_switches_nothing_off_and_two_do() {
    let temperature = Rig::started(&BRUSHED).sample().temperature;
    for (bus, temperature) in [(4095, temperature), (0, temperature), (2857, 4095)] {
        let mut rig = Rig::started(&BRUSHED);
        let good = rig.sample();
        let bad = Sample { bus, temperature, ..good };
        for _ in 0..20 {
            let mut undisturbed = rig.controller;
            let expected = undisturbed.step(&good, 500);
            assert_eq!(rig.controller.step(&bad, 500), expected, "{bus}, {temperature}");
            rig.controller.step(&good, 500).unwrap();
        }
        rig.controller.step(&bad, 0).unwrap();
        assert!(rig.controller.step(&bad, 0).is_err(), "{bus}, {temperature}");
    }
}

/// A single phase above the limit, by counts: of W the sum of the two others, each below it.
#[test]
fn an_over_current_of_each_phase_is_found() {
    let limit = i32::from(BRUSHLESS.limits.over_current);
    for (part, is_fault) in [(0.9, false), (1.1, true)] {
        let most = (part * f64::from(limit)) as i32;
        for phase in 0..3 {
            for sign in [-1, 1] {
                let mut rig = ThreePhases::started(&BRUSHLESS);
                // The other two share its current.
                let share = |of: usize| if of == phase { sign * most } else { -sign * most / 2 };
                let rest = rig.sample();
                let currents = [0, 1].map(|of| {
                    (i32::from(rest.currents[of]) + share(of)).try_into().expect("a count")
                });
                let step = rig.controller.step(&Sample { currents, ..rest }, 0);
                let is_over = matches!(step, Err(PowerFault::OverCurrent { .. }));
                assert_eq!(is_over, is_fault, "phase {phase}, {sign}, {part}: {step:?}");
            }
        }
    }
}

/// By the counts of the converter's ends, and a temperature near each end of the range.
#[test]
fn a_thermistor_that_is_open_or_shorted_is_a_fault() {
    let told = |temperature: u16| {
        let mut rig = Rig::started(&BRUSHED);
        let sample = Sample { temperature, ..rig.sample() };
        rig.controller.measure_offset(&sample);
        rig.controller.start().err().map(PowerFault::as_str)
    };
    // The divider's counts at -15, 30 and 130 degrees, by the thermistor's formula.
    let count = |celsius: f64| {
        let ohm = 10e3 * (3380.0 * (1.0 / (celsius + 273.15) - 1.0 / 298.15)).exp();
        (4095.0 * 4.7e3 / (4.7e3 + ohm)) as u16
    };
    for (count, fault) in [
        (0, Some("thermistor")),
        (count(-25.0), Some("thermistor")),
        (count(-15.0), None),
        (count(30.0), None),
        (count(130.0), Some("over-temperature")),
        (count(150.0), Some("thermistor")),
        (4095, Some("thermistor")),
    ] {
        assert_eq!(told(count), fault, "{count}");
    }
}

#[test]
fn a_hand_that_is_too_fast_for_the_supply_is_a_saturated_duty() {
    let mut rig = Rig::started(&BRUSHED);
    let fault = (0..2000).find_map(|instant| {
        rig.speed = 0.3 * f64::from(instant);
        rig.instant(FULL_SCALE).err()
    });
    let Some(PowerFault::SaturatedDuty { instants, allowed }) = fault else { panic!("{fault:?}") };
    assert!(instants == allowed + 1 && (340.0..400.0).contains(&rig.speed), "{}", rig.speed);
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 400, ..ProptestConfig::default() })]

    /// Whatever is sampled, the compare values are within the timer, and leave the low sides their time.
    #[test]
    fn nothing_but_compare_values_and_faults(
        samples in proptest::collection::vec(any::<([u16; 2], u16, u16, u32, i16)>(), 1..20),
        near in any::<bool>(),
    ) {
        let mut brushed = Rig::started(&BRUSHED).controller;
        let mut brushless = ThreePhases::started(&BRUSHLESS).controller;
        // Up to 1.7 microseconds before the end of the period, and from as long after its beginning.
        let longest = (2125.0 - 1.7e-6 * 170e6 / 2.0) as u16;
        for (currents, bus, temperature, position, code) in samples {
            let mut sample = Sample { currents, bus, temperature, position: RawCount::from(position) };
            if near {
                sample.currents = currents.map(|count| 2470 + count % 160);
                sample.bus = 2700 + bus % 300;
                sample.temperature = temperature % 3000;
            }
            for controller in [&mut brushed, &mut brushless] {
                match controller.step(&sample, code) {
                    Ok(Duties(duties)) => {
                        let is_in_range = |&duty| (2125 - longest..=longest).contains(&duty);
                        prop_assert!(duties.iter().all(is_in_range), "{duties:?}");
                    }
                    Err(fault) => prop_assert!(!fault.to_string().is_empty()),
                }
            }
        }
    }
}

/// Full scale is 3.45 A.
const FAST: Transducers =
    Transducers { full_scale_torque: 1.0, largest_speed: 25.0, ..TRANSDUCERS };

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
    CurrentLoop::checked(&drive, &STAGE, &FAST, PERIOD)
}

/// Full torque until the largest speed, then full torque back, as soon as the servo can.
struct Thrower {
    code: i16,
}

impl Thrower {
    fn code(&mut self, speed: f64) -> i16 {
        let most = 0.95 * FAST.largest_speed;
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
    1.25 * FAST.full_scale_torque / design.largest_acceleration()
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
    design.check_serves(&design.latency(timing), PERIOD, &FAST, &device, timing);
}
