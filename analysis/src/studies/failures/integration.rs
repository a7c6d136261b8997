//! Methods of integration that show a wrong behaviour of a loop (theory, section 9).

use super::setting::*;
use crate::simulation::method::Method;
use crate::simulation::{Experiment, Integration};
use crate::stability::critical_stiffness;

/// Semi-implicit Euler with few steps: an oscillating wall comes to rest.
pub fn semi_implicit_euler() -> Result<CaseReport, StudyError> {
    let scene = rigid(KNOB, wall_of(1500.0, 0.0, 0));
    let by = |method, substeps| by_limit(&Experiment::still(&scene), method, substeps, 1500.0);
    let methods = [1, 2, 10].map(|substeps| by(Method::SemiImplicit, substeps));
    let methods = methods.into_iter().collect::<Result<_, _>>()?;
    let shakes = loop_run("1500 N m/rad", &scene, KNOBS, Outcome::Diverges)
        .pushed(1.0, 3000)
        .with_claimed_passivity(2.0);
    let rests = rigid(KNOB, wall_of(900.0, 0.0, 0));
    let rests = loop_run("900 N m/rad", &rests, KNOBS, Outcome::Converges).pushed(1.0, 3000);
    CaseReport::of(&scene, methods, by(Method::Exact, 1)?, &[shakes, rests])
}

/// The name of a method with a number of steps.
fn name(method: Method, substeps: u32) -> String {
    let steps = if substeps == 1 { "step" } else { "steps" };
    match method {
        Method::Exact => method.name().to_owned(),
        _ => format!("{}, {substeps} {steps} a tick", method.name()),
    }
}

/// A method's verdict on a stiffness, and the largest that it accepts.
fn by_limit(
    experiment: &Experiment,
    method: Method,
    substeps: u32,
    stiffness: f64,
) -> Result<MethodResult, StudyError> {
    let integration = Integration { method, substeps };
    let limit = critical_stiffness(experiment, integration)?.unwrap_or(f64::INFINITY);
    Ok(MethodResult::bound(name(method, substeps), stiffness, limit, "stable up to {} N m/rad"))
}
