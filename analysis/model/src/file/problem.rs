//! The errors of a file, as sentences that name the file, the line, the key, the value and the bound.

use std::fmt;

use annotate_snippets::{AnnotationKind, Level, Renderer, Snippet};
use thiserror::Error;

use super::tree::Span;
use crate::text_width::wrapped;

/// Longest piece of a file that is repeated in a message, in characters.
const EXCERPT: usize = 60;

/// Longest line of a file that is shown under a message, in bytes.
const SHOWN_LINE: usize = 160;

/// An error, without the place.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum Problem {
    /// No file was named.
    #[error("the name of the file is empty; `-` is standard input")]
    NoName,
    /// The file could not be read.
    #[error("the file cannot be read: {0}")]
    Unreadable(String),
    /// More bytes than a scene can need.
    #[error("the {part} is longer than {bound} bytes, the most that is read")]
    TooLong {
        /// The file, or the line of it that a scene is on.
        part: &'static str,
        /// Largest length in bytes.
        bound: u64,
    },
    /// Not text.
    #[error("the file is not UTF-8 text: byte {byte:#04x} at offset {offset}")]
    NotText {
        /// The first byte that is not part of a character.
        byte: u8,
        /// Its position in the file.
        offset: usize,
    },
    /// Nothing in it.
    #[error("the file is empty; a scene has `name`, [device], [servo] and [environment]")]
    Empty,
    /// Neither valid TOML nor valid JSON.
    #[error("not valid {format}: {message}")]
    Syntax {
        /// The format that was expected.
        format: &'static str,
        /// The parser's message.
        message: String,
    },
    /// A device file in place of a scene file.
    #[error(
        "this is a device file, without [servo] and [environment]: `haptic advise device` says what it can render, \
         and a scene file, which has both, names it by `device = \"FILE\"`"
    )]
    OfDevice,
    /// A key, or its value.
    #[error("{sentence}")]
    OfKey {
        /// Full name of the key.
        key: String,
        /// The whole sentence.
        sentence: String,
    },
}

impl Problem {
    /// A key that is there twice.
    pub fn duplicate(key: &str) -> Self {
        let key = excerpt(key);
        Self::OfKey { sentence: format!("the key `{key}` is set twice"), key }
    }

    /// A text that the format's grammar does not admit.
    pub fn syntax(format: &'static str, message: &str) -> Self {
        Self::Syntax { format, message: excerpt(message) }
    }

    /// A key, with the rest of the sentence behind its name.
    pub fn key_and(key: String, rest: &str) -> Self {
        Self::OfKey { sentence: format!("`{key}`{rest}"), key }
    }

    /// A value as it is written, with the end of a sentence about it.
    pub fn value(key: &str, written: &str, wrong: impl fmt::Display) -> Self {
        Self::key_and(key.to_owned(), &format!(" = {} {wrong}", excerpt(written)))
    }

    /// Full name of the key that it is about, with the indices of lists, such as
    /// `environment.shape[0].torque`; `None` if it is not about a key.
    pub fn key(&self) -> Option<&str> {
        match self {
            Self::OfKey { key, .. } => Some(key),
            _ => None,
        }
    }
}

/// A problem and the bytes of the text that it is about.
#[derive(Clone, Debug, PartialEq)]
pub struct Fault {
    /// Its place.
    pub span: Span,
    /// The problem.
    pub problem: Problem,
}

/// Largest number of problems shown for a file; a text of another kind has a problem in each line.
const MOST: usize = 20;

/// A bad file: its name, the place, and the error.
#[derive(Clone, Debug, PartialEq)]
pub struct FileError {
    /// The file's name as the person gave it.
    pub file: String,
    /// Line, counted from 1.
    pub line: usize,
    /// Column in characters, counted from 1.
    pub column: usize,
    /// The error.
    pub problem: Box<Problem>,
    /// The line and the bytes in it that the problem is about, if it is short enough to show.
    shown: Option<Box<(String, Span)>>,
    /// The file's other problems, further down.
    pub rest: Vec<FileError>,
    /// Number of further errors, not shown.
    pub untold: usize,
}

impl FileError {
    /// Places faults in their order; nothing where there are none.
    pub fn of(faults: Vec<Fault>, at: impl Fn(Fault) -> Self) -> Option<Self> {
        let untold = faults.len().saturating_sub(MOST);
        let mut placed = faults.into_iter().take(MOST).map(at);
        let first = placed.next()?;
        Some(Self { rest: placed.collect(), untold, ..first })
    }

