//! The output of a program that was started here.

use std::io;
use std::process::{Command, Output, Stdio};

/// The end of a long text.
pub(super) fn last_lines(text: &str, count: usize) -> String {
    let lines: Vec<_> = text.trim_end().lines().collect();
    lines[lines.len().saturating_sub(count)..].join("\n")
}

/// The output of a program that succeeds, without input.
///
/// # Errors
/// The command, with the end of its output and [`io::ErrorKind::Other`] if it has run.
pub(super) fn finished(command: &mut Command) -> io::Result<Output> {
    let words: Vec<_> = std::iter::once(command.get_program())
        .chain(command.get_args())
        .map(|word| word.to_string_lossy().into_owned())
        .collect();
    let words = words.join(" ");
    let output = command.stdin(Stdio::null()).output();
    let output =
        output.map_err(|error| io::Error::new(error.kind(), format!("`{words}`: {error}")))?;
    if output.status.success() {
        return Ok(output);
    }
    let said = [&*output.stdout, &output.stderr].concat();
    let said = last_lines(&String::from_utf8_lossy(&said), 20);
    Err(io::Error::other(format!("`{words}` ended with {}:\n{said}", output.status)))
}
