//! Drives a paddle with sines of torque by the bridge of a motor board, open loop, so that the host can
//! measure its inertia, its damping, its passivity, and the delay of the current loop's torque (theory,
//! section 3.3).
//!
//! Do not hold the device meanwhile: it turns back and forth by up to a fifth of a radian, or
//! twice that to one side.
#![cfg_attr(target_os = "none", no_std, no_main)]

mod bridge_paddle;

pub use bridge_paddle::{CURRENT_LOOP, PERIOD, TRANSDUCERS};
use haptic_servo::excitation::{MotionLimits, Sweep, Tone, at_two_amplitudes};

/// Limits of the device's motion, beyond which the sweep ends and the amplifier goes off: 1.5 times the angle
/// and 1.2 times the speed that the tones below cause in the device that they are made for.
pub const LIMITS: MotionLimits =
    MotionLimits { travel: 0.7, speed: 0.85 * TRANSDUCERS.largest_speed };

/// A part of the torque at the motor's full scale, in N m.
const fn part(part: f64) -> f64 {
    part * TRANSDUCERS.full_scale_torque
}

/// The tones at two amplitudes, of which the larger is given, up to a quarter of the sampling rate: at low
/// frequencies the torque for a fifth of a radian, at high frequencies the torque that stays below the largest
/// speed that the drive's voltage allows.
///
/// A torque outside the DAC range, or a part of a tone that is not a whole number of samples, is a
/// compile error here.
pub static SWEEP: Sweep<20> = Sweep::planned(
    PERIOD,
    &TRANSDUCERS,
    at_two_amplitudes([
        Tone { frequency: 1.0, amplitude: part(0.03), settle: 1, measured: 4 },
        Tone { frequency: 2.0, amplitude: part(0.06), settle: 1, measured: 4 },
        Tone { frequency: 4.0, amplitude: part(0.11), settle: 2, measured: 6 },
        Tone { frequency: 8.0, amplitude: part(0.22), settle: 4, measured: 12 },
        Tone { frequency: 16.0, amplitude: part(0.4), settle: 8, measured: 24 },
        Tone { frequency: 32.0, amplitude: part(0.42), settle: 16, measured: 48 },
        Tone { frequency: 64.0, amplitude: part(0.45), settle: 32, measured: 96 },
        Tone { frequency: 100.0, amplitude: part(0.5), settle: 50, measured: 150 },
        Tone { frequency: 160.0, amplitude: part(0.6), settle: 80, measured: 240 },
        Tone { frequency: 240.0, amplitude: part(0.7), settle: 120, measured: 360 },
    ]),
);

haptic_servo::sweep_program!(SWEEP, TRANSDUCERS, LIMITS, bridge: CURRENT_LOOP);
