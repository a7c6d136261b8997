//! Designs that do not compile, and the resulting numbers.

use super::*;
use crate::power_reading::PowerReading;

fn refused(drive: Drive) -> String {
    with(drive, STAGE, TRANSDUCERS, PERIOD)
}

fn with(drive: Drive, stage: PowerStage, transducers: Transducers, period: f64) -> String {
    CurrentLoop::design(&drive, &stage, &transducers, period).unwrap_err().to_string()
}

fn motor(motor: Motor) -> Drive {
    Drive { motor, ..DRIVE }
}

#[test]
fn a_period_is_filled_by_the_highest_frequency_that_fits() {
    for (period, clock, counts, updates) in [
        (1e-3, 170e6, 2125, 40),
        (0.5e-3, 170e6, 2125, 20),
        (1e-4, 170e6, 2125, 4),
        (1e-3, 168e6, 2100, 40),
        (30e-6, 170e6, 2550, 1),
        (0.13e-3, 170e6, 2210, 5),
    ] {
        assert_eq!(
            PwmTiming::of(period, clock).unwrap(),
            PwmTiming { counts, updates },
            "{period}"
        );
    }
    for period in [40e-6, 10e-6, 1.0 / 3000.0, f64::NAN, 0.0, -1.0, 1e9] {
        let Err(DriveError::Period { nearest, .. }) = PwmTiming::of(period, 170e6) else {
            panic!("{period}")
        };
        if period < 1.0 {
            assert!(PwmTiming::of(nearest, 170e6).is_ok(), "{period}: {nearest}");
        }
    }
}

#[test]
fn the_response_is_that_of_the_model() {
    let TorqueResponse { delay, lag, updates } = BRUSHED.response();
    assert_eq!((delay, updates), (25e-6, 40));
    assert!((lag - 159.155e-6).abs() < 1e-9);
    assert!((BRUSHED.full_scale_current() - 4.0).abs() < 1e-12);
    assert_eq!(BRUSHED.limits.over_current, 166);
    assert_eq!(BRUSHED.bus_counts(), (2620, 3095));
}

#[test]
fn refusals_name_the_value_and_its_bound() {
    for resistance in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let told = refused(motor(Motor { resistance, ..DRIVE.motor }));
        assert!(told.starts_with("the motor's resistance must be positive and finite, and is "));
    }
    let supplied =
        |lowest, highest| refused(Drive { supply: Supply::sinking(lowest, highest), ..DRIVE });
    let strong = Transducers { full_scale_torque: 1.8, ..TRANSDUCERS };
    let coarse = PowerStage { largest_current: 60.0, ..STAGE };
    for (told, words) in [
        (refused(motor(Motor { inductance: 0.0, ..DRIVE.motor })), "the motor's inductance"),
        (refused(Drive { bandwidth: -3.0, ..DRIVE }), "the drive's bandwidth"),
        (
            refused(Drive { bandwidth: 4000.0, ..DRIVE }),
            "the bandwidth of 4000 Hz is above 3183.098862 Hz",
        ),
        (
            with(DRIVE, STAGE, strong, PERIOD),
            "full-scale torque of 1.8 N m, and the quarter more at which over-current trips, take 45 A, and \
             the power stage measures and bears 40 A",
        ),
        (
            supplied(22.0, 36.0),
            "a supply from 22 to 36 V is not in the board's range from 10 to 34 V",
        ),
        (supplied(24.0, 22.0), "a supply"),
        (
            refused(Drive { largest_temperature: 150.0, ..DRIVE }),
            "the largest temperature of 150 degrees Celsius is not between -20 and 120",
        ),
        (
            with(DRIVE, coarse, TRANSDUCERS, PERIOD),
            "the board's largest current of 60 A is above the 41.37 A",
        ),
        (
            with(DRIVE, STAGE, TRANSDUCERS, 40e-6),
            "the period of 0.00004 s is not filled by whole periods of a modulation between 30000 and 40000 Hz \
             in whole counts of its timer: 0.00003332941176 s is",
        ),
    ] {
        assert!(told.starts_with(words), "{told}");
    }
}

