//! Sines of torque for the measurement of a device (theory, section 3.3).
//!
//! A [`Sweep`] is made of tones in plain SI numbers and checked as a whole, for constants at compile time; an
//! [`Exciter`] computes its codes, the same on a board and on the host.
//!
//! Each tone lasts a whole number of samples, both the settling part and the measured part, so that one bin
//! of a Fourier sum is the response without leakage.
//!
//! ```
//! use haptic_servo::encoder::CounterWidth;
//! use haptic_servo::excitation::{Exciter, Sweep, Tone};
//! use haptic_servo::servo::Transducers;
//!
//! const MOTOR: Transducers = Transducers {
//!     counts_per_turn: 61_440.0,
//!     counter: CounterWidth::Bits16,
//!     full_scale_torque: 2.0,
//!     largest_speed: 100.0,
//! };
//! const SWEEP: Sweep<1> = Sweep::planned(
//!     0.001,
//!     &MOTOR,
//!     [Tone { frequency: 64.0, amplitude: 0.5, settle: 8, measured: 16 }],
//! );
//! assert_eq!(SWEEP.ticks(), 125 + 250);
//! let mut exciter = Exciter::new(&SWEEP);
//! assert_eq!(exciter.next().code.offset(), 0);
//!
//! // More than the DAC can give does not become a sweep.
//! let loud = Tone { frequency: 64.0, amplitude: 2.5, settle: 8, measured: 16 };
//! let error = Sweep::new(0.001, &MOTOR, [loud]).unwrap_err();
//! assert!(error.to_string().contains("an amplitude of 2.5 N m"));
//! ```

mod playing;
pub mod sine;

use core::fmt;

pub use playing::{Excitation, Exciter, Guard, MotionLimits, SILENCE, SWEEP_PROTOCOL, SweepEnd};

use crate::dac::DacCode;
use crate::text::{Text, or_refuse, sentences};
use crate::transducers::Transducers;

/// The smallest number of measured periods of a tone.
pub const LEAST_PERIODS: u32 = 4;

/// The largest number of samples of a part of a tone: up to this number phases are exact in `f32`.
const MOST_SAMPLES: f64 = (1 << 20) as f64;

/// Relative tolerance of a whole number of samples, for rounding.
const WHOLE: f64 = 1e-9;

/// One sine.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tone {
    /// Frequency in Hz.
    pub frequency: f64,
    /// Amplitude of the motor torque in N m.
    pub amplitude: f64,
    /// Periods in which the device settles.
    pub settle: u32,
    /// Periods that are measured.
    pub measured: u32,
}

/// Tones at their amplitude, and then all of them again at half of it, so that Coulomb friction is told from
/// damping: a sine sees `b + 4 f_c/(pi v_a)` at an amplitude `v_a` of the velocity (theory, section 3.4). `M` is
/// twice `N`.
///
/// ```
/// use haptic_servo::excitation::{Tone, at_two_amplitudes};
/// const TONES: [Tone; 2] = at_two_amplitudes([
///     Tone { frequency: 64.0, amplitude: 0.5, settle: 8, measured: 16 },
/// ]);
/// assert_eq!(TONES[1], Tone { amplitude: 0.25, ..TONES[0] });
/// ```
pub const fn at_two_amplitudes<const N: usize, const M: usize>(tones: [Tone; N]) -> [Tone; M] {
    const { assert!(M == 2 * N, "there are not twice as many tones") };
    let mut all = [Tone { frequency: 0.0, amplitude: 0.0, settle: 0, measured: 0 }; M];
    let mut i = 0;
    while i < N {
        all[i] = tones[i];
        all[N + i] = Tone { amplitude: 0.5 * tones[i].amplitude, ..tones[i] };
        i += 1;
    }
    all
}

/// A checked sequence of tones: each within the DAC's range and a whole number of samples long.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sweep<const N: usize> {
    period: f64,
    full_scale_torque: f64,
    tones: [Tone; N],
    steps: [Step; N],
}

/// A tone in samples and codes.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Step {
    /// Samples in which the device settles.
    settle: u32,
    measured: u32,
    /// Periods in the measured samples: the sine turns by `cycles / measured` per sample.
    cycles: u32,
    /// Amplitude in codes.
    codes: f32,
}

impl<const N: usize> Sweep<N> {
    /// Checks tones for a period in s and a motor.
    ///
    /// # Errors
    /// For the first tone that is out of the range of DAC or sampling, or whose parts do not take a whole
    /// number of samples.
    pub const fn new(
        period: f64,
        transducers: &Transducers,
        tones: [Tone; N],
    ) -> Result<Self, SweepError> {
        let full_scale_torque = transducers.full_scale_torque;
        if !(period > 0.0 && period < f64::INFINITY) {
            return Err(SweepError::NotPositive { name: "period", value: period });
        }
        if !(full_scale_torque > 0.0 && full_scale_torque < f64::INFINITY) {
            let (name, value) = ("full-scale torque", full_scale_torque);
            return Err(SweepError::NotPositive { name, value });
        }
        let mut steps = [Step { settle: 0, measured: 1, cycles: 0, codes: 0.0 }; N];
        let mut i = 0;
        while i < N {
            steps[i] = ok!(step(i, &tones[i], period, full_scale_torque));
            i += 1;
        }
        Ok(Self { period, full_scale_torque, tones, steps })
    }

