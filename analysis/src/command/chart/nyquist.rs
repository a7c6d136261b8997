//! `haptic chart nyquist`: the Nyquist curves of environments, from velocity to torque.

use clap::Args;

use super::output::{OutputArguments, WindowArguments};
use crate::chart::{self, Chart};
use crate::command::status::CommandError;
use crate::file;
use crate::nominal_latency::titled;

#[derive(Debug, Args)]
pub struct Arguments {
    /// Scene files, TOML or JSON; `-` is standard input
    #[arg(value_name = "FILE", required = true, num_args = 1..=6)]
    pub files: Vec<String>,
    /// Title of the chart; default: the name of the scene
    #[arg(long)]
    pub title: Option<String>,
    #[command(flatten)]
    pub window: WindowArguments,
    #[command(flatten)]
    pub output: OutputArguments,
}

pub fn draw(arguments: &Arguments) -> Result<Chart, CommandError> {
    let files: Result<Vec<_>, _> = arguments.files.iter().map(|file| file::load(file)).collect();
    let scenes: Vec<_> = files?.into_iter().map(|file| (file.name, file.scene)).collect();
    let latencies = scenes.iter().map(|(_, scene)| &scene.latency);
    let title = match (&arguments.title, &scenes[..]) {
        (Some(title), _) => title.clone(),
        (None, [(name, _)]) => titled(name, latencies),
        _ => titled("From velocity to torque: (T z/(z-1)) E(z)", latencies),
    };
    let picture = chart::nyquist::nyquist(&title, &scenes, &arguments.window.window())?;
    Ok(Chart { picture, data: chart::nyquist::data(&scenes)? })
}
