//! Many scenes, one a line: judged in parallel, answered in order, in bounded memory.

use std::error::Error;
use std::fs::File;
use std::io::{self, BufRead, BufReader, Read, Write};

use haptic_servo::number::Format;
use rayon::prelude::*;
use serde_json::json;

use super::status::CommandError;
use crate::file::{self, FileError, MAX_BYTES, Problem};
use crate::number;
use crate::verdict;

/// Lines that are judged together. Enough to keep every core busy for a few milliseconds, few
/// enough that a reader at the other end of a pipe sees progress.
const CHUNK: usize = 1024;

/// Bytes that are read ahead.
const BUFFER: usize = 1 << 20;

enum Line {
    /// Its bytes, without the newline.
    Bytes(Vec<u8>),
    /// It was longer than [`MAX_BYTES`], and the rest of it was passed over.
    TooLong,
}

/// Reads scenes from a JSON-lines file (`-` is standard input) and writes a result for each: as many
/// lines as came in, in their order.
pub fn certify(file: &str, format: Format, out: &mut impl Write) -> Result<(), CommandError> {
    let unreadable =
        |error: io::Error| FileError::whole(file, 1, 1, Problem::Unreadable(error.to_string()));
    let (file, source): (_, Box<dyn Read>) = match file {
        "-" => ("<stdin>", Box::new(io::stdin().lock())),
        "" => return Err(FileError::whole(file, 1, 1, Problem::NoName).into()),
        _ => (file, Box::new(File::open(file).map_err(unreadable)?)),
    };
    let mut source = BufReader::with_capacity(BUFFER, source);
    let mut first_line = 1;
    loop {
        let lines = read_chunk(file, first_line, &mut source)?;
        if lines.is_empty() {
            return Ok(());
        }
        let answers: Vec<Vec<u8>> = lines
            .par_iter()
            .enumerate()
            .map(|(index, line)| answer(file, format, first_line + index, line))
            .collect();
        for answer in &answers {
            out.write_all(answer)?;
        }
        out.flush()?;
        first_line += lines.len();
    }
}

fn read_chunk(
    file: &str,
    first_line: usize,
    source: &mut BufReader<impl Read>,
) -> Result<Vec<Line>, FileError> {
    let mut lines = Vec::new();
    // Takes only buffered lines besides the first, so that a client that sends one scene and
    // waits gets its answer.
    while lines.is_empty() || (lines.len() < CHUNK && source.buffer().contains(&b'\n')) {
        let unreadable = |error: io::Error| {
            let line = first_line + lines.len();
            FileError::whole(file, line, 1, Problem::Unreadable(error.to_string()))
        };
        match read_line(source).map_err(unreadable)? {
            Some(line) => lines.push(line),
            None => break,
        }
    }
    Ok(lines)
}

fn read_line(source: &mut impl BufRead) -> io::Result<Option<Line>> {
    let mut bytes = Vec::new();
    if source.by_ref().take(MAX_BYTES + 1).read_until(b'\n', &mut bytes)? == 0 {
        return Ok(None);
    }
    if bytes.last() == Some(&b'\n') {
        bytes.pop();
    } else if bytes.len() as u64 > MAX_BYTES {
        // The rest of the line is not kept.
        source.skip_until(b'\n')?;
        return Ok(Some(Line::TooLong));
    }
    Ok(Some(Line::Bytes(bytes)))
}

/// One line's answer with its newline.
fn answer(file: &str, format: Format, number: usize, line: &Line) -> Vec<u8> {
    let judged = match line {
        Line::Bytes(bytes) => judge(file, format, number, bytes),
        Line::TooLong => {
            let problem = Problem::TooLong { part: "line", bound: MAX_BYTES };
            Err(FileError::whole(file, number, 1, problem).into())
        }
    };
    let text = match judged {
        Ok(report) => serde_json::to_vec(&report),
        Err(error) => serde_json::to_vec(&json!({ "error": error.to_string() })),
    };
    // Strings and numbers always have a JSON form; were it otherwise, the line still gets an answer.
    let mut text =
        text.unwrap_or_else(|error| format!("{{\"error\": {:?}}}", error.to_string()).into());
    text.push(b'\n');
    text
}

fn judge(
    file: &str,
    format: Format,
    number: usize,
    bytes: &[u8],
) -> Result<verdict::VerdictReport, Box<dyn Error>> {
    let text = file::text_of(file, number, bytes)?;
    let scene = file::parse_at(file, number, file::Format::Json, text)?;
    number::fits(&scene.scene, format)?;
    Ok(verdict::judge_file(&scene, format))
}
