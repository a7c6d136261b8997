//! The capacitance at the bridge, as a drive states it.

use super::*;

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
        let scene = crate::scene::Scene {
            device: crate::scene::Device { inertia: 1e-5, damping: 0.01, passivity: None },
            timing: crate::scene::Timing { period: PERIOD, worst_period: None },
            coupling: crate::scene::Coupling::Matched,
            environment: crate::environment::Environment::FreeMode { residual: 0.01, delay: 1 },
            latency: crate::scene::Latency::NONE,
            torque_limit: None,
        };
        let push = current_loop.push(&scene, &TRANSDUCERS, Some(0.001));
        assert_eq!((push.torque, push.speed, push.injected), (0.2, 100.0, 0.001));
        assert!(push.stored >= stored && push.stored < stored * (1.0 + 1e-9), "{push:?}");
    }
}
