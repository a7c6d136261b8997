//! `haptic chart bode`: the open loop of device and controller over frequency.

use std::io::Write;
use std::ops::Range;

use clap::Args;

use super::output::OutputArguments;
use crate::chart::{self, Chart, Window};
use crate::command::status::CommandError;
use crate::command::value_parsers::positive_range;
use crate::file::{self, Purpose};
use crate::open_loop::OpenLoop;
use crate::simulation::Experiment;

#[derive(Debug, Args)]
pub struct Arguments {
    /// Scene files, TOML or JSON; `-` is standard input
    #[arg(value_name = "FILE", required = true, num_args = 1..=6)]
    pub files: Vec<String>,
    /// Range of the frequency in Hz, the horizontal axis
    #[arg(long, value_name = "MIN..MAX", value_parser = positive_range, allow_hyphen_values = true)]
    pub x: Option<Range<f64>>,
    /// Range of the gain, the vertical axis of the upper panel
    #[arg(long, value_name = "MIN..MAX", value_parser = positive_range, allow_hyphen_values = true)]
    pub y: Option<Range<f64>>,
    /// Title of the chart; default: the name of the scene
    #[arg(long)]
    pub title: Option<String>,
    #[command(flatten)]
    pub output: OutputArguments,
}

/// Draws the loops, each on the device and in the hand of its file, and prints their margins.
pub fn draw(arguments: &Arguments) -> Result<Chart, CommandError> {
    let mut loops = Vec::new();
    for name in &arguments.files {
        let file = file::load_for(Purpose::Simulate, name)?;
        let hand = if file.hand.is_some() { "in its hand" } else { "in no hand" };
        loops.push((format!("{}, {hand}", file.name), OpenLoop::of(&Experiment::at_rest(&file))?));
    }
    let title = match (&arguments.title, &loops[..]) {
        (Some(title), _) => title.clone(),
        (None, [(name, _)]) => format!("Open loop: {name}"),
        _ => "Open loop of device and controller".to_owned(),
    };
    let window = Window { x: arguments.x.clone(), y: arguments.y.clone() };
    let picture = chart::bode::bode(&title, &loops, &window)?;
    let mut out = std::io::stdout().lock();
    for line in chart::bode::words(&loops) {
        writeln!(out, "{line}")?;
    }
    Ok(Chart { picture, data: chart::bode::data(loops) })
}
