//! Eigenvalues of a loop.

use nalgebra::linalg::Schur;
use nalgebra::{Complex, DMatrix};

use crate::simulation::SimulationError;
use crate::simulation::method::balance;

/// Eigenvalues of a matrix.
///
/// # Errors
/// Where they are not found.
pub fn eigenvalues(matrix: &DMatrix<f64>) -> Result<Vec<Complex<f64>>, SimulationError> {
    /// More than the iteration has ever been seen to take, and bounded.
    const ITERATIONS: usize = 10_000;
    let mut balanced = matrix.clone();
    balance(&mut balanced).ok_or(SimulationError::Eigenvalues)?;
    let schur = Schur::try_new(balanced, f64::EPSILON, ITERATIONS);
    let schur = schur.ok_or(SimulationError::Eigenvalues)?;
    Ok(schur.complex_eigenvalues().iter().copied().collect())
}

/// Largest modulus.
pub fn radius(eigenvalues: &[Complex<f64>]) -> f64 {
    eigenvalues.iter().map(|eigenvalue| eigenvalue.norm()).fold(0.0, f64::max)
}
