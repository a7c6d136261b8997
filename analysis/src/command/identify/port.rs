//! A record measured by a board: `haptic identify --port`.

use crate::command::status::CommandError;
use crate::identify::port::{Description, SweepPort};
use crate::identify::record::{self, Recorder};
use crate::identify::{IdentifyError, Record};
use crate::link::Address;
use crate::progress;

/// Lets the board measure its device, by slow turns or by sines, if its description passes a check; returns the
/// record and that description. An incomplete record is also kept, for inspection.
pub fn measure(
    address: &Address,
    recorder: &mut Recorder<'_>,
    turns: bool,
    check: impl FnOnce(&Description) -> Result<(), CommandError>,
) -> Result<(Record, Description), CommandError> {
    let port = SweepPort::open(address)?;
    port.check_program(turns)?;
    check(port.description())?;
    let bar = progress::bar(port.description().ticks, "identify");
    let recording = port.record(recorder, progress::stepper(&bar))?;
    bar.finish_and_clear();
    recording.check_complete()?;
    let count_angle = std::f64::consts::TAU / recording.description.counts_per_turn;
    let read = record::parse(&address.to_string(), recording.text.as_bytes(), count_angle);
    Ok((read.map_err(IdentifyError::from)?, recording.description))
}
