//! Verdicts, as in `haptic certify`, and the index alone.

use haptic_model::file::Purpose;
use haptic_model::number;
use haptic_model::verdict::judge_file;
use haptic_servo::certificate::assess_in;
use haptic_servo::number::Format;
use haptic_servo::passivity::interval::Interval;
use pyo3::prelude::*;
use rayon::prelude::*;
use serde_json::json;

use crate::check_signals;
use crate::refusal::Refusal;
use crate::source::Source;

/// Scenes between two checks for a signal.
const CHUNK: usize = 256;

/// The output of `haptic certify --json` for a scene.
#[pyfunction]
pub fn certify(py: Python<'_>, scene: Source, format: &str) -> Result<String, Refusal> {
    py.detach(|| verdict(&scene, format_of(format)?))
}

/// The same for many scenes, on every core; `{"error": ..}` for an invalid scene.
#[pyfunction]
pub fn certify_many(
    py: Python<'_>,
    scenes: Vec<Source>,
    format: &str,
) -> Result<Vec<String>, Refusal> {
    py.detach(|| {
        let format = format_of(format)?;
        let or_error = |scene: &Source| {
            verdict(scene, format)
                .unwrap_or_else(|refusal| json!({ "error": refusal.to_string() }).to_string())
        };
        let mut answers = Vec::with_capacity(scenes.len());
        for chunk in scenes.chunks(CHUNK) {
            check_signals()?;
            answers.par_extend(chunk.par_iter().map(or_error));
        }
        Ok(answers)
    })
}

/// Both ends of the enclosure of the index in N m s/rad: of the environment alone, or of `E'`, the
/// environment behind the excess of its coupling over the standard one. None if there is no index.
#[pyfunction]
pub fn index(
    py: Python<'_>,
    scene: Source,
    coupled: bool,
    format: &str,
) -> Result<Option<(f64, f64)>, Refusal> {
    py.detach(|| {
        let format = format_of(format)?;
        let file = scene.read(Purpose::Certify)?;
        number::fits(&file.scene, format)?;
        let assessment = assess_in(&file.scene, format);
        let found = if coupled { assessment.alpha_coupled } else { assessment.alpha };
        Ok(found.map(|index: Interval| (index.lo(), index.hi())))
    })
}

/// The number format with a name.
pub fn format_of(name: &str) -> Result<Format, Refusal> {
    number::format(name).map_err(|bound| Refusal::argument("format", &format!("{name:?}"), &bound))
}

fn verdict(scene: &Source, format: Format) -> Result<String, Refusal> {
    let file = scene.read(Purpose::Certify)?;
    number::fits(&file.scene, format)?;
    Ok(serde_json::to_string(&judge_file(&file, format))?)
}
