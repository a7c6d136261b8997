//! The functions for the Python package `haptic`: from scenes as texts to JSON and the bytes of arrays.
//! `haptic/__init__.py` converts these to dictionaries and NumPy arrays, and has the documentation of the
//! interface.
//!
//! A function lets other threads of Python run while it computes. Functions that may take long check for a
//! signal now and then, so that Ctrl-C ends them.

mod arrays;
mod board;
mod certificate;
mod integration;
mod map;
mod motion;
mod refusal;
mod source;
mod transfer;

use pyo3::prelude::*;

/// The functions, by their names in `haptic/__init__.py`.
#[pymodule(gil_used = false)]
mod _native {
    use pyo3::prelude::*;

    #[pymodule_export]
    use crate::board::{Connection, Simulated};
    #[pymodule_export]
    use crate::certificate::{certify, certify_many, index};
    #[pymodule_export]
    use crate::map::stability_map;
    #[pymodule_export]
    use crate::motion::{simulate, stability};
    #[pymodule_export]
    use crate::refusal::SceneError;
    #[pymodule_export]
    use crate::source::load;
    #[pymodule_export]
    use crate::transfer::response;

    #[pymodule_init]
    fn words(module: &Bound<'_, PyModule>) -> PyResult<()> {
        module.add("METHODS", crate::integration::names())?;
        module.add("STATES", crate::board::states())?;
        module.add("LIMITS", crate::board::limits())?;
        module.add("REGIONS", crate::map::names())?;
        module.add("TICK_STATUSES", crate::motion::tick_statuses())
    }
}

/// Ends a computation if Python has received a signal: Ctrl-C raises `KeyboardInterrupt`.
fn check_signals() -> PyResult<()> {
    Python::attach(|py| py.check_signals())
}