    /// A fault in the text that it was found in, whose first line is line `first_line` of the file.
    pub fn at(file: &str, text: &str, first_line: usize, fault: Fault) -> Self {
        let start = text.floor_char_boundary(fault.span.start);
        let before = &text[..start];
        let line_start = before.rfind('\n').map_or(0, |newline| newline + 1);
        let line_end = text[start..].find('\n').map_or(text.len(), |newline| start + newline);
        let line = text[line_start..line_end].trim_end_matches('\r');
        let end = text
            .floor_char_boundary(fault.span.end)
            .clamp(start, line_start + line.len().max(start - line_start));
        let printable = line.len() <= SHOWN_LINE && !line.chars().any(is_unprintable);
        let shown = printable.then(|| (line.to_owned(), start - line_start..end - line_start));
        Self {
            file: excerpt_path(file),
            line: first_line + before.matches('\n').count(),
            column: 1 + text[line_start..start].chars().count(),
            problem: Box::new(fault.problem),
            shown: shown.filter(|(line, _)| !line.trim().is_empty()).map(Box::new),
            rest: Vec::new(),
            untold: 0,
        }
    }

    /// A problem with a file as a whole, without any of its text.
    pub fn whole(file: &str, line: usize, column: usize, problem: Problem) -> Self {
        let (file, problem) = (excerpt_path(file), Box::new(problem));
        Self { file, line, column, problem, shown: None, rest: Vec::new(), untold: 0 }
    }

    /// Each message with the line of the file below it, as compilers print it.
    pub fn report(&self, colour: bool) -> String {
        self.report_within(colour, None)
    }

    /// The same, with messages broken to `width` columns.
    pub fn report_within(&self, colour: bool, width: Option<usize>) -> String {
        let each = std::iter::once(self).chain(&self.rest);
        let mut parts: Vec<String> = each.map(|error| error.report_alone(colour, width)).collect();
        parts.extend(self.and_more());
        parts.join("\n\n")
    }

    /// Number of problems not shown.
    fn and_more(&self) -> Option<String> {
        (self.untold > 0).then(|| format!("{}: and {} more problems", self.file, self.untold))
    }

    fn report_alone(&self, colour: bool, width: Option<usize>) -> String {
        // The title stands behind this word; its further lines are indented by the same width.
        const ERROR: usize = "error: ".len();
        let room = width.map(|width| width.saturating_sub(ERROR).max(1));
        let title = wrapped(&self.sentence(), room, 0);
        let renderer = if colour { Renderer::styled() } else { Renderer::plain() };
        let group = match self.shown.as_deref() {
            None => Level::ERROR
                .primary_title(title.as_str())
                .elements(std::iter::empty::<Snippet<'_, annotate_snippets::Annotation<'_>>>()),
            Some((line, span)) => Level::ERROR.primary_title(title.as_str()).element(
                Snippet::source(line.as_str())
                    .path(self.file.as_str())
                    .line_start(self.line)
                    .annotation(AnnotationKind::Primary.span(span.clone())),
            ),
        };
        renderer.render(&[group]).to_string()
    }
}

impl FileError {
    /// The first problem with its place. A file that could not be read has none.
    fn sentence(&self) -> String {
        let Self { file, line, column, problem, .. } = self;
        match **problem {
            Problem::NoName => problem.to_string(),
            Problem::Unreadable(_) if (*line, *column) == (1, 1) => format!("{file}: {problem}"),
            _ => format!("{file}:{line}:{column}: {problem}"),
        }
    }
}

impl fmt::Display for FileError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.sentence())?;
        for error in &self.rest {
            write!(f, "\n{}", error.sentence())?;
        }
        self.and_more().map_or(Ok(()), |more| write!(f, "\n{more}"))
    }
}

impl std::error::Error for FileError {}

fn is_unprintable(character: char) -> bool {
    character.is_control() && character != '\t'
}

/// An excerpt of foreign text, safe to print: one line, no control characters, bounded.
pub fn excerpt(text: &str) -> String {
    let mut short = String::new();
    for (count, character) in text.trim().chars().enumerate() {
        if count == EXCERPT {
            short.push('…');
            break;
        }
        match character {
            c if c.is_control() => short.extend(c.escape_default()),
            c => short.push(c),
        }
    }
    short
}

/// A path comes from the user and is repeated whole, without control characters.
fn excerpt_path(path: &str) -> String {
    path.chars().map(|c| if c.is_control() { '?' } else { c }).collect()
}
