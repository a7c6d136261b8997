//! A record measured by a board: `haptic identify --port`.

use std::path::Path;

use crate::command::shared_arguments::write;
use crate::command::status::CommandError;
use crate::identify::port::{Description, SweepPort};
use crate::identify::{IdentifyError, Record, record};
use crate::link::Address;
use crate::progress;

/// Lets the board measure its device, by slow turns or by sines; returns the record and the board's description. An incomplete record is
/// also kept, for inspection.
pub fn measure(
    address: &Address,
    keep: Option<&Path>,
    turns: bool,
) -> Result<(Record, Description), CommandError> {
    let port = SweepPort::open(address)?;
    port.check_program(turns)?;
    let bar = progress::bar(port.description().ticks, "identify");
    let recording = port.record(progress::stepper(&bar))?;
    bar.finish_and_clear();
    if let Some(path) = keep {
        write(path, &recording.text)?;
    }
    recording.check_complete()?;
    let count_angle = std::f64::consts::TAU / recording.description.counts_per_turn;
    let read = record::parse(&address.to_string(), recording.text.as_bytes(), count_angle);
    Ok((read.map_err(IdentifyError::from)?, recording.description))
}
