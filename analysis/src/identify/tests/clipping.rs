//! Torques that were not commanded: an amplifier that clips, and the zero crossings of a bridge.

use haptic_servo::current::TorqueSource;

use super::*;

/// A current loop of 1 kHz, of whose motor nothing else is to be seen.
const CROSSING: TorqueSource = TorqueSource {
    gain: 1e-6,
    resistance: 0.6,
    inductance: 0.12e-3,
    feedback: 0.14,
    instant: 25e-6,
    loss: 0.0,
    step: 0.004,
    zero_crossing: 0.115,
};

/// A record in which the third harmonic of each sine is a part of it that was not commanded.
fn distorted(part: impl Fn(f64) -> f64) -> Record {
    let sine = |frequency, amplitude| Excitation { frequency, amplitude, duration: 2.0 };
    let sines = [sine(8.0, 0.15), sine(32.0, 0.4), sine(64.0, 0.45)];
    rig(KNOB, SENSING).play(&sines, |sine, phase| {
        sine.amplitude * (phase.sin() + part(sine.frequency) * (3.0 * phase).sin())
    })
}

#[test]
fn what_a_bridge_adds_at_zero_crossings_is_not_clipped() {
    let plain = Correction::of_encoder(SENSING.counts_per_turn);
    let bridge = Correction { source: Some(CROSSING), ..plain };
    // As in a simulation of the paddle's bridge edge by edge: the part rises with the frequency.
    let record = distorted(|frequency| 0.045 * frequency / 64.0);
    let clipped = |found| matches!(found, Err(IdentifyError::Clipped { frequency: 64.0, .. }));
    assert!(clipped(identify(&record, &plain)));
    assert!(identify(&record, &bridge).is_ok());
    // More than that has another cause.
    let record = distorted(|frequency| 0.12 * frequency / 64.0);
    assert!(clipped(identify(&record, &bridge)));
}
