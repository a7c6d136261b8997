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

/// The same counts with a fault in them.
fn faulty(record: Record, fault: impl Fn(usize, f64) -> f64) -> String {
    let counts = record.counts.iter().enumerate().map(|(row, count)| fault(row, *count)).collect();
    let record = Record { counts, ..record };
    identify(&record, &Correction::of_encoder(SENSING.counts_per_turn)).unwrap_err().to_string()
}

#[test]
fn a_wrapped_counter_and_a_reversed_sign_are_named_once() {
    let sines: Vec<_> = [2.0, 4.0].iter().flat_map(|v| TONES.map(|tone| (tone, *v))).collect();
    let record = rubbing(KNOB, 2e-3, &sines);
    let first = record.counts.iter().position(|count| *count > 500.0).unwrap();
    let said = faulty(record.clone(), |_, count| (count + 65_035.0).rem_euclid(65_536.0));
    let begins = format!("the counter wraps: in row {}, at ", first + 1);
    assert!(said.starts_with(&begins) && said.contains("of a counter of 65536 counts"), "{said}");
    assert!(said.contains(" such jumps in the record)"), "{said}");
    let said = faulty(record.clone(), |_, count| -count);
    let begins = "torque and counts have opposite signs: from row 1 on, at 2 Hz, Re(1/J) is -0.02";
    assert!(said.starts_with(begins) && said.contains("the motor's wires"), "{said}");
    // Neither of them is seen in a good record.
    assert!(identify(&record, &Correction::of_encoder(SENSING.counts_per_turn)).is_ok());
}

#[test]
fn several_sines_at_once_are_refused_together() {
    let mut record = rubbing(KNOB, 2e-3, &TONES.map(|tone| (tone, 2.0)));
    let labels = record.frequency.clone().unwrap();
    for (row, (torque, tone)) in record.torque.iter_mut().zip(labels).enumerate() {
        let turns = 1.5 * tone * row as f64 * SENSING.period;
        *torque += 0.05 * (std::f64::consts::TAU * turns).sin();
    }
    let said = faulty(record, |_, count| count);
    assert!(said.contains("record one sine after the other, not several at once"), "{said}");
    assert_eq!(said.matches("is not this sine").count(), 1, "{said}");
}

#[test]
fn many_short_sines_are_one_sentence() {
    let record = rubbing(KNOB, 0.0, &[(2.0, 2.0)]);
    let labels = (0..record.torque.len()).map(|row| (1 + row / 100) as f64).collect();
    let said = faulty(Record { frequency: Some(labels), ..record }, |_, count| count);
    assert!(said.len() < 500 && said.contains("of its periods are fewer than 4"), "{said}");
}

/// Amplitude in rad of the last of 20,000 ticks with a spring of this stiffness in N m/rad, over the largest
/// of the first twenty; the device without friction, which is the worst that it may have.
fn growth(device: Device, stiffness: f64) -> f64 {
    let (period, Device { inertia, damping, .. }) = (SENSING.period, device);
    let lag = inertia / damping;
    let gone = -(-period / lag).exp_m1();
    let (mut angle, mut speed) = (1e-3, 0.0);
    let angles: Vec<f64> = (0..20_000)
        .map(|_| {
            let settled = -stiffness * angle / damping;
            angle += settled * period + (speed - settled) * lag * gone;
            speed += (settled - speed) * gone;
            f64::abs(angle)
        })
        .collect();
    let most = |angles: &[f64]| angles.iter().copied().fold(0.0, f64::max);
    most(&angles[19_980..]) / most(&angles[..20])
}

#[test]
fn friction_at_two_amplitudes_is_no_damping_and_the_stiffest_spring_does_not_diverge() {
    for device in [KNOB, HEAVY] {
        for friction in [0.0, 5e-4, 2e-3, 1e-2] {
            let found = found(device, friction, &[2.0, 4.0]);
            println!("{} {friction}: {:?} {:?}", device.damping, found.damping, found.friction);
            let delta = found.passivity().unwrap();
            assert!(delta <= device.damping, "{friction} {delta}");
            assert!(delta > 0.95 * device.damping, "{friction} {delta}");
            let Estimate { lo, hi, .. } = found.friction;
            assert!(lo <= friction && friction <= hi, "{friction} {:?}", found.friction);
            // Theory, section 9: a spring without delay is certified, and stable, up to 2 delta/T.
            let growth = |delta: f64| growth(device, 2.0 * delta / SENSING.period);
            assert!(growth(delta) <= 1.0, "{friction} {}", growth(delta));
        }
    }
    // What one speed shows as damping is too much. For the knob, whose time constant is a period, a spring may
    // be stiffer before it is unstable than before it is active.
    let lump = found(HEAVY, 2e-3, &[2.0]).damping.value;
    assert!(lump > 1.01 * HEAVY.damping, "{lump}");
    assert!(growth(HEAVY, 2.0 * lump / SENSING.period) > 1e3, "{lump}");
}

const TONES: [f64; 9] = [2.0, 4.0, 8.0, 16.0, 32.0, 64.0, 100.0, 160.0, 240.0];

fn found(device: Device, friction: f64, speeds: &[f64]) -> Identification {
    let sines: Vec<_> = speeds.iter().flat_map(|speed| TONES.map(|tone| (tone, *speed))).collect();
    let record = rubbing(device, friction, &sines);
    identify(&record, &Correction::of_encoder(SENSING.counts_per_turn)).unwrap()
}

#[test]
fn friction_at_one_speed_gives_no_passivity() {
    for friction in [0.0, 5e-4, 2e-3, 1e-2] {
        let found = found(KNOB, friction, &[2.0]);
        assert!(!found.tells_friction && found.passivity().is_none(), "{found:?}");
        assert!(found.friction.lo <= friction && friction <= found.friction.hi, "{found:?}");
    }
}
