//! The age of an encoder's readings, as far as a measurement tells it from other delays.

use std::path::Path;

use haptic_servo::magnetic::{Chip, Transfers};
use haptic_servo::scene::TimeRange;

use super::device_file::Number;
use super::{Arguments, PERIOD};
use crate::command::status::CommandError;
use crate::file::{self, DeviceFile};
use crate::identify::{Estimate, Latency};
use crate::quantity::significant;

/// The delays that are known without the record, and the age of its readings among them.
#[derive(Clone, Copy, Debug, Default)]
pub struct KnownDelays {
    /// The age in s that a file states of its encoder, or of its chip.
    stated: Option<TimeRange>,
    /// The age in s of all chips of the kind that a file states.
    of_chip: Option<TimeRange>,
    /// Time in s by which the filters that a file states of its encoder may make a reading later than its age.
    filtered: f64,
    /// Longest time constant in s of the filter among them that counts as a lag, like the amplifier's.
    sensor_lag: f64,
    /// The delay of the torque in s, if it is declared, so that the age is what remains.
    torque_delay: Option<f64>,
    /// The age in s that is declared, so that a delay of the torque is what remains.
    count_delay: f64,
}

impl KnownDelays {
    /// Those of a command: of the file that it writes, or of the simulated one.
    pub fn of(arguments: &Arguments) -> Result<Self, CommandError> {
        let super::Reading { torque_delay, count_delay, .. } = arguments.reading;
        let declared = Self { torque_delay, count_delay, ..Self::default() };
        let written = arguments.output.as_deref().filter(|path| path.exists());
        // A new file has the encoder of the simulated one.
        let Some(path) = written.or(arguments.simulated()) else { return Ok(declared) };
        let device = file::load_device(&path.to_string_lossy())?;
        let of_chip = age_of_chip(&device);
        Ok(Self {
            stated: age_of(&device),
            of_chip,
            filtered: 0.5 * device.reading.window + device.sensor_lag.most,
            sensor_lag: device.sensor_lag.most,
            ..declared
        })
    }

    /// The age for a file.
    pub fn number(&self, latency: &Latency) -> Number {
        let comment = match self.torque_delay {
            Some(declared) if declared > 0.0 => format!(
                "at 95 %, without the declared {} s of the torque: add them if it is as late in a scene",
                significant(declared, 3)
            ),
            _ => "at 95 %, with any delay of the torque".to_owned(),
        };
        number(self.age_in_file(latency), &comment)
    }

    /// The range of the age in s for a file. A delay of the torque after its instant counts as an age, because for a
    /// certificate both are the same, and the instant itself is a program's. A chip's age is that of all of its kind,
    /// of which this one may be the youngest.
    fn age_in_file(&self, latency: &Latency) -> TimeRange {
        let [lo, hi] = latency.delay_range();
        let [least, most] =
            [(lo + self.count_delay - self.filtered).max(0.0), hi + self.count_delay];
        match (self.of_chip, self.torque_delay) {
            (None, _) => TimeRange::between(least, most),
            (Some(chip), Some(_)) => TimeRange::between(chip.least, chip.most.max(most)),
            (Some(chip), None) => {
                TimeRange::between(chip.least, chip.most + (most - chip.least).max(0.0))
            }
        }
    }

    /// The range of the amplifier's lag in s for a file: the measured one has the lag of the encoder in it.
    pub fn actuator_lag(&self, latency: &Latency) -> [f64; 2] {
        let [lo, hi] = latency.lag_range();
        [(lo - self.sensor_lag).max(0.0), hi]
    }

    /// The age in s, where it was measured.
    pub fn age(&self, latency: &Latency) -> Option<Estimate> {
        let Estimate { hi, .. } = latency.output_delay;
        let is_measured = self.torque_delay.is_some() && self.count_delay == 0.0 && hi > 0.0;
        is_measured.then_some(latency.output_delay)
    }

    /// The text of a report, where there is something to say.
    pub fn row(&self, latency: &Latency) -> Option<String> {
        let age = &latency.output_delay;
        if self.count_delay > 0.0 {
            return None;
        }
        if self.torque_delay.is_some() {
            return Some(format!(
                "{}: the delay beyond that of the torque",
                compared(age, self.stated)
            ));
        }
        let stated = self.stated?;
        let [least, most] = [stated.least, stated.most].map(|time| significant(time, 3));
        let [lo, hi] = latency.delay_range().map(|time| significant(time, 3));
        if age.hi < stated.least {
            return Some(format!(
                "{least} to {most} s in the file, which contradicts the delay: with that of the torque it is only \
                 {lo} to {hi} s"
            ));
        }
        Some(format!(
            "{least} to {most} s in the file; sines do not tell it from a delay of the torque, and for a certificate \
             both are the same: with it, it is {lo} to {hi} s. With --torque-delay, where that is known, the age is \
             measured"
        ))
    }
}

/// The age in s that a file states of its encoder: in the table, or by the chip.
fn age_of(device: &DeviceFile) -> Option<TimeRange> {
    let age = device.reading.age;
    if age.is_zero() { age_of_chip(device) } else { Some(age) }
}

/// The age in s of all chips of a file's kind, at the period of the measurement.
fn age_of_chip(device: &DeviceFile) -> Option<TimeRange> {
    device.chip.map(|chip| chip.age_in(&Transfers::at_count(chip, PERIOD)))
}

/// The chip of a file's encoder, and the age that the file states of it.
pub fn chip_and_age(
    path: &Path,
) -> Result<(Option<&'static Chip>, Option<TimeRange>), CommandError> {
    let device = file::load_device(&path.to_string_lossy())?;
    Ok((device.chip, age_of(&device)))
}

/// An age in s for a file, rounded outwards: no reading is younger than its time.
pub fn number(age: TimeRange, comment: &str) -> Number {
    let lo = significant(age.least.max(0.0) * (1.0 - 5e-3), 3);
    let lo = if lo == "0" { "0.0" } else { &lo };
    let hi = significant(age.most * (1.0 + 5e-3), 3);
    let comment = format!("s, {comment}");
    Number { table: "encoder", key: "age", value: format!("[{lo}, {hi}]"), comment }
}

/// A measured age beside the age that a file states.
pub fn compared(age: &Estimate, stated: Option<TimeRange>) -> String {
    let [lo, hi] = [age.lo, age.hi].map(|time| significant(time, 3));
    let Some(stated) = stated else { return format!("{lo} to {hi} s") };
    let [least, most] = [stated.least, stated.most].map(|time| significant(time, 3));
    let verdict = match () {
        () if stated.least <= age.lo && age.hi <= stated.most => "within",
        () if age.hi < stated.least || stated.most < age.lo => "which contradicts",
        () => "which overlaps",
    };
    format!("{lo} to {hi} s, {verdict} the {least} to {most} s that the file states")
}
