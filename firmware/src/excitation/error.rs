//! Errors of a sweep.

use super::LEAST_PERIODS;
use crate::text::{Text, error_with_sentence, push};

/// An error of a sweep. Tones are counted from 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum SweepError {
    /// The period or the motor's torque is zero, negative or not finite.
    NotPositive {
        /// Its name.
        name: &'static str,
        /// Its value.
        value: f64,
    },
    /// A frequency that is too high to sample as a sine.
    Frequency {
        /// Which tone.
        tone: usize,
        /// Its frequency in Hz.
        frequency: f64,
        /// Half the sampling rate in Hz, the upper bound.
        largest: f64,
    },
    /// An amplitude outside the DAC's range.
    Amplitude {
        /// Which tone.
        tone: usize,
        /// Its amplitude in N m.
        amplitude: f64,
        /// Torque of one code in N m.
        least: f64,
        /// Torque at full scale in N m.
        largest: f64,
    },
    /// Too few periods to measure.
    Periods {
        /// Which tone.
        tone: usize,
        /// The number of measured periods.
        measured: u32,
    },
    /// Periods that do not take a whole number of samples, or take too many.
    Samples {
        /// Which tone.
        tone: usize,
        /// The number of periods.
        periods: u32,
        /// The number of samples.
        samples: f64,
        /// The largest number of samples.
        most: f64,
    },
}

impl SweepError {
    /// The error as a sentence, the same at compile time and later.
    pub const fn sentence(&self) -> Text<240> {
        let mut t = Text::new();
        match *self {
            Self::NotPositive { name, value } => {
                push!(t, "the " {name} " is " {value} "; it must be positive and finite");
            }
            Self::Frequency { tone, frequency, largest } => push!(t,
                "tone " {tone} " has a frequency of " {frequency} " Hz; it must be above 0 and below half the \
                 sampling rate, " {largest} " Hz"),
            Self::Amplitude { tone, amplitude, least, largest } => push!(t,
                "tone " {tone} " has an amplitude of " {amplitude} " N m; the DAC gives " {least} " to " {largest}
                " N m"),
            Self::Periods { tone, measured } => push!(t,
                "tone " {tone} " has a measured part of " {measured} " periods; it must be at least "
                {LEAST_PERIODS}),
            Self::Samples { tone, periods, samples, most } => push!(t,
                "tone " {tone} " has a part of " {periods} " periods, which take " {samples} " samples; they must \
                 take a whole number of samples, and at most " {most}),
        }
        t
    }
}

error_with_sentence!(SweepError);
