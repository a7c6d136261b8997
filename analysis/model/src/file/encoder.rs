//! The table of an encoder's readings.

use std::f64::consts::TAU;

use haptic_servo::certificate::is_static_at_port;
use haptic_servo::latency::{LONGEST_DELAY, LONGEST_LAG};
use haptic_servo::magnetic::Chip;
use haptic_servo::scene::{EncoderReading, Latency, Scene, TimeRange};

use super::faults::{Read, Reported};
use super::key;
use super::section::Section;
use super::transducers::counts_per_turn_of;
use crate::chip_on_board::ChipOnBoard;
use crate::quantity::rounded;

/// The contents of `[encoder]`.
pub struct EncoderTable {
    /// Its readings, without the device's friction.
    pub reading: EncoderReading,
    /// Time constant of its filter.
    pub lag: TimeRange,
    /// Counts in a turn.
    counts_per_turn: Option<f64>,
    /// The chip that the board reads.
    pub chip: Option<&'static Chip>,
}

/// Why an encoder that predicts is refused.
const PREDICTS: &str = "is true: no certificate exists for an encoder that predicts, because its reading is no mean \
                        of past positions; of an AS5047 read the angle without it, register 0x3FFE, or set DAECDIS, \
                        of a TLE5012B clear PREDICT, and state the age then";

fn unknown(section: &Section<'_>) -> Reported {
    let names = Chip::NAMES.join(", ");
    section.conflict(&key::CHIP, format!("has no driver; there are {names}"))
}

/// Reads `[encoder]`.
pub fn encoder(mut section: Section<'_>) -> Read<EncoderTable> {
    let counts_per_turn = section.optional(&key::READING_COUNTS);
    let chip = section.text(&key::CHIP);
    let [age, lag] = [&key::AGE, &key::READING_LAG].map(|key| section.time(key));
    let predicts = section.boolean(&key::PREDICTION);
    let [window, linearity, noise, hysteresis, dropped] =
        [&key::WINDOW, &key::LINEARITY, &key::NOISE, &key::HYSTERESIS, &key::DROPPED]
            .map(|key| section.number(key));
    section.finish();
    if predicts? == Some(true) {
        return Err(section.conflict(&key::PREDICTION, PREDICTS));
    }
    let reading = EncoderReading {
        age: age?,
        window: window?,
        linearity: linearity?,
        noise: noise?,
        hysteresis: hysteresis?,
        friction: 0.0,
        dropped: dropped? as u16,
    };
    let (lag, counts_per_turn, chip) = (lag?, counts_per_turn?, chip?);
    let chip = chip.map(|name| Chip::find(&name).ok_or_else(|| unknown(&section)));
    Ok(EncoderTable { reading, lag, counts_per_turn, chip: chip.transpose()? })
}

impl EncoderTable {
    /// The angle of a count in rad: that of the encoder, its chip's, or that of `[limits]`, beside which the encoder
    /// states none.
    pub fn step(&self, top: &Section<'_>, of_limits: Option<f64>) -> Read<Option<f64>> {
        if self.counts_per_turn.is_some() && of_limits.is_some() {
            let reason = format!("stands beside `{}`: leave out one of them", key::LIMITS.path);
            return Err(top.conflict(&key::READING_COUNTS, reason));
        }
        let own = self.counts_per_turn.or(self.chip.map(Chip::counts_per_turn));
        Ok(of_limits.or(own.map(|counts| TAU / counts)))
    }

    /// Checks that the scene covers the readings of its chip: at its counts, or at the updates of a board's own bridge,
    /// without which no board renders the scene.
    pub fn check_chip(
        &self,
        top: &Section<'_>,
        scene: &Scene,
        step: Option<f64>,
        has_bridge: bool,
    ) -> Read<()> {
        let (Some(chip), Some(step)) = (self.chip, step) else { return Ok(()) };
        if has_bridge && scene.latency.actuator_updates == 0 {
            let other = key::ACTUATOR_UPDATES.path;
            let reason = format!("is read before each update of the bridge: state `{other}`");
            return Err(top.conflict(&key::CHIP, reason));
        }
        ChipOnBoard { chip, has_bridge }
            .check(scene, counts_per_turn_of(step))
            .map_err(|error| top.conflict(&key::CHIP, format!("has no certificate: {error}")))?;
        match chip.frozen_after {
            Some(equal) if self.reading.noise < 1.0 => {
                let reason = format!(
                    "needs `{}` of 1 or more, which is {}: without noise its angle is the same {equal} times, and it \
                     counts as stopped",
                    key::NOISE.path,
                    self.reading.noise
                );
                Err(top.conflict(&key::CHIP, reason))
            }
            _ => Ok(()),
        }
    }

