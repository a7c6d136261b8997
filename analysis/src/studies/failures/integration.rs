//! Methods of integration that show a wrong behaviour of a loop (theory, section 9).

use super::setting::*;
use crate::simulation::method::Method;
use crate::simulation::plant::Plant;
use crate::simulation::{Experiment, Integration};
use crate::stability::critical_stiffness;
use crate::studies::tradeoff::simulation;

/// Two masses in a hand, of which the first has motor, encoder and all of the device's damping to
/// the ground, so that this is its passivity (theory, section 3.2): the knob's.
fn two_masses() -> Plant {
    let [_, held] = simulation::cases();
    held.experiment.plant
}

/// Explicit Euler: a stable device grows.
pub fn explicit_euler() -> Result<CaseResult, StudyError> {
    let scene = coupled(KNOB, wall_of(500.0, 0.0, 1));
    let experiment = Experiment { plant: two_masses(), ..Experiment::still(&scene) };
    let by = |name, integration| MethodResult::eigenvalues(name, &experiment, integration);
    let euler = |substeps| {
        by(name(Method::Euler, substeps), Integration { method: Method::Euler, substeps })
    };
    let methods = vec![euler(1)?, euler(20)?];
    let truth = by(Method::Exact.name().to_owned(), Integration::default())?;
    let mut certified =
        loop_run("the certified wall", &scene, KNOBS, Outcome::Converges).pushed(1.0, 3000);
    certified.experiment.plant = two_masses();
    Ok(CaseResult::of(&scene, methods, truth, [certified]))
}

/// Semi-implicit Euler with few steps: an oscillating wall comes to rest.
pub fn semi_implicit_euler() -> Result<CaseResult, StudyError> {
    let scene = rigid(KNOB, wall_of(1500.0, 0.0, 0));
    let by = |method, substeps| by_limit(&Experiment::still(&scene), method, substeps, 1500.0);
    let methods = [1, 2, 10].map(|substeps| by(Method::SemiImplicit, substeps));
    let methods = methods.into_iter().collect::<Result<_, _>>()?;
    let shakes = loop_run("1500 N m/rad", &scene, KNOBS, Outcome::Diverges)
        .pushed(1.0, 3000)
        .with_claimed_passivity(2.0);
    let rests = rigid(KNOB, wall_of(900.0, 0.0, 0));
    let rests = loop_run("900 N m/rad", &rests, KNOBS, Outcome::Converges).pushed(1.0, 3000);
    Ok(CaseResult::of(&scene, methods, by(Method::Exact, 1)?, [shakes, rests]))
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
