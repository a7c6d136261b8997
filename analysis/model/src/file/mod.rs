//! Scene files: TOML, or JSON of the same shape.
//!
//! Each key has its unit, bound, default and example in one table ([`key`]), and each type of environment its
//! keys in another ([`kind`]). The reader uses these tables, and so do the reference ([`mod@reference`], kept
//! as `SCENE.md`), the JSON schema ([`schema`]) and the examples ([`example`]). An unknown key is an error,
//! and all errors of a file are reported at once.
//! A scene file may name a file with its device, which is read as if it stood in the scene file
//! ([`key::DEVICE`]).

mod anticogging;
#[cfg(test)]
mod any_text;
pub mod bridge;
pub mod constant;
pub mod device;
mod device_file;
mod encoder;
pub mod example;
pub mod host;
pub mod key;
pub mod kind;
pub mod motor;
pub mod profile;
pub mod program;
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
mod named_device;
mod plausible;
mod problem;
mod section;
mod source;
mod texts;
mod toml;
mod transducers;
mod tree;
mod units;
mod updates;

use std::path::Path;

pub use device::Purpose;
pub use device_file::DeviceFile;
pub use encoder::is_beyond_longest;
pub use named_device::{device_file_of, naming};
pub use plausible::warnings;
pub use problem::{FileError, Problem, excerpt};
pub use scene::SceneFile;
pub use source::{Format, MAX_BYTES, text_of};
pub use transducers::StatedTransducers;

use faults::{Faults, Read};
use texts::Texts;
use tree::Node;

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

/// Reads a scene file to simulate, and as [`as_json`] does; `-` is standard input.
///
/// # Errors
/// As [`load_for`].
pub fn load_with_json(file: &str) -> Result<(SceneFile, serde_json::Value), FileError> {
    load_with(file, |root, source| {
        let json = root.clone().value.into_json();
        Ok((scene::read(source, root, Purpose::Simulate)?, json))
    })
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
    let (file, folder, bytes) = match file {
        "-" => ("<stdin>", None, source::bounded(std::io::stdin().lock())),
        _ => (file, Path::new(file).parent(), source::bytes(Path::new(file))),
    };
    let bytes = bytes.map_err(|problem| FileError::whole(file, 1, 1, problem))?;
    let text = text_of(file, 1, &bytes)?;
    let texts = Texts::new(file, 1, text);
    parsed(texts, folder, Format::of(file, text), read)
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
    parsed(Texts::new(file, first_line, text), None, format, read)
}

/// The keys of a scene file of its own, without those of a device file that it names.
fn unmerged(file: &Path, bytes: &[u8]) -> Option<serde_json::Value> {
    let text = text_of("", 1, bytes).ok()?;
    let root = source::root(Format::of(file.to_str()?, text), text, &Faults::default());
    Some(root.ok()?.value.into_json())
}

/// Parses the text of a scene file in a folder.
fn parse_in(folder: &Path, text: &str) -> Result<SceneFile, FileError> {
    let read = |root: Node, source: Source<'_>| scene::read(source, root, Purpose::Simulate);
    parsed(Texts::new("", 1, text), Some(folder), Format::Toml, read)
}

/// Reads a text, and the device file that it names, relative to a folder or the working folder.
fn parsed<T>(
    mut texts: Texts<'_>,
    folder: Option<&Path>,
    format: Format,
    read: impl FnOnce(Node, Source<'_>) -> Read<T>,
) -> Result<T, FileError> {
    let faults = Faults::default();
    let found = source::root(format, texts.all(), &faults)
        .and_then(|root| named_device::merged(&mut texts, root, folder, &faults))
        .and_then(|root| read(root, (texts.all(), &faults)));
    match (found, texts.error(faults.sorted())) {
        (Ok(found), None) => Ok(found),
        (_, Some(error)) => Err(error),
        // A failed read has been reported; this case is only a fallback.
        (Err(_), None) => Err(texts.whole(Problem::Empty)),
    }
}
