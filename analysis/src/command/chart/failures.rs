//! `haptic chart failures`: the springs that methods of integration show as stable, and the springs that are
//! stable.

use clap::{Args, ValueEnum};

use super::output::OutputArguments;
use crate::chart::{self, Chart, Data};
use crate::command::status::CommandError;
use crate::simulation::method::Method;
use crate::studies::failures::region::{METHODS, Region};

/// Arguments of `haptic chart failures`.
#[derive(Debug, Args)]
pub struct Arguments {
    #[command(flatten)]
    #[allow(missing_docs)]
    pub output: OutputArguments,
}

/// Finds the limits and draws them.
pub fn draw() -> Result<Chart, CommandError> {
    let regions = Region::all()?;
    let picture = chart::failures::failures(&regions)?;
    let rows = regions.into_iter().flat_map(|region| {
        let Region { device, truth, certified, apparent } = region;
        METHODS.into_iter().zip(apparent).flat_map(move |(method, points)| {
            points.into_iter().map(move |(steps, stiffness)| {
                vec![
                    device.into(),
                    word(method).as_str().into(),
                    steps.into(),
                    stiffness.into(),
                    truth.into(),
                    certified.into(),
                ]
            })
        })
    });
    let header = &[
        "device",
        "method",
        "steps a tick",
        "apparent limit (N m/rad)",
        "limit (N m/rad)",
        "certified (N m/rad)",
    ];
    Ok(Chart { picture, data: Data::new(header, rows) })
}

/// The method's name on the command line.
fn word(method: Method) -> String {
    method.to_possible_value().map(|value| value.get_name().to_owned()).unwrap_or_default()
}
