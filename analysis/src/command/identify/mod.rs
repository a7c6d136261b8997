//! `haptic identify`: a device's inertia, damping and passivity from a measurement.

mod port;
pub mod target;

use std::io;
use std::path::{Path, PathBuf};

use clap::Args;
use serde::Serialize;

use super::shared_arguments::JsonOption;
use super::status::{CommandError, CommandStatus};
use super::value_parsers::{bounded, not_negative, positive};
use crate::identify::{self, Correction, Disk, Estimate, Identification, Record};
use crate::link::Address;
use crate::quantity::significant;
use target::Origin;

/// Arguments of `haptic identify`.
#[derive(Debug, Args)]
pub struct Arguments {
    /// Record of stepped sines: CSV with the columns `time` in s, `torque` in N m, `counts`, and
    /// optionally `frequency` in Hz; `-` is standard input. With --target: scene file, or a file
    /// with a table `device` alone
    #[arg(value_name = "FILE", required_unless_present_any = ["target", "port"])]
    pub file: Option<PathBuf>,
    /// Encoder counts per turn; default with --target: 61440, with --port: those of the board
    #[arg(long, value_name = "N", value_parser = positive,
          required_unless_present_any = ["target", "port"], allow_negative_numbers = true)]
    pub counts_per_rev: Option<f64>,
    /// Measure with the board at this address, which runs the program `identify`: /dev/ttyACM0
    /// (@BAUD), tcp://HOST:PORT, unix:PATH. The motor moves the device; nobody may hold it
    #[arg(long, value_name = "PORT", group = "measured", conflicts_with = "file")]
    pub port: Option<Address>,
    /// Write the record to this file, with --port or --target
    #[arg(long, value_name = "FILE.csv", requires = "measured")]
    pub record: Option<PathBuf>,
    #[command(flatten)]
    #[allow(missing_docs)]
    pub reading: Reading,
    #[command(flatten)]
    #[allow(missing_docs)]
    pub answer: JsonOption,
    /// Write the table `device` of a scene file to this file
    #[arg(short, long, value_name = "FILE.toml")]
    pub output: Option<PathBuf>,
    #[command(flatten)]
    #[allow(missing_docs)]
    pub target: target::Simulated,
}

/// How a record is read.
#[derive(Debug, Args)]
pub struct Reading {
    /// Time from the time stamp of a row until its torque is applied, in s
    #[arg(long, value_name = "S", default_value_t = 0.0, value_parser = not_negative,
          allow_negative_numbers = true)]
    pub torque_delay: f64,
    /// Age of the counts of a row at its time stamp, in s
    #[arg(long, value_name = "S", default_value_t = 0.0, value_parser = not_negative,
          allow_negative_numbers = true)]
    pub count_delay: f64,
    /// Fraction of each sine to skip while the device settles, 0 to 0.9; default: 0.25, with
    /// --target: 0, because the record starts after the settling
    #[arg(long, value_name = "PART", value_parser = part, allow_negative_numbers = true)]
    pub settle: Option<f64>,
}

impl Reading {
    /// The stated corrections of the measurement, with `settle` as the default.
    fn correction(&self, counts_per_turn: f64, settle: f64) -> Correction {
        Correction {
            torque_delay: self.torque_delay,
            count_delay: self.count_delay,
            settle: self.settle.unwrap_or(settle),
            ..Correction::of_encoder(counts_per_turn)
        }
    }
}

/// Part of a sine that is left out where nothing is said.
const SETTLE: f64 = 0.25;

/// A response as programs read it.
#[derive(Debug, Serialize)]
struct Point {
    /// Hz.
    frequency: f64,
    /// Real part of `J` in rad/(N m s).
    re: f64,
    /// Imaginary part.
    im: f64,
    /// Real part of `1/J` in N m s/rad.
    impedance_re: f64,
    /// Imaginary part.
    impedance_im: f64,
    /// Standard deviation of both parts of `1/J`.
    deviation: f64,
}