    /// The scene read by this encoder, with the device's friction.
    pub fn read(&self, top: &Section<'_>, scene: Scene, friction: Option<f64>) -> Read<Scene> {
        let latency = self.within(top, &scene)?;
        let is_endless = scene.environment.profile().is_some_and(|it| it.ends.is_none());
        let relies_on_friction = is_endless && self.reading.linearity > 0.0;
        let friction = friction.filter(|_| relies_on_friction).unwrap_or(0.0);
        let reading = EncoderReading { friction, ..self.reading };
        // A scene refers to it, as to the table of a torque profile.
        let read = latency.read_by(Box::leak(Box::new(reading)));
        if is_beyond_longest(&read, scene.timing.period) {
            let reason = format!(
                "and `{}` are together more than {LONGEST_DELAY} times {} = {} s",
                key::OUTPUT_DELAY.path,
                top.stated(&key::PERIOD),
                scene.timing.period
            );
            return Err(top.conflict(&key::AGE, reason));
        }
        let mut scene = Scene { latency: read, ..scene };
        if reading.dropped > 0 && !is_static_at_port(&scene) {
            if latency.actuator_updates > 0 {
                let reason = format!(
                    "stands beside `{}` and a torque of more than one position: state a longer `{}` in its place, by \
                     the time in which readings may fail",
                    key::ACTUATOR_UPDATES.path,
                    key::AGE.path
                );
                return Err(top.conflict(&key::DROPPED, reason));
            }
            let held = (f64::from(reading.dropped) + 1.0) * scene.timing.period;
            let worst = scene.timing.worst_period.unwrap_or(scene.timing.period);
            scene.timing.worst_period = Some(worst.max(held));
        }
        Ok(scene)
    }

    /// The times of the scene with the encoder's filter, beside which the age may stand.
    fn within(&self, top: &Section<'_>, scene: &Scene) -> Read<Latency> {
        let (mut latency, period) = (scene.latency, scene.timing.period);
        let EncoderReading { age, window, .. } = self.reading;
        let beside = |key: &key::Key, other: &key::Key| {
            Err(top.conflict(key, format!("stands beside `{}`", other.path)))
        };
        // By the mean value theorem.
        let averages = |other: &key::Key| {
            let reason = format!(
                "stands beside `{}`: leave it out, and state `{} = [{}, {}]`, as the mean is the position at one \
                 instant of the window",
                other.path,
                key::AGE.path,
                age.least,
                rounded(age.most + window, 15)
            );
            Err(top.conflict(&key::WINDOW, reason))
        };
        if !self.lag.is_zero() {
            if !latency.sensor_lag.is_zero() {
                return beside(&key::READING_LAG, &key::SENSOR_LAG);
            }
            top.check_time(&key::READING_LAG, self.lag, LONGEST_LAG, period)?;
            latency.sensor_lag = self.lag;
        }
        let filter = if self.lag.is_zero() { &key::SENSOR_LAG } else { &key::READING_LAG };
        let in_the_way = [
            (&key::ACTUATOR_LAG, latency.actuator_lag),
            (filter, latency.sensor_lag),
            (&key::ACTUATOR_RESPONSE, latency.actuator_response),
        ];
        if let Some((other, _)) = in_the_way.iter().find(|(_, time)| !time.is_zero())
            && window > 0.0
        {
            return averages(other);
        }
        if !self.lag.is_zero() && !latency.actuator_response.is_zero() {
            return beside(&key::READING_LAG, &key::ACTUATOR_RESPONSE);
        }
        if window > period {
            let reason = format!("is more than {} = {period} s", top.stated(&key::PERIOD));
            return Err(top.conflict(&key::WINDOW, reason));
        }
        if window > 0.0 && latency.actuator_updates > 0 {
            return averages(&key::ACTUATOR_UPDATES);
        }
        top.check_time(&key::AGE, age, LONGEST_DELAY, period)?;
        Ok(latency)
    }
}

/// Whether a torque may begin later after its position than any certificate covers at this period in s.
pub fn is_beyond_longest(latency: &Latency, period: f64) -> bool {
    let most = latency.output_delay.most + latency.encoder.deviation_of_age();
    most > LONGEST_DELAY * period
}

#[cfg(test)]
mod tests;
