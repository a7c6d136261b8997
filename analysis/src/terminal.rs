//! Properties of the terminal: its colours, its width, and the signals that end a program there.

use std::io::{self, stderr, stdout};
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use signal_hook::consts::{SIGINT, SIGTERM};
use terminal_size::{Height, Width, terminal_size_of};

/// Whether colours may be written to a stream that is a terminal: not if `NO_COLOR`
/// (no-color.org) is set, and not if the terminal shows letters only.
pub fn has_colour(is_terminal: bool) -> bool {
    let unwanted = std::env::var_os("NO_COLOR").is_some_and(|value| !value.is_empty());
    is_terminal && !unwanted && !is_dumb()
}

/// Whether the terminal shows letters only: no colours, no moving cursor.
pub fn is_dumb() -> bool {
    std::env::var_os("TERM").is_some_and(|term| term == "dumb")
}

/// Columns of standard output; `None` if it is not a terminal or does not know its width.
pub fn output_width() -> Option<usize> {
    columns(terminal_size_of(stdout()))
}

/// Columns of standard error; `None` if it is not a terminal or does not know its width.
pub fn error_width() -> Option<usize> {
    columns(terminal_size_of(stderr()))
}

/// Fewest columns to which text is wrapped: with fewer, words would be broken.
const LEAST: usize = 20;

fn columns(size: Option<(Width, Height)>) -> Option<usize> {
    size.map(|(Width(columns), _)| usize::from(columns).max(LEAST))
}

/// Has Ctrl-C and a signal to end set this flag, in place of ending the program at once.
pub fn interrupted() -> io::Result<Arc<AtomicBool>> {
    let flag = Arc::new(AtomicBool::new(false));
    for signal in [SIGINT, SIGTERM] {
        signal_hook::flag::register(signal, flag.clone())?;
    }
    Ok(flag)
}
