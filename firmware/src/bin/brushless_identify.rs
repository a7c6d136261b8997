//! Aligns a brushless motor, and drives its shaft with sines of torque by the bridge of a motor board, open loop, so
//! that the host can measure its inertia, its damping, its passivity, and the delay of the current loop's torque
//! (theory, section 3.3).
//!
//! Do not hold the device meanwhile: the alignment turns it by more than an electrical turn, and then it turns back
//! and forth by up to a radian, or twice that to one side, beside a slow drift where nothing stops it.
#![cfg_attr(target_os = "none", no_std, no_main)]

mod brushless_shaft;

pub use brushless_shaft::{DRIVE, TRANSDUCERS};
use haptic_servo::current::{B_G431B_ESC1, CurrentLoop};
use haptic_servo::excitation::{MotionLimits, Sweep, Tone, at_two_amplitudes};

/// Sampling period in s, 40 of the current loop: at that of the shaft's scenes the serial port is too slow for a row in
/// each period.
pub const PERIOD: f64 = 0.001;

/// The current loop of the shaft's scenes, whose instants are the same.
pub const CURRENT_LOOP: CurrentLoop =
    CurrentLoop::checked(&DRIVE, &B_G431B_ESC1, &TRANSDUCERS, PERIOD);

/// Limits of the device's motion, beyond which the sweep ends and the gates go off: three turns, because a handle
/// with almost no damping drifts by what a code is wrong.
pub const LIMITS: MotionLimits =
    MotionLimits { travel: 20.0, speed: 0.85 * TRANSDUCERS.largest_speed };

/// A part of the torque at the motor's full scale, in N m.
const fn part(part: f64) -> f64 {
    part * TRANSDUCERS.full_scale_torque
}

/// The tones at two amplitudes, of which the larger is given, up to a quarter of the sampling rate: at low
/// frequencies the torque for a radian, at high frequencies the torque that the drive's voltage allows. Even the
/// smallest is several counts of the current.
///
/// A torque outside the DAC range, or a part of a tone that is not a whole number of samples, is a
/// compile error here.
pub static SWEEP: Sweep<18> = Sweep::planned(
    PERIOD,
    &TRANSDUCERS,
    at_two_amplitudes([
        Tone { frequency: 2.0, amplitude: part(0.05), settle: 1, measured: 4 },
        Tone { frequency: 4.0, amplitude: part(0.1), settle: 2, measured: 6 },
        Tone { frequency: 8.0, amplitude: part(0.2), settle: 4, measured: 12 },
        Tone { frequency: 16.0, amplitude: part(0.35), settle: 8, measured: 24 },
        Tone { frequency: 32.0, amplitude: part(0.45), settle: 16, measured: 48 },
        Tone { frequency: 64.0, amplitude: part(0.5), settle: 32, measured: 96 },
        Tone { frequency: 100.0, amplitude: part(0.5), settle: 50, measured: 150 },
        Tone { frequency: 160.0, amplitude: part(0.6), settle: 80, measured: 240 },
        Tone { frequency: 240.0, amplitude: part(0.7), settle: 120, measured: 360 },
    ]),
);

haptic_servo::sweep_program!(SWEEP, TRANSDUCERS, LIMITS, bridge: CURRENT_LOOP);
