//! Drives a device with sines of torque, open loop, so that the host can measure its inertia, its
//! damping and its passivity (theory, section 3.3).
//!
//! Do not hold the device meanwhile: it turns back and forth by up to a fifth of a radian, or
//! twice that to one side.
#![cfg_attr(target_os = "none", no_std, no_main)]

mod device;

pub use device::TRANSDUCERS;
use haptic_servo::excitation::{MotionLimits, Sweep, Tone, at_two_amplitudes};

/// Sampling period in s: that of the device's later scenes.
pub const PERIOD: f64 = 0.001;

/// Limits of the device's motion, beyond which the sweep ends and the amplifier goes off: 1.5 times the angle
/// and 1.2 times the speed that the tones below cause in the device that they are made for.
pub const LIMITS: MotionLimits =
    MotionLimits { travel: 0.7, speed: 0.85 * TRANSDUCERS.largest_speed };

/// A part of the torque at the motor's full scale, in N m.
const fn part(part: f64) -> f64 {
    part * TRANSDUCERS.full_scale_torque
}

/// The tones at two amplitudes, of which the larger is given, up to a quarter of the sampling rate, for a
/// device with about 2e-5 kg m^2, 0.02 N m s/rad and 2 N m: at low frequencies the torque for a fifth of a
/// radian, at high frequencies as much as the motor allows, because damping and skew can be distinguished only
/// where inertia dominates. A heavier device needs more torque or lower frequencies; the host reports motion
/// that is too small for the encoder.
///
/// A torque outside the DAC range, or a part of a tone that is not a whole number of samples, is a
/// compile error here.
pub static SWEEP: Sweep<20> = Sweep::planned(
    PERIOD,
    &TRANSDUCERS,
    at_two_amplitudes([
        Tone { frequency: 1.0, amplitude: part(0.015), settle: 1, measured: 4 },
        Tone { frequency: 2.0, amplitude: part(0.03), settle: 1, measured: 6 },
        Tone { frequency: 4.0, amplitude: part(0.055), settle: 2, measured: 10 },
        Tone { frequency: 8.0, amplitude: part(0.11), settle: 4, measured: 16 },
        Tone { frequency: 16.0, amplitude: part(0.225), settle: 8, measured: 32 },
        Tone { frequency: 32.0, amplitude: part(0.45), settle: 16, measured: 64 },
        Tone { frequency: 64.0, amplitude: part(0.8), settle: 32, measured: 128 },
        Tone { frequency: 100.0, amplitude: part(0.8), settle: 50, measured: 200 },
        Tone { frequency: 160.0, amplitude: part(0.8), settle: 80, measured: 320 },
        Tone { frequency: 240.0, amplitude: part(0.8), settle: 120, measured: 480 },
    ]),
);

haptic_servo::sweep_program!(SWEEP, TRANSDUCERS, LIMITS);
