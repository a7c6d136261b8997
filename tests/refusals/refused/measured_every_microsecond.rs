//! A measurement at a period that no board keeps.

use haptic_servo::excitation::{MotionLimits, Sweep, Tone};
use refusals::TRANSDUCERS;

const LIMITS: MotionLimits = MotionLimits { travel: 0.7, speed: 50.0 };

static SWEEP: Sweep<1> = Sweep::planned(
    1e-6,
    &TRANSDUCERS,
    [Tone { frequency: 10.0, amplitude: 0.1, settle: 1, measured: 8 }],
);

haptic_servo::sweep_program!(SWEEP, TRANSDUCERS, LIMITS);
