//! The source of a scene: a file, a text, or a dictionary.

use std::path::Path;

use haptic_model::file::{self, Format, Purpose, SceneFile};
use pyo3::prelude::*;

use crate::refusal::Refusal;

/// The name of a text without a file in errors.
const NAME: &str = "scene";

/// A scene before it is read: the form of its text, as `haptic/__init__.py` names it, and the text. That is a
/// `path`, a `text` in TOML or JSON, or the JSON of a `dictionary`, whose lines its author has not seen.
#[derive(FromPyObject)]
pub struct Source(String, String);

impl Source {
    /// Reads it.
    ///
    /// # Errors
    /// As for a scene file: every invalid key.
    pub fn read(&self, purpose: Purpose) -> Result<SceneFile, Refusal> {
        let parse = |format| file::parse_for(purpose, NAME, format, &self.1);
        match self.0.as_str() {
            "path" => Ok(file::load_for(purpose, self.path())?),
            "dictionary" => parse(Format::Json).map_err(|error| Refusal::dictionary(&error)),
            _ => Ok(parse(Format::of(NAME, &self.1))?),
        }
    }

    /// The folder of the files that it names.
    pub fn folder(&self) -> &Path {
        let parent = (self.0 == "path").then(|| Path::new(&self.1).parent());
        parent.flatten().unwrap_or(Path::new(""))
    }

    /// The path. A notebook has no standard input, so `-` is a file name, unlike on a command line.
    fn path(&self) -> &str {
        if self.1 == "-" { "./-" } else { &self.1 }
    }
}

/// A scene as JSON with all its keys, valid or not.
#[pyfunction]
pub fn load(py: Python<'_>, scene: Source) -> Result<String, Refusal> {
    py.detach(|| {
        let value = match scene.0.as_str() {
            "path" => file::load_json(scene.path())?,
            _ => file::as_json(NAME, Format::of(NAME, &scene.1), &scene.1)?,
        };
        Ok(serde_json::to_string(&value)?)
    })
}
