//! `haptic chart`: pictures of scenes, one module each.

pub mod bode;
pub mod failures;
pub mod identify;
pub mod latency;
pub mod limits;
pub mod map;
pub mod nyquist;
mod output;
pub mod profile;
pub mod trace;
pub mod tradeoff;
pub mod turn;

use clap::{Args, Subcommand};

use super::status::{CommandError, CommandStatus};
use output::OutputArguments;

/// Arguments of `haptic chart`.
#[derive(Debug, Args)]
pub struct Arguments {
    /// Which picture.
    #[command(subcommand)]
    pub kind: Kind,
}

/// The kind of chart, or charts.
#[derive(Debug, Subcommand)]
pub enum Kind {
    /// A chart in one file.
    #[command(flatten)]
    Single(Single),
    /// Measure speed and accuracy of methods: tables, charts, Pareto fronts
    Tradeoff(tradeoff::Arguments),
}

/// Which picture.
#[derive(Debug, Subcommand)]
pub enum Single {
    /// Draw the Nyquist curves of one or more scenes, with the critical line at -delta
    Nyquist(nyquist::Arguments),
    /// Draw gain and phase of the open loop of device and controller, with the margins
    Bode(bode::Arguments),
    /// Draw torque and potential of a torque profile over angle, its steepest slopes, and the slope that
    /// still certifies
    Profile(profile::Arguments),
    /// Draw what a hand feels that turns a torque profile, by the codes of its servo
    Turn(turn::Arguments),
    /// Draw a map of certified, stable and unstable walls over stiffness and damping (Z-width), or of
    /// torque profiles over torque and repetitions in a turn
    Map(map::Arguments),
    /// Draw the largest certified stiffness over the sample rate, with the encoder's torque ripple
    Limits(limits::Arguments),
    /// Draw the largest spring behind current loops over the servo's rate, certified and assumed
    Latency(latency::Arguments),
    /// Draw angle, velocity and torque of a simulation or a recorded run, shaded where limited
    Trace(trace::Arguments),
    /// Draw the measured responses of a device in the disk of its passivity, with the fitted device
    Identify(identify::Arguments),
    /// Draw the stability limit of methods of integration over their steps in a tick
    Failures(failures::Arguments),
}

impl Single {
    fn output(&self) -> &OutputArguments {
        match self {
            Self::Nyquist(arguments) => &arguments.output,
            Self::Bode(arguments) => &arguments.output,
            Self::Profile(arguments) => &arguments.output,
            Self::Turn(arguments) => &arguments.output,
            Self::Map(arguments) => &arguments.output,
            Self::Limits(arguments) => &arguments.output,
            Self::Latency(arguments) => &arguments.output,
            Self::Trace(arguments) => &arguments.output,
            Self::Identify(arguments) => &arguments.output,
            Self::Failures(arguments) => &arguments.output,
        }
    }
}

/// Draws the picture and writes it.
pub fn run(arguments: &Arguments) -> Result<CommandStatus, CommandError> {
    let kind = match &arguments.kind {
        Kind::Single(kind) => kind,
        Kind::Tradeoff(arguments) => return tradeoff::run(arguments),
    };
    let files = kind.output().files()?;
    let chart = match kind {
        Single::Nyquist(arguments) => nyquist::draw(arguments)?,
        Single::Bode(arguments) => bode::draw(arguments)?,
        Single::Profile(arguments) => profile::draw(arguments)?,
        Single::Turn(arguments) => turn::draw(arguments)?,
        Single::Map(arguments) => map::draw(arguments)?,
        Single::Limits(arguments) => limits::draw(arguments)?,
        Single::Latency(arguments) => latency::draw(arguments)?,
        Single::Trace(arguments) => return trace::run(arguments, &files),
        Single::Identify(arguments) => identify::draw(arguments)?,
        Single::Failures(_) => failures::draw()?,
    };
    files.write(chart)?;
    Ok(CommandStatus::Success)
}
