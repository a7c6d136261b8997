//! A program's log: defmt's bytes as lines.

use defmt_decoder::{DecodeError, Table};

/// The lines in these bytes, which begin with a frame, with the strings in the program's ELF file. An
/// incomplete frame is omitted; a program without a log has no lines.
pub fn lines(elf: &[u8], bytes: &[u8]) -> Vec<String> {
    let Some(table) = Table::parse(elf).ok().flatten() else { return Vec::new() };
    let mut decoder = table.new_stream_decoder();
    decoder.received(bytes);
    let mut lines = Vec::new();
    loop {
        match decoder.decode() {
            Ok(frame) => {
                let level = frame.level().map_or("print", |level| level.as_str());
                lines.push(format!("{level} {}", frame.display_message()));
            }
            Err(DecodeError::UnexpectedEof) => return lines,
            // The encoding finds the start of the next frame by itself.
            Err(DecodeError::Malformed) => lines.push("error a malformed frame".into()),
        }
    }
}
