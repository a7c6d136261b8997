//! `haptic device`: the passivity of a device.

use clap::Args;
use serde::Serialize;

use super::shared_arguments::JsonOption;
use super::status::{CommandError, CommandStatus};
use crate::chain::{Chain, ExcessPassivity, NoPassivity, Reached};
use crate::file::{self, DeviceFile};
use crate::mu_analysis::Check;
use crate::quantity::{rounded_down, significant};

#[derive(Debug, Args)]
pub struct Arguments {
    /// Scene file, or a file with a table `device` alone; TOML or JSON; `-` is standard input
    #[arg(value_name = "FILE")]
    pub file: String,
    #[command(flatten)]
    pub answer: JsonOption,
}

#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Report {
    pub name: Option<String>,
    /// Output strict passivity in N m s/rad, to the last digit; `None` if the device is not passive.
    pub delta: Option<f64>,
    pub delta_lo: Option<f64>,
    pub delta_hi: Option<f64>,
    /// Angular frequency in rad/s at which it is reached; 0 in the limit at rest, or if it does not depend on
    /// the frequency; `None` in the limit of infinite frequency.
    pub omega: Option<f64>,
    /// `everywhere`, `rest`, `omega` or `infinity`; `None` without a `delta`.
    pub reached: Option<&'static str>,
    /// Whether encoder and motor are on the same mass.
    pub collocated: bool,
    pub masses: usize,
    /// Inertia in kg m^2 of all masses together.
    pub inertia: f64,
    /// Damping in N m s/rad of all masses together to the ground.
    pub damping: f64,
    /// Time constant of the amplifier in s.
    pub actuator_lag: f64,
    /// The paper's construction compared with `delta`; `None` without a `delta` above 0.
    pub mu: Option<Check>,
    pub message: String,
}

/// Runs the command; the status is negative if the device has no passivity.
pub fn run(arguments: &Arguments) -> Result<CommandStatus, CommandError> {
    let report = report(&file::load_device(&arguments.file)?);
    arguments.answer.print(&report, text)?;
    Ok(CommandStatus::of(report.delta.is_some()))
}

/// The data of the device of a file.
pub fn report(file: &DeviceFile) -> Report {
    let chain = &file.chain;
    let found = chain.excess_passivity();
    let delta = found.ok().map(|found| found.delta);
    let reached = found.ok().map(|found| found.reached);
    Report {
        name: file.name.clone(),
        delta: found.ok().map(|found| found.value),
        delta_lo: delta.map(|delta| delta.lo()),
        delta_hi: delta.map(|delta| delta.hi()),
        omega: reached.and_then(Reached::omega),
        reached: reached.map(word),
        collocated: chain.is_collocated(),
        masses: chain.masses().len(),
        inertia: chain.inertia(),
        damping: chain.damping(),
        actuator_lag: chain.actuator_lag(),
        mu: found.ok().and_then(|found| Check::of(chain, &found)),
        message: message(chain, &found),
    }
}

fn word(reached: Reached) -> &'static str {
    match reached {
        Reached::Everywhere => "everywhere",
        Reached::AtRest => "rest",
        Reached::At(_) => "omega",
        Reached::AtInfinity => "infinity",
    }
}

fn message(chain: &Chain, found: &Result<ExcessPassivity, NoPassivity>) -> String {
    let found = match found {
        Ok(found) => found,
        Err(reason) => return format!("no passivity: {reason}{}", without_lag(chain)),
    };
    let delta = rounded_down(found.value, 12);
    let place = match found.reached {
        Reached::Everywhere => "at every frequency".to_owned(),
        Reached::AtRest => "towards frequency 0".to_owned(),
        Reached::At(omega) => {
            let hertz = significant(omega / std::f64::consts::TAU, 4);
            format!("at {} rad/s ({hertz} Hz)", significant(omega, 6))
        }
        Reached::AtInfinity => "towards infinite frequency".to_owned(),
    };
    let own = significant(chain.masses().first().map_or(0.0, |motor| motor.damping), 6);
    match chain.masses().len() {
        1 => format!("delta = {delta} N m s/rad, the damping of the one mass"),
        _ => format!(
            "delta = {delta} N m s/rad, reached {place}; {own} of it is the damping of the \
             motor's mass"
        ),
    }
}

/// The text on the certificate of a device whose amplifier lags.
fn without_lag(chain: &Chain) -> String {
    match chain.clone().without_lag().excess_passivity() {
        Ok(found) if chain.actuator_lag() > 0.0 => format!(
            "; without it delta is {} N m s/rad, which a certificate takes, with the lag as a part of \
             the controller",
            rounded_down(found.value, 12)
        ),
        _ => String::new(),
    }
}

pub fn text(report: &Report) -> String {
    let mut rows = Vec::new();
    if let Some(name) = &report.name {
        rows.push(("device of", name.clone()));
    }
    rows.push(("", report.message.clone()));
    if let (Some(lo), Some(hi)) = (report.delta_lo, report.delta_hi) {
        rows.push(("delta", format!("{lo} to {hi} N m s/rad")));
    }
    rows.push(("masses", report.masses.to_string()));
    rows.push(("inertia", format!("{} kg m^2 in all", significant(report.inertia, 6))));
    rows.push((
        "damping",
        format!("{} N m s/rad to ground in all", significant(report.damping, 6)),
    ));
    rows.push(("collocated", if report.collocated { "yes" } else { "no" }.to_owned()));
    if let Some(Check { omega, at_delta, above, by }) = report.mu {
        let [at_delta, above] = [at_delta, above].map(|mu| significant(mu, 8));
        let (omega, more) = (significant(omega, 4), significant(1.0 + by, 4));
        rows.push((
            "mu",
            format!("{at_delta} up to delta, {above} with {more} delta, at {omega} rad/s"),
        ));
    }
    if report.actuator_lag > 0.0 {
        rows.push(("amplifier's lag", format!("{} s", report.actuator_lag)));
    }
    rows.iter().map(|(label, value)| format!("{label:<18} {value}\n")).collect()
}
