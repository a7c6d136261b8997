//! The reasons for a failure, as Python exceptions.

use haptic_model::file::FileError;
use haptic_model::number::DoesNotFit;
use haptic_model::simulation::SimulationError;
use haptic_model::stability_map::MapError;
use pyo3::PyErr;
use pyo3::exceptions::PyValueError;
use thiserror::Error;

pyo3::create_exception!(
    haptic,
    SceneError,
    PyValueError,
    "A scene or an argument that has no answer; the sentence names the key, its value and its bound."
);

/// The reason for a failure.
#[derive(Debug, Error)]
pub enum Refusal {
    /// The sentence of a `SceneError`.
    #[error("{0}")]
    Scene(String),
    /// A signal, or an exception of Python's own.
    #[error(transparent)]
    Python(#[from] PyErr),
}

impl Refusal {
    /// The refusal of an argument.
    pub fn argument(name: &str, value: &str, bound: &str) -> Self {
        Self::Scene(format!("`{name}` = {value} is out of bounds; {bound}"))
    }

    /// The refusal of a dictionary, which has no lines: one line for each error, without places.
    pub fn dictionary(error: &FileError) -> Self {
        let each = std::iter::once(error).chain(&error.rest);
        let mut lines: Vec<String> = each.map(|error| error.problem.to_string()).collect();
        if error.untold > 0 {
            lines.push(format!("and {} more problems", error.untold));
        }
        Self::Scene(lines.join("\n"))
    }
}

macro_rules! scene_errors {
    ($($error:ty),*) => {
        $(impl From<$error> for Refusal {
            fn from(error: $error) -> Self {
                Self::Scene(error.to_string())
            }
        })*
    };
}

scene_errors!(FileError, DoesNotFit, SimulationError, MapError, serde_json::Error);

impl From<Refusal> for PyErr {
    fn from(refusal: Refusal) -> Self {
        match refusal {
            Refusal::Python(error) => error,
            Refusal::Scene(sentence) => SceneError::new_err(sentence),
        }
    }
}
