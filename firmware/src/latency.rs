//! The latency between a count and its torque: delays of the output, and lags of amplifier and sensor.
//!
//! A lag is of first order, with a gain of 1. The lag of a current loop may apply only at the instants at
//! which the loop is updated, a whole number of times per period. For an amplifier that is not known to be a
//! lag, the beginning and the end of its step response may be stated instead. All of it is on the
//! controller's side of the device's port: the device's passivity is that from the motor's torque to the
//! velocity at the encoder (theory, section 13).

use crate::encoder_reading::EncoderReading;
use crate::passivity::interval::Interval;
use crate::passivity::lagged::delay_of_updates;
pub use crate::time_range::TimeRange;
use crate::time_range::is_zero;

/// Longest delay of the output, in periods.
pub const LONGEST_DELAY: f64 = 8.0;

/// Longest lag, in periods: a slower loop filters everything that a servo at this rate could add.
pub const LONGEST_LAG: f64 = 100.0;

/// Largest number of [trails](Latency::trails): two lags, each in a range.
pub const TRAILS: usize = 4;

/// Relative tolerance of a whole number of updates, because decimals of a third are rounded.
const NEARLY_WHOLE: f64 = 1e-9;

/// Delays and lags between the instant of a count and that of its torque.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "wire", derive(serde::Serialize, serde::Deserialize))]
pub struct Latency {
    /// Time from a count to its torque, in addition to the environment's whole samples.
    pub output_delay: TimeRange,
    /// Largest deviation in s from that delay in either direction, which may differ from tick to tick: of
    /// the torques; of either the torques or the counts if [`Latency::count_jitter`] is 0.
    pub output_jitter: f64,
    /// Largest deviation in s of a count from its time in either direction, which may differ from tick to
    /// tick, while the torques deviate by the output jitter (theory, section 13.4). Without an output jitter
    /// it is the same as that. On a board the counts deviate by at most this, or by the output jitter if
    /// this is 0.
    pub count_jitter: f64,
    /// Time constant of the amplifier.
    pub actuator_lag: TimeRange,
    /// Time constant of the filter between encoder and servo.
    pub sensor_lag: TimeRange,
    /// For an amplifier that is not a lag: its step response never falls, begins after the least and ends
    /// before the most of this range, which is at most a period. Zero if the torque follows at once.
    pub actuator_response: TimeRange,
    /// Updates of the amplifier's current loop per period; 0: its lag is continuous. At each update the
    /// torque is that of the lag, and between two updates it changes linearly. The output delay, without the age
    /// of a reading, must be a whole number of update intervals.
    pub actuator_updates: u16,
    /// The readings of the encoder, whose times are parts of the times above: set by [`Latency::read_by`].
    ///
    /// No message has them: a board certifies with those of its program.
    #[cfg_attr(feature = "wire", serde(skip, default = "EncoderReading::ideal"))]
    pub encoder: &'static EncoderReading,
}

impl Latency {
    /// A torque at the instant of its count. With latched torques and a very fast amplifier, the
    /// environment's whole samples are the only delay.
    pub const NONE: Self = Self {
        output_delay: TimeRange::ZERO,
        output_jitter: 0.0,
        count_jitter: 0.0,
        actuator_lag: TimeRange::ZERO,
        sensor_lag: TimeRange::ZERO,
        actuator_response: TimeRange::ZERO,
        actuator_updates: 0,
        encoder: EncoderReading::ideal(),
    };

    /// A known and constant delay of the output in s.
    pub const fn delayed(output_delay: f64) -> Self {
        Self { output_delay: TimeRange::exactly(output_delay), ..Self::NONE }
    }

    /// The same with an amplifier with this time constant in s.
    pub const fn with_actuator_lag(self, lag: f64) -> Self {
        Self { actuator_lag: TimeRange::exactly(lag), ..self }
    }

    /// The same with an amplifier whose step response rises from `begin` to `end`, in s.
    pub const fn with_actuator_response(self, begin: f64, end: f64) -> Self {
        Self { actuator_response: TimeRange::between(begin, end), ..self }
    }

