//! The conditions on the other keys where the amplifier is updated N times in a period.

use haptic_servo::scene::{Latency, TimeRange, Timing};

use super::faults::Read;
use super::key::{self, Key};
use super::section::{Found, Section};
use super::tree::Span;

/// The places of the keys.
pub struct Places {
    /// `device.actuator_updates`.
    pub updates: Span,
    /// `servo.output_delay`.
    pub output_delay: Option<Span>,
    /// `servo.worst_period`.
    pub worst_period: Option<Span>,
}

impl Places {
    /// The places of these keys, if the amplifier is updated at all.
    pub fn of(
        updates: &Option<Found<f64>>,
        output_delay: &Option<Found<TimeRange>>,
        worst_period: &Option<Found<f64>>,
    ) -> Option<Self> {
        let updates = updates.as_ref().filter(|found| found.value > 0.0)?.span.clone();
        let output_delay = output_delay.as_ref().map(|found| found.span.clone());
        let worst_period = worst_period.as_ref().map(|found| found.span.clone());
        Some(Self { updates, output_delay, worst_period })
    }

    /// Reports values that a current loop with updates cannot have.
    pub fn check(&self, top: &Section<'_>, latency: &Latency, timing: &Timing) -> Read<()> {
        let no = |key: &Key, span: &Option<Span>, reason: String| {
            let span = span.as_ref().unwrap_or(&self.updates).clone();
            Err(top.conflict(key, span, reason))
        };
        let here = Some(self.updates.clone());
        let own = &key::ACTUATOR_UPDATES;
        if latency.actuator_lag.least <= 0.0 {
            let lag = key::ACTUATOR_LAG.path;
            return no(own, &here, format!("needs a `{lag}` that is greater than 0"));
        }
        if !latency.sensor_lag.is_zero() {
            return no(own, &here, format!("stands beside `{}`", key::SENSOR_LAG.path));
        }
        if let Some(worst) = timing.longer_period() {
            let reason = format!("is {worst} s, which may not be missed beside `{}`", own.path);
            return no(&key::WORST_PERIOD, &self.worst_period, reason);
        }
        if !latency.output_delay.is_exact() {
            let reason = format!("has to be known exactly beside `{}`", own.path);
            return no(&key::OUTPUT_DELAY, &self.output_delay, reason);
        }
        if latency.delay_in_updates(timing.period).is_none() {
            let nearest = latency.nearest_update(timing.period);
            let delay = latency.delay_at_update(nearest, timing.period);
            let reason = format!(
                "is not a whole number of updates, of which there are `{}` = {} in a period; the nearest is \
                 {nearest}: {delay} s",
                own.path, latency.actuator_updates
            );
            return no(&key::OUTPUT_DELAY, &self.output_delay, reason);
        }
        Ok(())
    }
}
