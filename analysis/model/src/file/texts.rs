//! The text of a scene file, and behind it that of the device file that it names: one row of bytes, so that a
//! value has its place in either by one number.

use std::borrow::Cow;

use super::problem::{Fault, FileError, Problem};

/// The text of a file, and perhaps a second one.
pub struct Texts<'t> {
    file: &'t str,
    first_line: usize,
    all: Cow<'t, str>,
    second: Option<Second>,
}

struct Second {
    file: String,
    /// Where it begins.
    start: usize,
}

impl<'t> Texts<'t> {
    /// The text of one file, whose first line is this line of the file.
    pub fn new(file: &'t str, first_line: usize, text: &'t str) -> Self {
        Self { file, first_line, all: text.into(), second: None }
    }

    pub fn all(&self) -> &str {
        &self.all
    }

    /// Adds the text of a second file; returns where it begins.
    pub fn add(&mut self, file: String, text: &str) -> usize {
        let all = self.all.to_mut();
        all.push('\n');
        let start = all.len();
        all.push_str(text);
        self.second = Some(Second { file, start });
        start
    }

    /// The file and the line of a place.
    pub fn line_of(&self, place: usize) -> String {
        let (file, first_line, start, text) = self.of(place);
        format!("{file}:{}", first_line + text[..place - start].matches('\n').count())
    }

    /// The faults in their order; nothing where there are none.
    pub fn error(&self, faults: Vec<Fault>) -> Option<FileError> {
        FileError::of(faults, |Fault { span, problem }| {
            let (file, first_line, start, text) = self.of(span.start);
            let span = span.start - start..span.end - start;
            FileError::at(file, text, first_line, Fault { span, problem })
        })
    }

    /// A problem with the file as a whole.
    pub fn whole(&self, problem: Problem) -> FileError {
        FileError::whole(self.file, self.first_line, 1, problem)
    }

    /// The file of a place: its name, its first line, where it begins, and its text.
    fn of(&self, place: usize) -> (&str, usize, usize, &str) {
        match &self.second {
            Some(Second { file, start }) if place >= *start => {
                (file, 1, *start, &self.all[*start..])
            }
            Some(Second { start, .. }) => (self.file, self.first_line, 0, &self.all[..start - 1]),
            None => (self.file, self.first_line, 0, &self.all),
        }
    }
}