    /// The same with the readings of an encoder: an age is a delay of the output, and a varying age a jitter of
    /// the counts, because only the time from a position to its torque counts (theory, section 18.1). The window
    /// of a mean is that of an amplifier's response, which the two sides of the loop may exchange (section 13.7).
    pub const fn read_by(self, encoder: &'static EncoderReading) -> Self {
        let (middle, deviation) = (encoder.age.middle(), encoder.deviation_of_age());
        let TimeRange { least, most } = self.output_delay;
        Self {
            output_delay: TimeRange::between(least + middle, most + middle),
            count_jitter: self.count_jitter + deviation,
            actuator_response: TimeRange {
                most: self.actuator_response.most + encoder.window,
                ..self.actuator_response
            },
            encoder,
            ..self
        }
    }

    /// A current loop with `updates` updates, at least one, in each `period`, and with the time constant
    /// `lag`, both in s: its torque begins one update after the update that takes the code over.
    pub const fn sampled(updates: u16, lag: f64, period: f64) -> Self {
        let output_delay = TimeRange::exactly(period / updates as f64);
        let actuator_lag = TimeRange::exactly(lag);
        Self { output_delay, actuator_lag, actuator_updates: updates, ..Self::NONE }
    }

    /// Time in s from a count to the instant at which its code is taken over, in addition to whole samples,
    /// as in an [`OutputTiming`](crate::output_timing::OutputTiming). A current loop's torque begins an
    /// update later.
    pub const fn code_delay(&self, period: f64) -> f64 {
        let delay = self.stated_delay();
        match self.actuator_updates {
            0 => delay,
            _ => self.delay_at_update(self.nearest_update(period).saturating_sub(1), period),
        }
    }

    /// The middle of the output delay in s without the age of a reading.
    pub const fn stated_delay(&self) -> f64 {
        let delay = self.output_delay.middle();
        if self.encoder.age.is_zero() { delay } else { delay - self.encoder.age.middle() }
    }

    /// The whole number of updates nearest to the output delay without the age of a reading, at this period in s.
    pub const fn nearest_update(&self, period: f64) -> u32 {
        (self.stated_delay() / period * self.actuator_updates as f64 + 0.5) as u32
    }

    /// The output delay in s of a number of updates.
    pub const fn delay_at_update(&self, update: u32, period: f64) -> f64 {
        update as f64 * period / self.actuator_updates as f64
    }

    /// The output delay in periods of an updated current loop: exactly a whole number of updates, and the age of a
    /// reading.
    ///
    /// `None` if the delay without the age differs from that by more than a part in a billion, or if a time is stated that such a
    /// loop cannot have.
    #[inline(never)]
    pub const fn delay_in_updates(&self, period: f64) -> Option<Interval> {
        let is_lagging = self.actuator_lag.least > 0.0 && self.actuator_response.is_zero();
        if !(is_lagging && self.output_delay.is_exact()) {
            return None;
        }
        let update = self.nearest_update(period);
        let whole = self.delay_at_update(update, period);
        if (self.stated_delay() - whole).abs() > NEARLY_WHOLE * whole {
            return None;
        }
        let delay = delay_of_updates(update, self.actuator_updates);
        if !self.is_between_updates() {
            return Some(delay);
        }
        let age = Interval::decimal(self.encoder.age.middle()).div(Interval::decimal(period));
        Some(delay.add(age))
    }

    /// Whether, from the instant of a reading, a torque begins between two updates of the current loop.
    pub const fn is_between_updates(&self) -> bool {
        self.actuator_updates > 0 && !self.encoder.age.is_zero()
    }

    /// Whether a sensor filter stands beside an amplifier that is updated in the period. Then the certificate has a
    /// continuous lag in place of the [updates](Self::judged_updates), and a torque that comes
    /// [later](Self::later_than_lag) than it.
    pub const fn is_filtered_beside_updates(&self) -> bool {
        self.actuator_updates > 0 && !self.sensor_lag.is_zero()
    }

    /// The updates of the amplifier whose torque the certificate has; 0 for a continuous lag.
    pub const fn judged_updates(&self) -> u16 {
        if self.is_filtered_beside_updates() { 0 } else { self.actuator_updates }
    }

    /// The most in periods by which the torque comes later than that of the [judged](Self::judged_updates) amplifier
    /// (theory, section 13.8).
    pub const fn later_than_lag(&self, period: f64) -> Interval {
        if !self.is_filtered_beside_updates() {
            return Interval::ZERO;
        }
        let between = Interval::ONE.div(Interval::exact(self.actuator_updates as f64));
        let lag = Interval::decimal(self.actuator_lag.least).div(Interval::decimal(period));
        between.mul(between).div(lag.mul(Interval::exact(8.0))).min(between)
    }

