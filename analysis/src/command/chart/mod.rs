//! `haptic chart`: pictures of scenes, one module each.

pub mod bode;
pub mod failures;
pub mod identify;
pub mod limits;
pub mod map;
pub mod nyquist;
mod output;
pub mod trace;
pub mod tradeoff;

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

/// Which picture, or pictures.
#[derive(Debug, Subcommand)]
pub enum Kind {
    /// A picture that goes to one file.
    #[command(flatten)]
    Single(Single),
    /// Speed against accuracy of methods, measured: tables, pictures, and what nothing beats
    Tradeoff(tradeoff::Arguments),
}

/// Which picture.
#[derive(Debug, Subcommand)]
pub enum Single {
    /// Nyquist curves of what is judged of one or more scenes, with the critical line
    Nyquist(nyquist::Arguments),
    /// Gain and phase of the open loop of device and controller, with its margins
    Bode(bode::Arguments),
    /// What is certified, stable and unstable, over stiffness and damping of a scene's wall
    Map(map::Arguments),
    /// The largest certified stiffness over the sample rate, with the encoder's torque ripple
    Limits(limits::Arguments),
    /// What a scene's simulation or a recorded run does, with the ground shaded by what limits it
    Trace(trace::Arguments),
    /// The responses of a measured device in their disk, with the device that was fitted to them
    Identify(identify::Arguments),
    /// What methods of integration call stable, over the steps that they take in a tick
    Failures(failures::Arguments),
}

impl Single {
    fn output(&self) -> &OutputArguments {
        match self {
            Self::Nyquist(arguments) => &arguments.output,
            Self::Bode(arguments) => &arguments.output,
            Self::Map(arguments) => &arguments.output,
            Self::Limits(arguments) => &arguments.output,
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
        Single::Map(arguments) => map::draw(arguments)?,
        Single::Limits(arguments) => limits::draw(arguments)?,
        Single::Trace(arguments) => return trace::run(arguments, &files),
        Single::Identify(arguments) => identify::draw(arguments)?,
        Single::Failures(_) => failures::draw()?,
    };
    files.write(chart)?;
    Ok(CommandStatus::Success)
}
