//! The regions of walls of every stiffness and damping.

use haptic_model::file::Purpose;
use haptic_model::stability_map::{Family, Region};
use pyo3::prelude::*;
use pyo3::types::PyByteArray;
use rayon::prelude::*;

use crate::refusal::Refusal;
use crate::source::Source;
use crate::{arrays, check_signals};

/// Walls between two checks for a signal.
const CHUNK: usize = 16_384;

/// The words of regions, in the order of their codes.
pub fn names() -> Vec<&'static str> {
    Region::ALL.map(Region::as_str).to_vec()
}

/// The region of each wall as its code, all stiffnesses (N m/rad) of a damping (N m s/rad) in a row.
#[pyfunction]
pub fn stability_map<'py>(
    py: Python<'py>,
    scene: Source,
    stiffness: &[u8],
    damping: &[u8],
) -> Result<Bound<'py, PyByteArray>, Refusal> {
    let stiffness = arrays::finite("stiffness", stiffness, "N m/rad")?;
    let damping = arrays::finite("damping", damping, "N m s/rad")?;
    let codes = py.detach(|| codes(&scene, &stiffness, &damping))?;
    Ok(PyByteArray::new(py, &codes))
}

fn codes(scene: &Source, stiffness: &[f64], damping: &[f64]) -> Result<Vec<u8>, Refusal> {
    let family = Family::of(&scene.read(Purpose::Certify)?)?;
    let columns = stiffness.len();
    let region = |cell: usize| family.region(stiffness[cell % columns], damping[cell / columns]);
    let count = columns * damping.len();
    let mut codes = Vec::with_capacity(count);
    for first in (0..count).step_by(CHUNK) {
        check_signals()?;
        let chunk = first..count.min(first + CHUNK);
        codes.par_extend(chunk.into_par_iter().map(|cell| region(cell) as u8));
    }
    Ok(codes)
}
