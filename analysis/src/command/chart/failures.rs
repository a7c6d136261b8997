//! `haptic chart failures`: which springs methods of integration call stable, and which are.

use clap::Args;

use super::OutputArguments;
use crate::chart::{self, Picture};
use crate::command::CommandError;
use crate::failures::region::Region;

/// Arguments of `haptic chart failures`.
#[derive(Debug, Args)]
pub struct Arguments {
    #[command(flatten)]
    #[allow(missing_docs)]
    pub output: OutputArguments,
}

/// Looks for the limits and draws them.
pub fn draw() -> Result<Picture, CommandError> {
    Ok(chart::failures::failures(&Region::all()?)?)
}
