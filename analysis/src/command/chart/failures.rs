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
        let points = METHODS.into_iter().zip(region.apparent.clone());
        let of_method = |(method, points): (Method, Vec<(f64, f64)>)| {
            points.into_iter().map(move |point| (method, point))
        };
        points.flat_map(of_method).map(move |(method, point)| (region.clone(), method, point))
    });
    let data = Data::of(
        rows,
        [
            ("device", |row| row.0.device.into()),
            ("method", |row| word(row.1).as_str().into()),
            ("steps a tick", |row| row.2.0.into()),
            ("apparent limit (N m/rad)", |row| row.2.1.into()),
            ("limit (N m/rad)", |row| row.0.truth.into()),
            ("certified (N m/rad)", |row| row.0.certified.into()),
        ],
    );
    Ok(Chart { picture, data })
}

/// The method's name on the command line.
fn word(method: Method) -> String {
    method.to_possible_value().map(|value| value.get_name().to_owned()).unwrap_or_default()
}