#[test]
fn a_supply_that_is_too_low_is_told_what_would_be_enough() {
    let supply = |lowest| Drive { supply: Supply::sinking(lowest, 26.0), ..DRIVE };
    let at = |lowest| CurrentLoop::design(&supply(lowest), &STAGE, &TRANSDUCERS, PERIOD);
    let Err(DriveError::Voltage { needed, available, enough, .. }) = at(15.0) else { panic!() };
    // Resistance, inductance and back-EMF of the model's first step, from -4 A at a speed of 100 rad/s.
    let (a, p) = ((-0.05_f64).exp(), (-std::f64::consts::TAU * 0.025).exp());
    let first = -4.0 + 8.0 * (1.0 - p);
    let volts = (first + 4.0 * a) / ((1.0 - a) / 0.6) + 5.0;
    assert!((needed / volts - 1.0).abs() < 1e-12, "{needed}, {volts}");
    assert!(available < 15.0 && enough > needed);
    assert!(at(enough * 0.999_999).is_err() && at(enough * 1.000_001).is_ok());
    let told = at(15.0).unwrap_err().to_string();
    assert!(told.starts_with(
        "the step from full-scale torque to its opposite at the largest speed needs "
    ));
}

#[test]
fn a_refusal_names_the_largest_of_each_number_that_passes() {
    let low = Drive { supply: Supply::sinking(15.0, 26.0), ..DRIVE };
    let fast = Drive { bandwidth: 4000.0, ..DRIVE };
    let strong = Transducers { full_scale_torque: 1.8, ..TRANSDUCERS };
    let phases = Drive { supply: low.supply, ..BRUSHLESS_DRIVE };
    let mut named = [0; 4];
    for (drive, transducers) in [
        (low, TRANSDUCERS),
        (fast, TRANSDUCERS),
        (DRIVE, strong),
        (fast, strong),
        (phases, TRANSDUCERS),
    ] {
        let told = with(drive, STAGE, transducers, PERIOD);
        let design = |drive: &Drive, transducers: &Transducers| {
            CurrentLoop::design(drive, &STAGE, transducers, PERIOD).is_ok()
        };
        // Bandwidth, torque, speed and lowest supply, all or the named one times `beyond`.
        let passes = |numbers: [Option<f64>; 4], beyond: f64| {
            let (mut drive, mut transducers) = (drive, transducers);
            let places = [
                &mut drive.bandwidth,
                &mut transducers.full_scale_torque,
                &mut transducers.largest_speed,
                &mut drive.supply.lowest,
            ];
            for (place, number) in places.into_iter().zip(numbers) {
                *place = number.map_or(*place, |number| beyond * number);
            }
            design(&drive, &transducers)
        };
        let limits = DriveLimits::of(&drive, &STAGE, &transducers, PERIOD);
        let each = [limits.bandwidth, limits.torque, limits.speed, limits.supply];
        for (index, limit) in each.into_iter().enumerate() {
            let Some(limit) = limit else { continue };
            let mut numbers = [None; 4];
            numbers[index] = Some(limit);
            let beyond = if index == 3 { 0.98 } else { 1.02 };
            assert!(passes(numbers, 1.0) && !passes(numbers, beyond), "{index}: {told}");
            assert!(told.contains(&format!(" {limit} ")), "{limit}: {told}");
            named[index] += 1;
        }
        let [bandwidth, torque, speed] = limits.together.unwrap().map(Some);
        assert!(passes([bandwidth, torque, speed, None], 1.0), "{told}");
    }
    assert!(named.iter().all(|&count| count > 0), "{named:?}");
}