/// An identification as programs read it.
#[derive(Debug, Serialize)]
struct Report<'a> {
    inertia: Estimate,
    damping: Estimate,
    skew: Estimate,
    skew_significant: bool,
    bias: f64,
    disk: Disk,
    misfit: f64,
    rigid: bool,
    passivity: Option<f64>,
    confidence: f64,
    measured: Option<&'a Origin>,
    responses: Vec<Point>,
    notes: &'a [String],
}

/// Answers with the device; no if it has no passivity that could be certified with, or if a code of
/// the emulated board differs from this machine's.
pub fn run(arguments: &Arguments) -> Result<CommandStatus, CommandError> {
    let (record, origin, counts_per_turn) = record(arguments)?;
    let settle = if origin.is_some() { 0.0 } else { SETTLE };
    let correction = arguments.reading.correction(counts_per_turn, settle);
    let found = identify::identify(&record, &correction)?;
    let notes = notes(&found);
    if let Some(path) = &arguments.output {
        let unwritable = |source| CommandError::Unwritable { path: path.clone(), source };
        std::fs::write(path, device_table(&found)).map_err(unwritable)?;
    }
    let report = report(&found, &notes, origin.as_ref());
    arguments.answer.print(&report, |_| text(&found, &notes, origin.as_ref()))?;
    let differs = origin.and_then(|origin| origin.difference);
    if let Some(difference) = differs {
        eprintln!("{difference}");
    }
    Ok(if found.passivity().is_some() && differs.is_none() {
        CommandStatus::Success
    } else {
        CommandStatus::NegativeVerdict
    })
}

/// The record of a file, or one that is made, and the counts in a turn.
fn record(arguments: &Arguments) -> Result<(Record, Option<Origin>, f64), CommandError> {
    let (file, stated) = (arguments.file.as_deref(), arguments.counts_per_rev);
    let counts_per_turn = stated.unwrap_or(target::COUNTS_PER_TURN);
    let keep = arguments.record.as_deref();
    if let Some(address) = &arguments.port {
        let (record, counts) = port::measure(address, keep)?;
        return Ok((record, None, stated.unwrap_or(counts)));
    }
    if let Some(target) = arguments.target.target {
        let simulated = &arguments.target;
        let (measured, origin) = target::measure(simulated, target, file, keep, counts_per_turn)?;
        return Ok((measured.record, Some(origin), counts_per_turn));
    }
    Ok((load(file.unwrap_or(Path::new("-")))?, None, counts_per_turn))
}

/// Identifies the device of a recorded file.
pub fn of_file(
    file: &Path,
    counts_per_turn: f64,
    reading: &Reading,
) -> Result<Identification, CommandError> {
    Ok(identify::identify(&load(file)?, &reading.correction(counts_per_turn, SETTLE))?)
}

/// A record from a file or, as `-`, from standard input.
fn load(file: &Path) -> Result<Record, CommandError> {
    let record = match file == Path::new("-") {
        true => identify::record::parse("<stdin>", io::stdin().lock()),
        false => identify::record::load(file),
    };
    Ok(record.map_err(identify::IdentifyError::from)?)
}

fn report<'a>(
    found: &Identification,
    notes: &'a [String],
    measured: Option<&'a Origin>,
) -> Report<'a> {
    let point = |r: &identify::Response| Point {
        frequency: r.omega / std::f64::consts::TAU,
        re: r.admittance.re,
        im: r.admittance.im,
        impedance_re: r.impedance().re,
        impedance_im: r.impedance().im,
        deviation: r.deviation,
    };
    Report {
        inertia: found.inertia,
        damping: found.damping,
        skew: found.mean_delay,
        skew_significant: found.mean_delay.is_significant(),
        bias: found.bias,
        disk: found.disk,
        misfit: found.misfit,
        rigid: found.is_rigid(),
        passivity: found.passivity(),
        confidence: identify::fit::CONFIDENCE,
        measured,
        responses: found.responses.iter().map(point).collect(),
        notes,
    }
}

