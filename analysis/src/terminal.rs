//! Properties of the terminal: its colours and its width.

use std::io::{stderr, stdout};

use terminal_size::{Height, Width, terminal_size_of};

/// Whether colours may be written to a stream that is a terminal: not if `NO_COLOR`
/// (no-color.org) is set, and not if the terminal shows letters only.
pub fn has_colour(is_terminal: bool) -> bool {
    let unwanted = std::env::var_os("NO_COLOR").is_some_and(|value| !value.is_empty());
    is_terminal && !unwanted && !is_dumb()
}

/// Whether the terminal can do nothing but letters: no colours, no moving cursor.
pub fn is_dumb() -> bool {
    std::env::var_os("TERM").is_some_and(|term| term == "dumb")
}

/// Columns of standard output; `None` where it is no terminal, or one that does not know.
pub fn output_width() -> Option<usize> {
    columns(terminal_size_of(stdout()))
}

/// Columns of standard error; `None` where it is no terminal, or one that does not know.
pub fn error_width() -> Option<usize> {
    columns(terminal_size_of(stderr()))
}

/// Fewest columns that text is broken to: in fewer, words would be.
const LEAST: usize = 20;

fn columns(size: Option<(Width, Height)>) -> Option<usize> {
    size.map(|(Width(columns), _)| usize::from(columns).max(LEAST))
}

/// Breaks the lines of a text that are wider than so many columns between words; what follows is
/// indented by `hang` columns. Nothing is broken where there is no width.
pub fn wrapped(text: &str, width: Option<usize>, hang: usize) -> String {
    let Some(width) = width else { return text.to_owned() };
    let indent = " ".repeat(if hang < width / 2 { hang } else { 0 });
    let options = textwrap::Options::new(width).subsequent_indent(&indent).break_words(false);
    let lines = text.lines().map(|line| textwrap::wrap(line, &options).join("\n"));
    let mut wrapped = lines.collect::<Vec<_>>().join("\n");
    if text.ends_with('\n') {
        wrapped.push('\n');
    }
    wrapped
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn long_lines_are_broken_and_hang() {
        let text = "label   a sentence that is longer than the terminal is wide\nshort\n";
        let broken =
            "label   a sentence that is longer\n        than the terminal is wide\nshort\n";
        assert_eq!(wrapped(text, Some(34), 8), broken);
        assert_eq!(wrapped(text, None, 8), text);
        assert!(wrapped(text, Some(20), 12).lines().all(|line| line.len() <= 20));
    }
}
