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
    /// A file, or a text, with the places of its errors.
    #[error(transparent)]
    File(#[from] FileError),
    /// A dictionary, which has no lines.
    #[error("{}", sentences(.0))]
    Dictionary(FileError),
    /// A number that the number format cannot represent.
    #[error(transparent)]
    DoesNotFit(#[from] DoesNotFit),
    /// The scene has no motion.
    #[error(transparent)]
    Simulation(#[from] SimulationError),
    /// The scene has no map.
    #[error(transparent)]
    Map(#[from] MapError),
    /// An argument.
    #[error("`{name}` = {value} is out of bounds; {bound}")]
    Argument {
        /// Its name.
        name: String,
        /// Its value.
        value: String,
        /// Its bound.
        bound: String,
    },
    /// No number could be written.
    #[error("the answer has no JSON: {0}")]
    Json(#[from] serde_json::Error),
    /// A signal, or an exception of Python's own.
    #[error(transparent)]
    Python(#[from] PyErr),
}

impl From<Refusal> for PyErr {
    fn from(refusal: Refusal) -> Self {
        match refusal {
            Refusal::Python(error) => error,
            other => SceneError::new_err(other.to_string()),
        }
    }
}

/// One line for each error, without places.
fn sentences(error: &FileError) -> String {
    let each = std::iter::once(error).chain(&error.rest);
    let mut lines: Vec<String> = each.map(|error| error.problem.to_string()).collect();
    if error.untold > 0 {
        lines.push(format!("and {} more problems", error.untold));
    }
    lines.join("\n")
}