#[test]
fn the_thermistor_is_the_one_of_its_formula() {
    let table = STAGE.thermistor.table();
    assert_eq!(STAGE.thermistor.count(25.0), 1309);
    for celsius in -20..=140 {
        let kelvin = f64::from(celsius) + 273.15;
        let ohm = 10e3 * (3380.0 * (1.0 / kelvin - 1.0 / 298.15)).exp();
        let count = STAGE.thermistor.count(celsius.into());
        assert!((f64::from(count) - 4095.0 * 4.7e3 / (4.7e3 + ohm)).abs() < 0.51, "{celsius}");
        assert!(
            (table.tenths(count) - celsius * 10).abs() < 15,
            "{celsius}: {}",
            table.tenths(count)
        );
    }
    assert_eq!((table.tenths(0), table.tenths(4095)), (-200, 1400));
}

/// By Kirchhoff's law at the amplifier's input, for each combination of parts at the ends of their tolerances.
#[test]
fn the_counts_without_a_current_are_those_of_the_resistors() {
    let (lowest, highest) = B_G431B_ESC1.offset_counts;
    assert_eq!((u32::from(lowest) + u32::from(highest)) / 2, 2553, "{lowest} to {highest}");
    let (mut least, mut most) = (f64::MAX, f64::MIN);
    for corner in 0..32 {
        let end = |part: i32| if corner >> part & 1 == 0 { -1.0 } else { 1.0 };
        let ohm = |part: i32, value: f64| value * (1.0 + 0.01 * end(part));
        let (series, ground, supply) = (ohm(0, 1.5e3), ohm(1, 2.2e3), ohm(2, 22e3));
        // Series and ground resistors are in parallel where the shunt has no voltage.
        let below = series * ground / (series + ground);
        let input = 3.3 * below / (below + supply) + 3e-3 * end(3);
        let count = input * 16.0 * (1.0 + 0.02 * end(4)) / 3.3 * 4096.0;
        (least, most) = (least.min(count), most.max(count));
    }
    assert!(f64::from(lowest) <= least && f64::from(highest) >= most, "{least} to {most}");
    // No wider than the worse of the two ends.
    let width = (2553.4 - least).max(most - 2553.4);
    assert!(f64::from(highest - lowest) <= 2.0 * width + 3.0, "{lowest} to {highest}");
}

fn stores(voltage: f64, capacitance: f64) -> Drive {
    let regeneration = Regeneration::Stores { voltage, capacitance };
    Drive { supply: Supply { regeneration, ..DRIVE.supply }, ..DRIVE }
}

fn designed(voltage: f64, capacitance: f64) -> Result<CurrentLoop, DriveError> {
    CurrentLoop::design(&stores(voltage, capacitance), &STAGE, &TRANSDUCERS, PERIOD)
}

#[test]
fn a_supply_that_cannot_be_is_refused_with_its_value() {
    for capacitance in [0.0, -1e-3, f64::NAN, f64::INFINITY] {
        let told = designed(24.0, capacitance).unwrap_err().to_string();
        let begin = "the supply's capacitance must be positive and finite, and is ";
        assert!(told.starts_with(begin), "{told}");
    }
    for voltage in [21.9, 26.1, 0.0, -24.0, f64::NAN] {
        let told = designed(voltage, 1e-3).unwrap_err().to_string();
        assert!(told.starts_with("the supply itself delivers up to "), "{told}");
        assert!(told.ends_with("its lowest and its highest voltage, 22 and 26 V"), "{told}");
    }
}

/// The highest count in range is the 3095th, of 8.4 mV with an error of 2 %.
#[test]
fn the_fault_level_is_the_lowest_that_may_be_measured_as_too_high() {
    assert_eq!(BRUSHED.bus(), None);
    let bus = *designed(24.0, 1e-3).unwrap().bus().unwrap();
    assert_eq!((bus.voltage, bus.capacitance), (24.0, 1e-3));
    let level = 3095.0 * 0.0084 / 1.02;
    assert!(bus.fault_level <= level && bus.fault_level > level * (1.0 - 1e-12), "{bus:?}");
}

