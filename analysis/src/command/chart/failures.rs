//! `haptic chart failures`: the springs that methods of integration show as stable, and the springs that are
//! stable.

use clap::Args;

use super::output::OutputArguments;
use crate::chart::{self, Chart, Data};
use crate::command::status::CommandError;
use crate::studies::failures::region::{METHODS, Region};

#[derive(Debug, Args)]
pub struct Arguments {
    #[command(flatten)]
    pub output: OutputArguments,
}

pub fn draw() -> Result<Chart, CommandError> {
    let regions = Region::all()?;
    let picture = chart::failures::failures(&regions)?;
    let rows = regions.into_iter().flat_map(|Region { device, truth, certified, apparent }| {
        METHODS.into_iter().zip(apparent).flat_map(move |(method, points)| {
            points.into_iter().map(move |(steps, limit)| {
                let words = [device.into(), method.as_str().into()].into_iter();
                words.chain([steps, limit, truth, certified].map(Into::into)).collect()
            })
        })
    });
    let header = "device,method,steps a tick,apparent limit (N m/rad),limit (N m/rad),\
                  certified (N m/rad)";
    Ok(Chart { picture, data: Data::new(header, rows) })
}
