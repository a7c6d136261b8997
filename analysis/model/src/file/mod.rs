//! Scene files: TOML, or JSON of the same shape.
//!
//! Each key has its unit, bound, default and example in one table ([`key`]), and each type of environment its
//! keys in another ([`kind`]). The reader uses these tables, and so do the reference ([`mod@reference`], kept
//! as `SCENE.md`), the JSON schema ([`schema`]) and the examples ([`example`]). An unknown key is an error,
//! and all errors of a file are reported at once.

#[cfg(test)]
mod any_text;
pub mod device;
mod device_file;
pub mod example;
pub mod key;
pub mod kind;
pub mod profile;
pub mod reference;
pub mod scene;
pub mod schema;
pub mod shape;
pub mod simulation;
pub mod supply;
pub mod write;

mod faults;
mod filter;
mod json;
mod plausible;
mod problem;
mod section;
mod toml;
mod transducers;
mod tree;
mod units;
mod updates;

use std::path::Path;

pub use device::Purpose;
pub use device_file::DeviceFile;
pub use plausible::warnings;
pub use problem::{FileError, Problem, excerpt};
pub use scene::SceneFile;

use faults::{Faults, Read};
use problem::Fault;
use tree::Node;

/// Longest scene file in bytes: a hundred times the longest that is written by hand, and still read quickly.
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

/// Reads a scene file to certify; `-` is standard input.
pub fn load(file: &str) -> Result<SceneFile, FileError> {
    load_for(Purpose::Certify, file)
}

/// Reads a scene file; `-` is standard input.
pub fn load_for(purpose: Purpose, file: &str) -> Result<SceneFile, FileError> {
    load_with(file, |root, source| scene::read(source, root, purpose))
}

/// Reads a scene or device file as [`as_json`] does; `-` is standard input.
///
/// # Errors
/// Where it cannot be read, or is neither TOML nor JSON.
pub fn load_json(file: &str) -> Result<serde_json::Value, FileError> {
    load_with(file, |root, _| Ok(root.value.into_json()))
}

/// Reads the device of a device file or of a scene file; `-` is standard input.
pub fn load_device(file: &str) -> Result<DeviceFile, FileError> {
    load_with(file, |root, source| device_file::read(source, root))
}

/// Parses the text of a device file that is called `file`.
pub fn parse_device(file: &str, format: Format, text: &str) -> Result<DeviceFile, FileError> {
    parse_with(file, 1, format, text, |root, source| device_file::read(source, root))
}

/// The text of a file, and its errors.
type Source<'s> = (&'s str, &'s Faults);

fn load_with<T>(
    file: &str,
    read: impl FnOnce(Node, Source<'_>) -> Read<T>,
) -> Result<T, FileError> {
    if file.is_empty() {
        return Err(FileError::whole("", 1, 1, Problem::NoName));
    }
    let (file, bytes) = match file {
        "-" => ("<stdin>", bounded(std::io::stdin().lock())),
        _ => (file, std::fs::File::open(file).map_err(unreadable).and_then(bounded)),
    };
    let bytes = bytes.map_err(|problem| FileError::whole(file, 1, 1, problem))?;
    let text = text_of(file, 1, &bytes)?;
    parse_with(file, 1, Format::of(file, text), text, read)
}

/// Parses the text of a scene file that is called `file`, to certify it.
pub fn parse(file: &str, format: Format, text: &str) -> Result<SceneFile, FileError> {
    parse_at(file, 1, format, text)
}

/// Parses the text of a scene file that is called `file`.
pub fn parse_for(
    purpose: Purpose,
    file: &str,
    format: Format,
    text: &str,
) -> Result<SceneFile, FileError> {
    parse_with(file, 1, format, text, |root, source| scene::read(source, root, purpose))
}

/// The text of a scene or device file as JSON with the same keys in the same order; keys and values are not
/// checked. A value that no key takes, a date or a null, becomes null.
///
/// # Errors
/// If the text is not valid in `format`.
pub fn as_json(file: &str, format: Format, text: &str) -> Result<serde_json::Value, FileError> {
    parse_with(file, 1, format, text, |root, _| Ok(root.value.into_json()))
}

/// A scene as JSON with the period and the encoder's step in place of the keys that state them otherwise
/// ([`key::RECIPROCALS`]), where only these are there.
pub fn canonical(mut scene: serde_json::Value) -> serde_json::Value {
    for (other, key, product) in key::RECIPROCALS {
        let Some(table) = scene.get_mut(key.table()).and_then(|table| table.as_object_mut()) else {
            continue;
        };
        let value = table.get(other.name()).and_then(|value| value.as_f64());
        if let (Some(value), false) = (value, table.contains_key(key.name())) {
            table.remove(other.name());
            table.insert(key.name().to_owned(), (product / value).into());
        }
    }
    scene
}

/// Parses a text that begins at a line of a longer file.
pub fn parse_at(
    file: &str,
    first_line: usize,
    format: Format,
    text: &str,
) -> Result<SceneFile, FileError> {
    let to_certify = |root: Node, source: Source<'_>| scene::read(source, root, Purpose::Certify);
    parse_with(file, first_line, format, text, to_certify)
}

fn parse_with<T>(
    file: &str,
    first_line: usize,
    format: Format,
    text: &str,
    read: impl FnOnce(Node, Source<'_>) -> Read<T>,
) -> Result<T, FileError> {
    let faults = Faults::default();
    let found = root(format, text, &faults).and_then(|root| read(root, (text, &faults)));
    match (found, FileError::of(file, text, first_line, faults.sorted())) {
        (Ok(found), None) => Ok(found),
        (_, Some(error)) => Err(error),
        // A failed read has been reported; this case is only a fallback.
        (Err(_), None) => Err(FileError::whole(file, first_line, 1, Problem::Empty)),
    }
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

fn root(format: Format, text: &str, faults: &Faults) -> Read<Node> {
    let root = match format {
        Format::Toml => toml::parse(text, faults)?,
        Format::Json => json::parse(text, faults)?,
    };
    if scene::is_empty(&root) {
        return Err(faults.report(Fault { span: 0..0, problem: Problem::Empty }));
    }
    Ok(root)
}

fn bounded(source: impl std::io::Read) -> Result<Vec<u8>, Problem> {
    let mut bytes = Vec::new();
    std::io::Read::read_to_end(&mut std::io::Read::take(source, MAX_BYTES + 1), &mut bytes)
        .map_err(unreadable)?;
    if bytes.len() as u64 > MAX_BYTES {
        return Err(Problem::TooLong { bound: MAX_BYTES });
    }
    Ok(bytes)
}

fn unreadable(error: std::io::Error) -> Problem {
    Problem::Unreadable(error.to_string())
}
