//! `haptic chart`: pictures of scenes, one module each.

pub mod bode;
pub mod failures;
pub mod identify;
pub mod limits;
pub mod map;
pub mod nyquist;
pub mod trace;
pub mod tradeoff;

use std::ops::Range;
use std::path::{Path, PathBuf};

use clap::{Args, Subcommand};

use super::{Answer, CommandError};
use crate::chart::{Chart, ChartError, Output, Window, is_range};

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

/// Where a picture goes, and its numbers.
#[derive(Debug, Args)]
pub struct OutputArguments {
    /// The picture's file, .svg, .png or .pdf; or .csv for the numbers that are drawn alone
    #[arg(short, long, value_name = "PICTURE")]
    pub output: PathBuf,
    /// Write the numbers that are drawn to this .csv, beside the picture
    #[arg(long, value_name = "FILE.csv")]
    pub csv: Option<PathBuf>,
}

/// Ranges of the axes.
#[derive(Debug, Args)]
pub struct WindowArguments {
    /// Ends of the horizontal axis, in its unit; otherwise all that there is to see
    #[arg(long, value_name = "MIN..MAX", value_parser = range, allow_hyphen_values = true)]
    pub x: Option<Range<f64>>,
    /// Ends of the vertical axis, in its unit
    #[arg(long, value_name = "MIN..MAX", value_parser = range, allow_hyphen_values = true)]
    pub y: Option<Range<f64>>,
}

impl WindowArguments {
    fn window(&self) -> Window {
        Window { x: self.x.clone(), y: self.y.clone() }
    }
}

/// Files whose names say what is in them.
#[derive(Debug)]
pub struct Files {
    picture: Option<Output>,
    data: Option<PathBuf>,
}

impl OutputArguments {
    /// Looks at the names of the files, so that nobody waits for a picture that cannot be kept.
    fn files(&self) -> Result<Files, ChartError> {
        let is_data = |path: &Path| path.extension().is_some_and(|e| e.eq_ignore_ascii_case("csv"));
        match &self.csv {
            Some(path) if !is_data(path) => Err(ChartError::DataExtension { path: path.clone() }),
            Some(path) if is_data(&self.output) => {
                Err(ChartError::TwoTables { output: self.output.clone(), csv: path.clone() })
            }
            None if is_data(&self.output) => {
                Ok(Files { picture: None, data: Some(self.output.clone()) })
            }
            data => Ok(Files { picture: Some(Output::new(&self.output)?), data: data.clone() }),
        }
    }
}

impl Files {
    /// Writes what is asked for of a chart.
    fn write(&self, Chart { picture, data }: Chart) -> Result<(), ChartError> {
        if let Some(output) = &self.picture {
            output.write(&picture)?;
        }
        self.data.as_ref().map_or(Ok(()), |path| data.write(path))
    }
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
pub fn run(arguments: &Arguments) -> Result<Answer, CommandError> {
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
    Ok(Answer::Yes)
}

fn number(text: &str) -> Result<f64, String> {
    let value: f64 = text.trim().parse().map_err(|_| format!("`{text}` is not a number"))?;
    if value.is_finite() { Ok(value) } else { Err(format!("`{text}` is not finite")) }
}

/// Two numbers with `..` between them, or with a colon.
fn range(text: &str) -> Result<Range<f64>, String> {
    /// The least width over the larger end: numbers along an axis must be told apart.
    const NARROWEST: f64 = 1e-9;
    let between = || text.split_once("..").or_else(|| text.split_once(':'));
    let (from, to) = between().ok_or("it must be two numbers with .. between")?;
    let range = number(from)?..number(to)?;
    let largest = range.start.abs().max(range.end.abs());
    if range.start >= range.end {
        Err(format!("{} must be less than {}", range.start, range.end))
    } else if !is_range(&range) || range.end - range.start < NARROWEST * largest {
        let (start, end) = (range.start, range.end);
        Err(format!("from {start:e} to {end:e} is not a range that an axis can show"))
    } else {
        Ok(range)
    }
}

/// A range of an axis that is logarithmic.
fn positive_range(text: &str) -> Result<Range<f64>, String> {
    let range = range(text)?;
    if range.start > 0.0 { Ok(range) } else { Err(format!("{} must be above 0", range.start)) }
}
