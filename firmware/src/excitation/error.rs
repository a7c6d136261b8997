//! Errors of a sweep.

use core::fmt;

use super::LEAST_PERIODS;
use crate::text::Text;

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
                t.push("the ");
                t.push(name);
                t.push(" is ");
                t.push_number(value);
                t.push("; it must be positive and finite");
            }
            Self::Frequency { tone, frequency, largest } => {
                of_tone(&mut t, tone, "a frequency of ", frequency);
                t.push(" Hz; it must be above 0 and below half the sampling rate, ");
                t.push_number(largest);
                t.push(" Hz");
            }
            Self::Amplitude { tone, amplitude, least, largest } => {
                of_tone(&mut t, tone, "an amplitude of ", amplitude);
                t.push(" N m; the DAC gives ");
                t.push_number(least);
                t.push(" to ");
                t.push_number(largest);
                t.push(" N m");
            }
            Self::Periods { tone, measured } => {
                of_tone(&mut t, tone, "a measured part of ", measured as f64);
                t.push(" periods; it must be at least ");
                t.push_number(LEAST_PERIODS as f64);
            }
            Self::Samples { tone, periods, samples, most } => {
                of_tone(&mut t, tone, "a part of ", periods as f64);
                t.push(" periods, which take ");
                t.push_number(samples);
                t.push(" samples; they must take a whole number of samples, and at most ");
                t.push_number(most);
            }
        }
        t
    }
}

const fn of_tone(t: &mut Text<240>, tone: usize, what: &str, value: f64) {
    t.push("tone ");
    t.push_number(tone as f64);
    t.push(" has ");
    t.push(what);
    t.push_number(value);
}

impl fmt::Display for SweepError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.sentence().as_str())
    }
}

impl core::error::Error for SweepError {}