    /// The same for a constant: refused tones are a compile error.
    #[track_caller]
    pub const fn planned(period: f64, transducers: &Transducers, tones: [Tone; N]) -> Self {
        or_refuse!(Self::new(period, transducers, tones))
    }

    /// Sampling period in s.
    pub const fn period(&self) -> f64 {
        self.period
    }

    /// Motor torque in N m at the DAC's largest code.
    pub const fn full_scale_torque(&self) -> f64 {
        self.full_scale_torque
    }

    /// The tones in their order.
    pub const fn tones(&self) -> &[Tone; N] {
        &self.tones
    }

    /// Number of samples of the sweep.
    pub const fn ticks(&self) -> u64 {
        let (mut ticks, mut i) = (0, 0);
        while i < N {
            ticks += self.steps[i].settle as u64 + self.steps[i].measured as u64;
            i += 1;
        }
        ticks
    }
}

const fn step(
    tone: usize,
    &Tone { frequency, amplitude, settle, measured }: &Tone,
    period: f64,
    full_scale_torque: f64,
) -> Result<Step, SweepError> {
    // All written so that NaN is refused.
    let largest = 0.5 / period;
    if !(frequency > 0.0 && frequency < largest) {
        return Err(SweepError::Frequency { tone, frequency, largest });
    }
    let codes = amplitude / full_scale_torque * DacCode::CODES_TO_FULL_SCALE as f64;
    if !(codes >= 1.0 && amplitude <= full_scale_torque) {
        let least = full_scale_torque / DacCode::CODES_TO_FULL_SCALE as f64;
        return Err(SweepError::Amplitude { tone, amplitude, least, largest: full_scale_torque });
    }
    if measured < LEAST_PERIODS {
        return Err(SweepError::Periods { tone, measured });
    }
    let settle = ok!(whole(tone, settle, frequency, period));
    let samples = ok!(whole(tone, measured, frequency, period));
    Ok(Step { settle, measured: samples, cycles: measured, codes: codes as f32 })
}

/// The number of samples of a number of periods.
const fn whole(tone: usize, periods: u32, frequency: f64, period: f64) -> Result<u32, SweepError> {
    let samples = periods as f64 / (frequency * period);
    let nearest = (samples + 0.5) as u32;
    let off = (samples - nearest as f64).abs();
    if samples <= MOST_SAMPLES && off <= WHOLE * samples {
        Ok(nearest)
    } else {
        Err(SweepError::Samples { tone, periods, samples, most: MOST_SAMPLES })
    }
}

/// The plan: one line per tone, and the duration.
impl<const N: usize> fmt::Display for Sweep<N> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "{:>10} {:>14} {:>12} {:>12}", "frequency", "amplitude", "settle", "measured")?;
        for (tone, step) in self.tones.iter().zip(&self.steps) {
            let seconds = |samples: u32| f64::from(samples) * self.period;
            let (settle, measured) = (seconds(step.settle), seconds(step.measured));
            let Tone { frequency, amplitude, .. } = tone;
            writeln!(
                f,
                "{frequency:>7} Hz {amplitude:>10} N m {settle:>10.3} s {measured:>10.3} s"
            )?;
        }
        let seconds = self.ticks() as f64 * self.period;
        writeln!(f, "{} ticks of {} s, {seconds:.3} s in all", self.ticks(), self.period)
    }
}

sentences! {
    /// An error of a sweep. Tones are counted from 0.
    SweepError: Text<240> {
    NotPositive { name: &'static str, value: f64 } => (
        "the " {name} " is " {value} "; it must be positive and finite"),
    Frequency { tone: usize, frequency: f64, largest: f64 } => (
        "tone " {tone} " has a frequency of " {frequency} " Hz; it must be above 0 and below half the \
         sampling rate, " {largest} " Hz"),
    /// The bounds are the torque of one code, and full scale.
    Amplitude { tone: usize, amplitude: f64, least: f64, largest: f64 } => (
        "tone " {tone} " has an amplitude of " {amplitude} " N m; the DAC gives " {least} " to " {largest} " N m"),
    Periods { tone: usize, measured: u32 } => (
        "tone " {tone} " has a measured part of " {measured} " periods; it must be at least " {LEAST_PERIODS}),
    Samples { tone: usize, periods: u32, samples: f64, most: f64 } => (
        "tone " {tone} " has a part of " {periods} " periods, which take " {samples} " samples; they must \
         take a whole number of samples, and at most " {most}),
    }
}

#[cfg(test)]
mod tests;
