//! The latency between a command and its torque, as a measurement shows it.

use serde::Serialize;
use thiserror::Error;

use super::estimate::Estimate;
use super::profile::{Open, Profile};
use crate::quantity::significant;

/// Largest uncertainty of the mean delay, as phase in rad of the fastest response, at which there are
/// intervals: beyond it the fit may have taken one turn of the phase for another.
const COARSE: f64 = 0.5;

/// Times in s between a command and its torque, beyond the declared delays of the measurement.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Latency {
    /// Time constant of the amplifier.
    pub actuator_lag: Estimate,
    /// Delay of the output. Its lower end is less than zero if the record may be skewed by that.
    pub output_delay: Estimate,
}

/// Why lag and delay have no intervals.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
#[allow(missing_docs, reason = "the sentences describe the variants")]
pub enum NoLatency {
    #[error(
        "inertia, damping, lag and delay do not explain the responses, so an interval of lag or \
         delay would not be true"
    )]
    NotRigid,
    #[error(
        "the amplifier's lag cannot be told from the time constant inertia/damping of the device: \
         where the one is {} s, the other may be it. Declare a shorter --longest-lag, if the amplifier's \
         bandwidth is known",
        significant(*.0, 3)
    )]
    LikeInertia(f64),
    #[error(
        "the responses allow a lag of more than {} s, the longest that is taken for the amplifier's: a \
         slower one looks like the device's inertia. Add faster tones, declare --longest-lag if the \
         amplifier's bandwidth is known, or take a faster amplifier",
        significant(*.0, 3)
    )]
    TooSlow(f64),
    #[error(
        "lag and delay are known to {} s only: the tones end at {} Hz, and few of them stand out of \
         the noise. Add faster tones, or use a larger torque",
        significant(*.reach, 2),
        significant(*.frequency, 3)
    )]
    Coarse { reach: f64, frequency: f64 },
    #[error(
        "the motion comes {} s too early for any delay: the counts are younger than their time, or a \
         declared delay is too long. Correct the time stamps, --torque-delay or --count-delay",
        significant(-*.0, 3)
    )]
    Early(f64),
}

impl Latency {
    /// Lag and delay of the devices that the responses allow; `fastest` is the highest angular frequency of a
    /// response in rad/s.
    pub fn of(profile: &Profile, fastest: f64, is_explained: bool) -> Result<Self, NoLatency> {
        let (sum, delay) = (profile.mean_delay(), profile.delay());
        let reach = 0.5 * (sum.hi - sum.lo);
        // Checked before the misfit, because too long a lag causes a misfit.
        match profile.open {
            Some(Open::Longest(longest)) => return Err(NoLatency::TooSlow(longest)),
            Some(Open::Exchange(lag)) => return Err(NoLatency::LikeInertia(lag)),
            None if !is_explained => return Err(NoLatency::NotRigid),
            None => {}
        }
        if reach * fastest > COARSE {
            let frequency = fastest / std::f64::consts::TAU;
            return Err(NoLatency::Coarse { reach, frequency });
        }
        if profile.is_early || delay.hi < 0.0 {
            return Err(NoLatency::Early(delay.value));
        }
        Ok(Self { actuator_lag: profile.lag(), output_delay: delay })
    }

    /// Whether the responses exclude at least one of a lag alone and a delay alone.
    pub fn is_told_apart(&self) -> bool {
        self.actuator_lag.lo > 0.0 || self.output_delay.lo > 0.0
    }

    /// The range of the lag for a certificate, in s.
    pub fn lag_range(&self) -> [f64; 2] {
        [self.actuator_lag.lo, self.actuator_lag.hi]
    }

    /// The range of the delay for a certificate, in s: no torque comes before its count.
    pub fn delay_range(&self) -> [f64; 2] {
        [self.output_delay.lo.max(0.0), self.output_delay.hi.max(0.0)]
    }
}
