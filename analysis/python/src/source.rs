//! The source of a scene: a file, a text, or a dictionary.

use std::path::Path;

use haptic_model::file::{self, Format, Purpose, SceneFile};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

use crate::refusal::Refusal;

/// The name of a text without a file in errors.
const NAME: &str = "scene";

/// A scene before it is read.
#[derive(FromPyObject)]
pub struct Source(Form, String);

/// The form of its text.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Form {
    /// The path of a file.
    Path,
    /// TOML or JSON.
    Text,
    /// The JSON of a dictionary, whose lines its author has not seen.
    Dictionary,
}

impl<'py> FromPyObject<'_, 'py> for Form {
    type Error = PyErr;

    fn extract(object: Borrowed<'_, 'py, PyAny>) -> PyResult<Self> {
        match object.extract::<&str>()? {
            "path" => Ok(Self::Path),
            "text" => Ok(Self::Text),
            "dictionary" => Ok(Self::Dictionary),
            other => Err(PyValueError::new_err(format!("`{other}` is not a form of a scene"))),
        }
    }
}

impl Source {
    /// Reads it.
    ///
    /// # Errors
    /// As for a scene file: every invalid key.
    pub fn read(&self, purpose: Purpose) -> Result<SceneFile, Refusal> {
        let parse = |format| file::parse_for(purpose, NAME, format, &self.1);
        match self.0 {
            Form::Path => Ok(file::load_for(purpose, self.path())?),
            Form::Text => Ok(parse(Format::of(NAME, &self.1))?),
            Form::Dictionary => parse(Format::Json).map_err(Refusal::Dictionary),
        }
    }

    /// The folder of the files that it names.
    pub fn folder(&self) -> &Path {
        let parent = (self.0 == Form::Path).then(|| Path::new(&self.1).parent());
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
        let value = match scene.0 {
            Form::Path => file::load_json(scene.path())?,
            _ => file::as_json(NAME, Format::of(NAME, &scene.1), &scene.1)?,
        };
        Ok(serde_json::to_string(&value)?)
    })
}
