//! `haptic chart budget`: the energy that a hand takes from a hostile host, with its tank and without.

use clap::Args;
use haptic_model::host::HostLaw;

use super::output::OutputArguments;
use crate::chart::Chart;
use crate::command::run;
use crate::command::status::CommandError;
use crate::quantity::shortened;

#[derive(Debug, Args)]
pub struct Arguments {
    /// Scene file with a table `host`, `-` is standard input; or name of a program that takes a host's torques
    #[arg(value_name = "SCENE")]
    pub scene: String,
    /// What the host sends: pump, noise, late-spring, square
    #[arg(long, value_name = "LAW", default_value_t = HostLaw::Pump)]
    pub host: HostLaw,
    #[command(flatten)]
    pub output: OutputArguments,
}

/// Runs the scene twice and draws the energies.
pub fn draw(arguments: &Arguments) -> Result<Chart, CommandError> {
    let Arguments { scene, host, .. } = arguments;
    let (name, runs) = run::beside_host(scene, *host)?;
    let title = format!("{}: energy taken from the host {host}", shortened(&name, 40));
    Ok(Chart { picture: runs.draw(&title)?, data: runs.data() })
}