    /// Largest sum in s of the jitters of a scene with this period and an environment that is late by a
    /// sample or more (`is_late`) or not: no torque comes before its count, which in the first case is a
    /// period earlier.
    pub const fn largest_jitter(&self, is_late: bool, period: f64) -> f64 {
        self.output_delay.least + if is_late { period } else { 0.0 }
    }

    /// The most in s by which a torque begins earlier or later after its count than the delay: the sum of both
    /// jitters.
    pub const fn total_jitter(&self) -> f64 {
        self.output_jitter + self.count_jitter
    }

    /// Whether torques and counts deviate at the same time.
    pub const fn jitters_twice(&self) -> bool {
        !is_zero(self.output_jitter) && !is_zero(self.count_jitter)
    }

    /// The bound in s below which the sum of two jitters has to be at this period in s: half of what the
    /// ranges of delay and response leave of a period. `None` if a lag is known in a range only, beside which
    /// two jitters are not covered (theory, section 13.4).
    pub const fn bound_on_two_jitters(&self, period: f64) -> Option<f64> {
        if !self.actuator_lag.is_exact() || !self.sensor_lag.is_exact() {
            return None;
        }
        let delay = self.torque_delay();
        Some(0.5 * (period - (delay.most - delay.least)))
    }

    /// The most in s by which a count of a board, whose timer puts the torques out, deviates from its time,
    /// without the encoder's age.
    pub const fn deviation_of_counts(&self) -> f64 {
        if is_zero(self.count_jitter) {
            self.output_jitter
        } else if self.encoder.age.is_zero() {
            self.count_jitter
        } else {
            self.count_jitter - self.encoder.deviation_of_age()
        }
    }

    /// The whole samples that the latest torque takes at this period in s, jitters included: as many past
    /// torques a [matched coupling](crate::matched::MatchedCoupling) stores.
    pub const fn whole_samples(&self, period: f64) -> usize {
        /// Above the rounding errors of the quotient, so that a whole number is not below itself.
        const ROUNDING: f64 = 2e-15;
        let latest = match self.actuator_updates {
            0 => (self.torque_delay().most + self.total_jitter()) / period,
            updates => {
                let late = self.encoder.age.middle() + self.total_jitter();
                let delay = self.nearest_update(period) as f64 / updates as f64 + late / period;
                delay + self.later_than_lag(period).hi()
            }
        };
        (latest * (1.0 + ROUNDING)) as usize
    }

    /// The number of decaying series in the effect of past torques: one for each lag, two if it is known in a
    /// range.
    pub const fn trails(&self) -> usize {
        self.actuator_lag.trails() + self.sensor_lag_apart().trails()
    }

    /// The lag of the sensor, in a wider range where it is too near to that of the amplifier: their response is the
    /// difference of two exponentials, over that of their time constants. The rest of a step rises with each of them,
    /// so that an end farther out is earlier, or later, than the end itself.
    pub const fn sensor_lag_apart(&self) -> TimeRange {
        /// Positive numbers are ordered as their bits. By this many the lags differ, between a 4096th and a 2048th,
        /// whose square is near to the rounding of `f32`.
        const APART: u64 = 1 << 41;
        #[inline(never)]
        const fn apart(second: f64, first: f64, by: u64) -> f64 {
            let at = first.to_bits();
            let is_near = at > 0 && at.abs_diff(second.to_bits()) < APART / 2;
            if is_near { f64::from_bits(at.wrapping_add(by)) } else { second }
        }
        let (TimeRange { least, most }, first) = (self.sensor_lag, self.actuator_lag);
        TimeRange {
            least: apart(least, first.least, APART.wrapping_neg()),
            most: apart(most, first.most, APART),
        }
    }

    /// The time from a count to the parts of its torque: the delay of the output plus the amplifier's
    /// response.
    pub const fn torque_delay(&self) -> TimeRange {
        self.output_delay.followed_by(self.actuator_response)
    }

    /// Whether there is no latency.
    pub const fn is_none(&self) -> bool {
        self.output_delay.is_zero()
            && is_zero(self.output_jitter)
            && is_zero(self.count_jitter)
            && self.actuator_lag.is_zero()
            && self.sensor_lag.is_zero()
            && self.actuator_response.is_zero()
    }
}

impl Default for Latency {
    fn default() -> Self {
        Self::NONE
    }
}
