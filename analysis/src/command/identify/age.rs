//! The age of an encoder's readings, as far as a measurement tells it from other delays.

use std::path::Path;

use haptic_servo::magnetic::{Chip, Transfers};
use haptic_servo::scene::TimeRange;

use super::device_file::Number;
use super::{Arguments, PERIOD};
use crate::command::status::CommandError;
use crate::file;
use crate::identify::{Estimate, Latency};
use crate::quantity::significant;

/// The delays that are known without the record.
#[derive(Clone, Copy, Debug, Default)]
pub struct KnownDelays {
    /// The age in s that a file states of its encoder, or of its chip.
    stated: Option<TimeRange>,
    /// The delay of the torque in s, if it is declared, so that the age is what remains.
    torque_delay: Option<f64>,
    /// Whether the age is declared, so that the output's delay is what remains.
    is_age_known: bool,
    /// Whether the file that is written has a chip, whose age is that of all of its kind.
    has_chip: bool,
}

impl KnownDelays {
    /// Those of a command: of the file that it writes, or of the simulated one.
    pub fn of(arguments: &Arguments) -> Result<Self, CommandError> {
        let written = arguments.output.as_deref().filter(|path| path.exists());
        // A new file has the encoder of the simulated one.
        let path = written.or(arguments.simulated());
        let (chip, stated) = path.map(chip_and_age).transpose()?.unwrap_or_default();
        Ok(Self {
            stated,
            has_chip: chip.is_some(),
            torque_delay: stated.and(arguments.reading.torque_delay),
            is_age_known: arguments.reading.count_delay > 0.0,
        })
    }

    /// Whether an age may be written: one within the range of a chip is refused, as another chip of its kind may have
    /// any.
    pub fn is_age_free(&self) -> bool {
        !self.has_chip
    }

    /// The part of a delay that is the output's, as a range in s: what was declared, or without the stated age.
    pub fn output_delay(&self, latency: &Latency) -> [f64; 2] {
        let [lo, hi] = latency.delay_range();
        match (self.stated, self.torque_delay) {
            _ if self.is_age_known => [lo, hi],
            (_, Some(declared)) => [declared; 2],
            (Some(age), None) => [(lo - age.most).max(0.0), (hi - age.least).max(0.0)],
            (None, None) => [lo, hi],
        }
    }

    /// The age in s, where it was measured.
    pub fn age(&self, latency: &Latency) -> Option<Estimate> {
        let Estimate { hi, .. } = latency.output_delay;
        let is_measured = self.torque_delay.is_some() && !self.is_age_known && hi > 0.0;
        is_measured.then_some(latency.output_delay)
    }

    /// The text of a report, where there is something to say.
    pub fn row(&self, latency: &Latency) -> Option<String> {
        let age = &latency.output_delay;
        if self.is_age_known {
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
                "{least} to {most} s in the file, which contradicts the delay: with the output's delay it is \
                 only {lo} to {hi} s"
            ));
        }
        let [from, to] = self.output_delay(latency).map(|time| significant(time, 3));
        Some(format!(
            "{least} to {most} s in the file; sines do not tell it from the output's delay, which is {from} to {to} \
             s beside it. With --torque-delay, where that is known, the age is measured"
        ))
    }
}

/// The chip of a file's encoder, and the age that the file states of it: in the table, or by the chip.
pub fn chip_and_age(
    path: &Path,
) -> Result<(Option<&'static Chip>, Option<TimeRange>), CommandError> {
    let device = file::load_device(&path.to_string_lossy())?;
    let age = device.reading.age;
    let of_chip = device.chip.map(|chip| chip.age_in(&Transfers::at_count(chip, PERIOD)));
    Ok((device.chip, if age.is_zero() { of_chip } else { Some(age) }))
}

/// An age for a file, rounded outwards: no reading is younger than its time.
pub fn number(age: &Estimate) -> Number {
    let lo = significant(age.lo.max(0.0) * (1.0 - 5e-3), 3);
    let lo = if lo == "0" { "0.0" } else { &lo };
    let hi = significant(age.hi * (1.0 + 5e-3), 3);
    let comment = "s, at 95 %".into();
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
