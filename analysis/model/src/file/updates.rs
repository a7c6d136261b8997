//! The conditions on the other keys where the amplifier is updated N times in a period.

use haptic_servo::scene::{Latency, Timing};

use super::faults::Read;
use super::key::{self, Key};
use super::section::Section;

/// Reports values that a current loop with updates cannot have.
pub fn check(top: &Section<'_>, latency: &Latency, timing: &Timing) -> Read<()> {
    let own = &key::ACTUATOR_UPDATES;
    if latency.actuator_updates == 0 {
        return Ok(());
    }
    let no = |key: &Key, reason: String| {
        let place = top.place(key).unwrap_or_else(|| top.place_of(own));
        Err(top.conflict_at(key, &place, reason))
    };
    if latency.actuator_lag.least <= 0.0 {
        let lag = key::ACTUATOR_LAG.path;
        return no(own, format!("needs a `{lag}` that is greater than 0"));
    }
    if let Some(worst) = timing.longer_period() {
        let reason = format!("is {worst} s, which may not be missed beside `{}`", own.path);
        return no(&key::WORST_PERIOD, reason);
    }
    if !latency.output_delay.is_exact() {
        let reason = format!("has to be known exactly beside `{}`", own.path);
        return no(&key::OUTPUT_DELAY, reason);
    }
    if latency.delay_in_updates(timing.period).is_none() {
        let nearest = latency.nearest_update(timing.period);
        let delay = latency.delay_at_update(nearest, timing.period);
        let reason = format!(
            "is not a whole number of updates, of which there are `{}` = {} in a period; the nearest is \
             {nearest}: {delay} s",
            own.path, latency.actuator_updates
        );
        return no(&key::OUTPUT_DELAY, reason);
    }
    Ok(())
}
