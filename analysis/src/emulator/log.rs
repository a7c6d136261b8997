//! The board's log: defmt's bytes on the emulator's standard output, as lines.

use std::io::Read;
use std::thread::JoinHandle;

use defmt_decoder::{DecodeError, Table};

/// Turns a program's log into lines, with the strings in the program's file.
pub struct LogDecoder {
    table: Option<Table>,
}

impl LogDecoder {
    /// A decoder for the program in an ELF file; a program without a log has empty ones.
    pub fn of_program(elf: &[u8]) -> Self {
        Self { table: Table::parse(elf).ok().flatten() }
    }

    /// Reads until the program ends. The log must be read while the program runs, because a full pipe would
    /// stop the board.
    pub fn follow(self, mut output: impl Read + Send + 'static) -> JoinHandle<Vec<String>> {
        std::thread::spawn(move || {
            let mut bytes = Vec::new();
            // Bytes before an error of the pipe are still a log.
            let _ = output.read_to_end(&mut bytes);
            self.decode(&bytes)
        })
    }

    /// The lines in these bytes, which begin with a frame; an incomplete frame is omitted.
    pub fn decode(&self, bytes: &[u8]) -> Vec<String> {
        let Some(table) = &self.table else { return Vec::new() };
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
}
