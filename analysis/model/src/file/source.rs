//! The bytes of a file, its text, and the tree of its values.

use std::io::Read as _;
use std::path::Path;

use super::faults::{Faults, Read};
use super::problem::{Fault, FileError, Problem};
use super::tree::{Node, Value};
use super::{json, toml};

/// Longest scene file in bytes, and line of a batch: a hundred times the longest that is written by hand, and still
/// read quickly.
pub const MAX_BYTES: u64 = 4 << 20;

/// The two formats of a scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// TOML.
    Toml,
    /// JSON.
    Json,
}

impl Format {
    /// By the file's extension; if it is unknown, an object's brace means JSON.
    pub fn of(file: &str, text: &str) -> Self {
        match Path::new(file).extension().and_then(|extension| extension.to_str()) {
            Some("toml") => Self::Toml,
            Some("json") => Self::Json,
            _ if text.trim_start().starts_with('{') => Self::Json,
            _ => Self::Toml,
        }
    }
}

/// The bytes of a file.
pub fn bytes(path: &Path) -> Result<Vec<u8>, Problem> {
    std::fs::File::open(path).map_err(unreadable).and_then(bounded)
}

/// All bytes, if there are not too many.
pub fn bounded(source: impl std::io::Read) -> Result<Vec<u8>, Problem> {
    let mut bytes = Vec::new();
    source.take(MAX_BYTES + 1).read_to_end(&mut bytes).map_err(unreadable)?;
    if bytes.len() as u64 > MAX_BYTES {
        return Err(Problem::TooLong { part: "file", bound: MAX_BYTES });
    }
    Ok(bytes)
}

fn unreadable(error: std::io::Error) -> Problem {
    Problem::Unreadable(error.to_string())
}

/// The bytes of a file as text, or the place of the first byte that is not.
pub fn text_of<'b>(file: &str, first_line: usize, bytes: &'b [u8]) -> Result<&'b str, FileError> {
    std::str::from_utf8(bytes).map_err(|error| {
        let offset = error.valid_up_to();
        let before = &bytes[..offset];
        let line = first_line + before.iter().filter(|&&byte| byte == b'\n').count();
        let column = 1 + before.iter().rev().take_while(|&&byte| byte != b'\n').count();
        let byte = bytes.get(offset).copied().unwrap_or_default();
        FileError::whole(file, line, column, Problem::NotText { byte, offset })
    })
}

/// The tree of a text, which has something in it.
pub fn root(format: Format, text: &str, faults: &Faults) -> Read<Node> {
    let root = match format {
        Format::Toml => toml::parse(text, faults)?,
        Format::Json => json::parse(text, faults)?,
    };
    match &root.value {
        Value::Table(entries) if entries.is_empty() => {
            Err(faults.report(Fault { span: 0..0, problem: Problem::Empty }))
        }
        _ => Ok(root),
    }
}
