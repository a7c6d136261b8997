//! Turns a device slowly by whole turns in both directions, open loop, so that the host can measure its friction
//! and its cogging (theory, section 3.5).
//!
//! Do not hold the device meanwhile: it turns on for many turns.
#![cfg_attr(target_os = "none", no_std, no_main)]

mod paddle;

use haptic_servo::excitation::{MotionLimits, Sweep, Tone};
use haptic_servo::servo::Transducers;
pub use paddle::TRANSDUCERS;

/// Sampling period in s.
pub const PERIOD: f64 = 0.001;

/// Limits of the device's motion, beyond which the sweep ends and the amplifier goes off: 32 turns from its
/// beginning in either direction, and a speed at which an encoder's nonlinearity does not look like cogging yet.
pub const LIMITS: MotionLimits = MotionLimits { travel: 200.0, speed: 40.0 };

/// Slow sines of torque at five amplitudes. At the lowest the torque has to be a little more than friction and
/// cogging together, or else the device does not move there, and others remain. Four seconds in each
/// direction are a turn at 2.5 rad/s. The last is faster, because only changes of speed show the inertia.
pub static SWEEP: Sweep<5> = sweep(&TRANSDUCERS);

/// The same for another motor, with parts of its torque at full scale.
pub const fn sweep(transducers: &Transducers) -> Sweep<5> {
    let full_scale = transducers.full_scale_torque;
    let tones = [
        Tone { frequency: 0.125, amplitude: 0.04 * full_scale, settle: 0, measured: 4 },
        Tone { frequency: 0.125, amplitude: 0.06 * full_scale, settle: 0, measured: 4 },
        Tone { frequency: 0.125, amplitude: 0.09 * full_scale, settle: 0, measured: 4 },
        Tone { frequency: 0.125, amplitude: 0.12 * full_scale, settle: 0, measured: 4 },
        Tone { frequency: 0.25, amplitude: 0.135 * full_scale, settle: 0, measured: 8 },
    ];
    Sweep::planned(PERIOD, transducers, tones)
}

haptic_servo::sweep_program!(SWEEP, TRANSDUCERS, LIMITS);
