//! Slow turns of simulated devices with known friction and cogging, and records that are no such turns.

use std::f64::consts::TAU;

use haptic_servo::scene::{Device, EncoderReading};

use super::*;
use crate::disturbance::{Cogging, Disturbance};
use crate::identify::rig::{MeasuredDevice, Sensing};
use crate::simulation::plant::Plant;

/// A gimbal motor with a magnetic encoder.
const KNOB: Device = Device { inertia: 3e-5, damping: 1e-3, passivity: None };
const PERIOD: f64 = 1e-3;
const COUNTS: f64 = 16_384.0;
const MAGNETIC: EncoderReading =
    EncoderReading { linearity: 0.04, noise: 2.0, ..EncoderReading::IDEAL };

fn sensing(friction: f64, cogging: Cogging) -> Sensing {
    let disturbance = Disturbance { friction, cogging };
    let ideal = Sensing::ideal(PERIOD, COUNTS);
    Sensing { disturbance, encoder: MAGNETIC, torque_noise: 5e-4, ..ideal }
}

/// Turns it by sines of torque: amplitude in N m, frequency in Hz, duration in s.
fn turned(device: Device, sensing: &Sensing, sines: &[(f64, f64, f64)]) -> Record {
    let mut device = MeasuredDevice::new(&Plant::rigid(device), sensing).unwrap();
    let mut record = Record { period: PERIOD, torque: vec![], counts: vec![], frequency: None };
    for &(amplitude, frequency, duration) in sines {
        for tick in 0..(duration / PERIOD) as usize {
            let torque = amplitude * (TAU * frequency * tick as f64 * PERIOD).sin();
            record.torque.push(torque);
            record.counts.push(f64::from(device.count()));
            device.hold(torque);
        }
    }
    record
}

fn show(found: &Result<SlowTurns, TurnsError>) {
    let found = match found {
        Ok(found) => found,
        Err(error) => return println!("{error}"),
    };
    let e = |e: &Estimate| format!("{:.4e} +- {:.1e}", e.value, 0.5 * (e.hi - e.lo));
    println!(
        "m {} b {} f {} least {} mean {} unc {:.2e} odd {:?} turns {:?} speeds {:?}",
        e(&found.inertia),
        e(&found.damping),
        e(&found.friction),
        e(&found.least_friction),
        e(&found.mean),
        found.uncertainty,
        found.friction_harmonics,
        found.turns,
        found.speeds
    );
    for harmonic in &found.harmonics {
        print!("  {}: {}", harmonic.count, e(&harmonic.amplitude));
    }
    println!();
}

#[test]
fn first_look() {
    let cogging = Cogging { torque: 5e-3, count: 84.0 };
    let base = sensing(3e-3, cogging);
    let clean = Sensing { encoder: EncoderReading::IDEAL, torque_noise: 0.0, ..base };
    let fine = Sensing { counts_per_turn: 1e6, ..clean };
    for sensing in [
        fine,
        clean,
        Sensing { encoder: EncoderReading { noise: 2.0, ..EncoderReading::IDEAL }, ..clean },
        Sensing { torque_noise: 5e-4, ..clean },
        base,
    ] {
        for sines in [
            [(0.010, 0.125, 32.0), (0.012, 0.125, 32.0), (0.015, 0.125, 32.0)],
            [(0.010, 0.125, 32.0), (0.012, 0.25, 16.0), (0.015, 0.5, 16.0)],
        ] {
            let record = turned(KNOB, &sensing, &sines);
            let begin = std::time::Instant::now();
            let found = slow_turns(&record, &Correction::of_encoder(sensing.counts_per_turn));
            print!("{:?} ", begin.elapsed());
            show(&found);
        }
    }
    panic!();
}
