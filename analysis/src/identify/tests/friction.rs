//! Devices with Coulomb friction, simulated with stick by exact impulses in short steps.

use super::*;

const HEAVY: Device = Device { inertia: 5e-4, damping: 0.05, passivity: None };

/// Plays sines to a device with friction in N m; each moves it at its velocity in rad/s.
fn rubbing(device: Device, friction: f64, sines: &[(f64, f64)]) -> Record {
    const STEPS: usize = 50;
    let Device { inertia, damping, .. } = device;
    let period = SENSING.period;
    let step = period / STEPS as f64;
    let mut record = Record { period, torque: vec![], counts: vec![], frequency: Some(vec![]) };
    let (mut angle, mut speed) = (0.0_f64, 0.0_f64);
    for &(frequency, velocity) in sines {
        let omega = std::f64::consts::TAU * frequency;
        let amplitude = velocity * damping.hypot(omega * inertia) + friction;
        for tick in 0..((20.0 / frequency).max(2.0) / period) as usize {
            let torque = amplitude * (omega * tick as f64 * period).sin();
            record.torque.push(torque);
            let turns = angle / std::f64::consts::TAU;
            record.counts.push((turns * SENSING.counts_per_turn).floor());
            record.frequency.as_mut().unwrap().push(frequency);
            for _ in 0..STEPS {
                let moved = (speed * inertia + step * torque) / (inertia + step * damping);
                let held = step * friction / (inertia + step * damping);
                speed = moved.signum() * (moved.abs() - held).max(0.0);
                angle += speed * step;
            }
        }
    }
    record
}

const TONES: [f64; 9] = [2.0, 4.0, 8.0, 16.0, 32.0, 64.0, 100.0, 160.0, 240.0];

fn found(device: Device, friction: f64, speeds: &[f64]) -> Identification {
    let sines: Vec<_> = speeds.iter().flat_map(|speed| TONES.map(|tone| (tone, *speed))).collect();
    let record = rubbing(device, friction, &sines);
    identify(&record, &Correction::of_encoder(SENSING.counts_per_turn)).unwrap()
}

#[test]
fn friction_at_two_amplitudes_is_no_damping() {
    for device in [KNOB, HEAVY] {
        for friction in [0.0, 5e-4, 2e-3, 1e-2] {
            let found = found(device, friction, &[2.0, 4.0]);
            println!(
                "{} {friction}: {:?} {:?} {}",
                device.damping, found.damping, found.friction, found.misfit
            );
            let delta = found.passivity().unwrap();
            assert!(delta <= device.damping, "{friction} {delta}");
            assert!(delta > 0.8 * device.damping, "{friction} {delta}");
            let Estimate { lo, hi, .. } = found.friction;
            assert!(lo <= friction && friction <= hi, "{friction} {:?}", found.friction);
        }
    }
}

#[test]
fn friction_at_one_speed_gives_no_passivity() {
    for friction in [0.0, 5e-4, 2e-3, 1e-2] {
        let found = found(KNOB, friction, &[2.0]);
        assert!(!found.tells_friction && found.passivity().is_none(), "{found:?}");
        assert!(found.friction.lo <= friction && friction <= found.friction.hi, "{found:?}");
    }
}