/// Warnings about the identified numbers.
fn notes(found: &Identification) -> Vec<String> {
    let mut notes: Vec<String> = found.left_out.iter().map(ToString::to_string).collect();
    if found.mean_delay.is_significant() {
        notes.push(format!(
            "the counts are {} us late against the torque: uncorrected, the damping would be {} N \
             m s/rad at {} Hz; inertia and damping are corrected for it. If the amplifier lags, \
             and not the record, account for the lag as delay",
            significant(1e6 * found.mean_delay.value, 3),
            significant(found.disk.delta, 3),
            significant(found.disk.omega / std::f64::consts::TAU, 3),
        ));
    }
    if !found.is_rigid() {
        notes.push(format!(
            "inertia and damping do not explain the responses (residuals {} times the noise): the \
             device is not one rigid mass. Its passivity in a hand cannot be measured at the motor \
             alone, because a hand that holds the far end takes the damping of that end away. \
             Describe it as masses and links, and use `haptic device`",
            significant(found.misfit.sqrt(), 2),
        ));
    }
    if found.disk.delta <= 0.0 || found.is_rigid() && found.passivity().is_none() {
        notes.push(format!(
            "the device has no passivity: Re(1/J) is {} N m s/rad at {} Hz. Check the sign of \
             torque and counts, the declared delays, and that motor and encoder are on the same \
             mass",
            significant(found.disk.delta, 3),
            significant(found.disk.omega / std::f64::consts::TAU, 3),
        ));
    }
    notes
}

/// The table for a scene file.
pub fn device_table(found: &Identification) -> String {
    let range = |e: &Estimate| format!("{} to {}", significant(e.lo, 4), significant(e.hi, 4));
    let passivity = match found.passivity() {
        Some(passivity) => format!(
            "passivity = {} # N m s/rad, lower end of the damping; valid if the device is rigid \
             from motor to hand\n",
            significant(passivity, 4),
        ),
        None => "# passivity: none; do not certify with this device\n".to_owned(),
    };
    format!(
        "[device]\ninertia = {} # kg m^2, {} at 95 %\ndamping = {} # N m s/rad, {} at 95 %\n\
         {passivity}",
        significant(found.inertia.value, 5),
        range(&found.inertia),
        significant(found.damping.value.max(0.0), 5),
        range(&found.damping),
    )
}

fn text(found: &Identification, notes: &[String], origin: Option<&Origin>) -> String {
    let estimate = |e: &Estimate, unit: &str| {
        let reach = significant(0.5 * (e.hi - e.lo), 2);
        format!("{} +- {reach} {unit}", significant(e.value, 5))
    };
    let hertz = |omega: f64| significant(omega / std::f64::consts::TAU, 4);
    let disk = match found.disk.delta {
        delta if delta > 0.0 => format!(
            "delta {} N m s/rad at {} Hz, radius {} rad/(N m s)",
            significant(delta, 5),
            hertz(found.disk.omega),
            significant(0.5 / delta, 4)
        ),
        _ => "none: some response is outside of every disk".to_owned(),
    };
    let mut rows = vec![
        ("damping", estimate(&found.damping, "N m s/rad")),
        ("inertia", estimate(&found.inertia, "kg m^2")),
        ("skew", estimate(&found.mean_delay, "s")),
        ("disk", disk),
        ("residuals", format!("{} times the noise", significant(found.misfit.sqrt(), 2))),
    ];
    rows.extend(origin.map(Origin::row));
    rows.extend(notes.iter().map(|note| ("note", note.clone())));
    let rows: String = rows.iter().map(|(label, value)| format!("{label:<12} {value}\n")).collect();
    format!("{rows}\n{}\n{}", points(found), device_table(found))
}

fn points(found: &Identification) -> String {
    let mut table = comfy_table::Table::new();
    table.load_style(comfy_table::presets::NOTHING);
    table.set_header(["Hz", "Re 1/J, N m s/rad", "+-", "Im 1/J", "counts"]);
    for r in &found.responses {
        table.add_row([
            significant(r.omega / std::f64::consts::TAU, 4),
            significant(r.impedance().re, 4),
            significant(r.deviation, 2),
            significant(r.impedance().im, 4),
            significant(r.counts, 3),
        ]);
    }
    format!("{table}\n")
}

fn part(text: &str) -> Result<f64, String> {
    bounded(text, "a number from 0 to 0.9", |value| (0.0..=0.9).contains(&value))
}