/// The figures of `docs/power-stage.md`: J that a mF takes from a voltage to the board's fault level.
#[test]
fn a_lower_voltage_leaves_room() {
    let stage = PowerStage { supply: SupplyRange { lowest: 9.0, highest: 25.2 }, ..STAGE };
    let [clock, volts] = [B_G431B_ESC1.clock, B_G431B_ESC1.volts_per_count];
    let tolerance = B_G431B_ESC1.volts_tolerance;
    let stage = PowerStage { clock, volts_per_count: volts, volts_tolerance: tolerance, ..stage };
    let slow = Transducers { largest_speed: 20.0, full_scale_torque: 0.05, ..TRANSDUCERS };
    for (voltage, room) in [(12.0, 0.23), (20.0, 0.10), (24.0, 0.016)] {
        let regeneration = Regeneration::Stores { voltage, capacitance: 1e-3 };
        let supply = Supply { lowest: 10.0, highest: 25.2, regeneration };
        let drive = Drive { supply, bandwidth: 500.0, ..DRIVE };
        let designed = CurrentLoop::design(&drive, &stage, &slow, PERIOD).unwrap();
        let found = designed.bus().unwrap().room();
        assert!((found / room - 1.0).abs() < 0.05, "{voltage} V: {found} J");
    }
}

/// Where the energy is all that it takes, the voltage is at the fault level, and both enclose it.
#[test]
fn room_and_voltage_agree() {
    for (voltage, capacitance) in [(24.0, 1e-3), (12.0, 4.7e-4), (25.1, 0.022)] {
        let bus = Bus { voltage, capacitance, fault_level: 25.2 };
        let reached = bus.voltage_after(bus.room());
        assert!((reached / 25.2 - 1.0).abs() < 1e-12, "{reached}");
        assert!(bus.voltage_after(bus.room() * 1.000_001) > 25.2);
        assert!(bus.voltage_after(bus.room() * 0.999_999) < 25.2);
    }
}

/// The winding's energy by hand: half of 0.3 mH times the square of 5 A; three phases have half as much again
/// for the amplitude.
#[test]
fn the_push_has_the_winding_at_over_current() {
    for (current_loop, stored) in [(BRUSHED, 3.75e-3), (BRUSHLESS, 1.5 * 0.5 * 0.15e-3 * 25.0)] {
        let free = crate::environment::Canceller { residual: 0.01, delay: 1 }.alone();
        let scene = crate::test_scene::scene(free);
        let push = current_loop.push(&scene, &TRANSDUCERS, Some(0.001));
        assert_eq!((push.torque, push.speed, push.injected), (0.2, 100.0, 0.001));
        assert!(push.stored >= stored && push.stored < stored * (1.0 + 1e-9), "{push:?}");
    }
}

/// At 25 degrees the thermistor has 10 kΩ: the divider's 4.7/14.7 of 4095 counts are 1309.3.
const AT_25: u16 = 1309;

#[test]
fn counts_become_units() {
    let reading = BRUSHED.power_reading(-0.4124, -1791, (2865, AT_25));
    let PowerReading { current, reference, voltage, temperature, .. } = reading;
    // 2865 counts of 8.4 mV.
    assert_eq!((current, reference, voltage), (-412, -4000, 24_066));
    // Straight lines ten degrees apart are half a degree off at most.
    assert!((temperature - 250).abs() <= 5, "{temperature}");
}

#[test]
fn currents_are_rounded_to_the_nearest() {
    for (amps, milliamps) in [(0.0006, 1), (-0.0006, -1), (0.0004, 0), (-0.0004, 0)] {
        assert_eq!(BRUSHED.power_reading(amps, 0, (2865, AT_25)).current, milliamps);
    }
}
