//! A record that a board makes: `haptic identify --port`.

use std::path::Path;

use crate::command::status::CommandError;
use crate::identify::port::SweepPort;
use crate::identify::{IdentifyError, Record, record};
use crate::link::Address;
use crate::progress;

/// Has the board measure its device; gives the record and the counts in a turn. A record that is not
/// whole is kept too, to be looked at.
pub fn measure(address: &Address, keep: Option<&Path>) -> Result<(Record, f64), CommandError> {
    let port = SweepPort::open(address)?;
    let counts_per_turn = port.description().counts_per_turn;
    let bar = progress::bar(port.description().ticks, "identify");
    let recording = port.record(progress::stepper(&bar))?;
    bar.finish_and_clear();
    if let Some(path) = keep {
        let unwritable = |source| CommandError::Unwritable { path: path.to_owned(), source };
        std::fs::write(path, &recording.text).map_err(unwritable)?;
    }
    recording.check_complete()?;
    let read = record::parse(&address.to_string(), recording.text.as_bytes());
    Ok((read.map_err(IdentifyError::from)?, counts_per_turn))
}
