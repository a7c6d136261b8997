//! `haptic chart`: pictures of scenes, one module each.

pub mod failures;
pub mod identify;
pub mod limits;
pub mod map;
pub mod nyquist;
pub mod trace;
pub mod tradeoff;

use std::ops::Range;
use std::path::PathBuf;

use clap::{Args, Subcommand};

use super::{Answer, CommandError};
use crate::chart::Output;

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
    /// The curves of (T z/(z-1)) E(z) of one or more scenes, with the line -delta
    Nyquist(nyquist::Arguments),
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

/// Where a picture goes.
#[derive(Debug, Args)]
pub struct OutputArguments {
    /// The picture's file, .svg or .png
    #[arg(short, long, value_name = "PICTURE")]
    pub output: PathBuf,
}

impl Single {
    fn output(&self) -> &OutputArguments {
        match self {
            Self::Nyquist(arguments) => &arguments.output,
            Self::Map(arguments) => &arguments.output,
            Self::Limits(arguments) => &arguments.output,
            Self::Trace(arguments) => &arguments.output,
            Self::Identify(arguments) => &arguments.output,
            Self::Failures(arguments) => &arguments.output,
        }
    }
}

/// Draws the picture and writes it. The name of its file is looked at first, so that nobody waits
/// for a picture that cannot be kept.
pub fn run(arguments: &Arguments) -> Result<Answer, CommandError> {
    let kind = match &arguments.kind {
        Kind::Single(kind) => kind,
        Kind::Tradeoff(arguments) => return tradeoff::run(arguments),
    };
    let output = Output::new(&kind.output().output)?;
    let picture = match kind {
        Single::Nyquist(arguments) => nyquist::draw(arguments)?,
        Single::Map(arguments) => map::draw(arguments)?,
        Single::Limits(arguments) => limits::draw(arguments)?,
        Single::Trace(arguments) => return trace::run(arguments, &output),
        Single::Identify(arguments) => identify::draw(arguments)?,
        Single::Failures(_) => failures::draw()?,
    };
    output.write(&picture)?;
    Ok(Answer::Yes)
}

fn number(text: &str) -> Result<f64, String> {
    let value: f64 = text.trim().parse().map_err(|_| format!("`{text}` is not a number"))?;
    if value.is_finite() { Ok(value) } else { Err(format!("`{text}` is not finite")) }
}

fn range(text: &str) -> Result<Range<f64>, String> {
    let (from, to) = text.split_once(':').ok_or("it must be two numbers with a colon between")?;
    let range = number(from)?..number(to)?;
    if range.start < range.end {
        Ok(range)
    } else {
        Err(format!("{} must be less than {}", range.start, range.end))
    }
}
