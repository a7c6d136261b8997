//! Arrays of numbers as the bytes that NumPy reads and writes.

use pyo3::prelude::*;
use pyo3::types::PyByteArray;

use crate::refusal::Refusal;

/// Bytes of a number.
const SIZE: usize = size_of::<f64>();

/// The bytes of numbers, which NumPy takes as a writable array without a copy.
pub fn to_python<'py>(py: Python<'py>, numbers: &[f64]) -> PyResult<Bound<'py, PyByteArray>> {
    PyByteArray::new_with(py, numbers.len() * SIZE, |bytes| {
        for (place, number) in bytes.chunks_exact_mut(SIZE).zip(numbers) {
            place.copy_from_slice(&number.to_ne_bytes());
        }
        Ok(())
    })
}

/// The numbers of an array's bytes.
///
/// # Errors
/// The first number that is not finite.
pub fn finite(name: &str, bytes: &[u8], unit: &str) -> Result<Vec<f64>, Refusal> {
    let (chunks, _) = bytes.as_chunks::<SIZE>();
    let numbers: Vec<f64> = chunks.iter().map(|bytes| f64::from_ne_bytes(*bytes)).collect();
    match numbers.iter().position(|number| !number.is_finite()) {
        None => Ok(numbers),
        Some(index) => {
            let (name, value) = (format!("{name}[{index}]"), numbers[index].to_string());
            let bound = format!("it must be a finite number in {unit}");
            Err(Refusal::argument(&name, &value, &bound))
        }
    }
}
