//! The transfer functions of a scene around the unit circle.

use haptic_model::file::Purpose;
use haptic_model::response::Response;
use haptic_model::simulation::SimulationError;
use haptic_servo::certificate::LoopTransfers;
use pyo3::prelude::*;
use pyo3::types::PyByteArray;

use crate::arrays;
use crate::certificate::format_of;
use crate::refusal::Refusal;
use crate::source::Source;

/// Value at each angle `theta` (rad): real and imaginary parts alternately.
#[pyfunction]
pub fn response<'py>(
    py: Python<'py>,
    scene: Source,
    theta: &[u8],
    of: &str,
    from_velocity: bool,
    format: &str,
) -> Result<Bound<'py, PyByteArray>, Refusal> {
    let theta = arrays::finite("theta", theta, "rad")?;
    let parts = py.detach(|| -> Result<Vec<f64>, Refusal> {
        let response = transfer(&scene, of, from_velocity, format)?;
        Ok(theta.iter().map(|&theta| response.at_angle(theta)).flat_map(|z| [z.re, z.im]).collect())
    })?;
    Ok(arrays::to_python(py, &parts)?)
}

fn transfer(
    scene: &Source,
    of: &str,
    from_velocity: bool,
    format: &str,
) -> Result<Response, Refusal> {
    let format = format_of(format)?;
    let scene = scene.read(Purpose::Simulate)?.scene;
    let transfers = LoopTransfers::in_format(&scene, format).map_err(SimulationError::from)?;
    let response = Response::new(match of {
        "environment" => transfers.environment,
        "controller" => transfers.controller,
        "equivalent" => transfers.equivalent,
        _ => {
            let bound = "it must be one of environment, controller, equivalent";
            return Err(Refusal::argument("of", &format!("{of:?}"), bound));
        }
    });
    Ok(if from_velocity { response.from_velocity(scene.timing.period) } else { response })
}
