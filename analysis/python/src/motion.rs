//! The motion of a scene: its samples, and whether it decays.

use haptic_model::file::Purpose;
use haptic_model::nominal_latency::left_out;
use haptic_model::simulation::tick_status::TickStatus;
use haptic_model::simulation::{Experiment, Integration, Simulator, Trajectory};
use haptic_model::stability::judge;
use pyo3::prelude::*;
use pyo3::types::{PyByteArray, PyDict};

use crate::refusal::Refusal;
use crate::source::Source;
use crate::{arrays, check_signals, integration};

/// Samples between two checks for a signal.
const CHUNK: usize = 4096;

/// A motion and its notes.
struct Motion {
    period: f64,
    trajectory: Trajectory,
    left_out: Option<&'static str>,
    overflow: Option<String>,
}

/// The words of a tick's status, in the order of their codes.
pub fn tick_statuses() -> Vec<&'static str> {
    TickStatus::all().map(TickStatus::as_str).collect()
}

/// The columns of `haptic simulate --json` as bytes, the status of each tick as its code; `period` in s;
/// `overflow`, a text if the motion leaves the range of numbers.
#[pyfunction]
pub fn simulate<'py>(
    py: Python<'py>,
    scene: Source,
    method: &str,
    substeps: i64,
) -> Result<Bound<'py, PyDict>, Refusal> {
    let motion = py.detach(|| motion(&scene, integration::integration(method, substeps)?))?;
    let trajectory = &motion.trajectory;
    let columns = PyDict::new(py);
    columns.set_item("position", arrays::to_python(py, &trajectory.position)?)?;
    columns.set_item("velocity", arrays::to_python(py, &trajectory.velocity)?)?;
    columns.set_item("torque", arrays::to_python(py, &trajectory.torque)?)?;
    columns.set_item("limit", PyByteArray::new(py, &codes(&trajectory.limit)))?;
    columns.set_item("period", motion.period)?;
    columns.set_item("left_out", motion.left_out)?;
    columns.set_item("overflow", motion.overflow)?;
    Ok(columns)
}

/// The output of `haptic stability --json` for a scene.
#[pyfunction]
pub fn stability(
    py: Python<'_>,
    scene: Source,
    method: &str,
    substeps: i64,
) -> Result<String, Refusal> {
    py.detach(|| {
        let integration = integration::integration(method, substeps)?;
        let file = scene.read(Purpose::Simulate)?;
        let stability = judge(&Experiment::at_rest(&file), integration)?;
        Ok(serde_json::to_string(&stability)?)
    })
}

fn motion(scene: &Source, integration: Integration) -> Result<Motion, Refusal> {
    let file = scene.read(Purpose::Simulate)?;
    let experiment = Experiment::of(&file, scene.folder())?;
    let mut simulator = Simulator::new(&experiment, integration)?;
    let mut whole = Trajectory::default();
    while whole.samples() < experiment.samples {
        let wanted = CHUNK.min(experiment.samples - whole.samples());
        let mut chunk = Trajectory::of_length(wanted);
        simulator.fill(&mut chunk);
        let is_over = chunk.samples() < wanted;
        whole.position.append(&mut chunk.position);
        whole.velocity.append(&mut chunk.velocity);
        whole.torque.append(&mut chunk.torque);
        whole.limit.append(&mut chunk.limit);
        if is_over {
            break;
        }
        check_signals()?;
    }
    let overflow = experiment.completed(whole.samples()).err().map(|error| error.to_string());
    Ok(Motion {
        period: experiment.scene.timing.period,
        trajectory: whole,
        left_out: left_out(&experiment.scene.latency),
        overflow,
    })
}

/// The place of each status in [`tick_statuses`].
fn codes(limit: &[TickStatus]) -> Vec<u8> {
    let all: Vec<TickStatus> = TickStatus::all().collect();
    let code = |status: &TickStatus| all.iter().position(|one| one == status).unwrap_or(0) as u8;
    limit.iter().map(code).collect()
}
