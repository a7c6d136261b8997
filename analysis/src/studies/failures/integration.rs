//! Methods of integration that show a wrong behaviour of a loop (theory, section 9).

use haptic_servo::servo::Transducers;

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

/// Runge-Kutta of fourth order with one step per tick: two masses in a hand.
pub fn runge_kutta() -> Result<CaseResult, StudyError> {
    const STIFFNESS: f64 = 2750.0;
    // Friction hides slow growth; a finer encoder needs less friction. The motor is strong enough for a
    // motion that friction does not hide.
    let counts_per_turn = f64::from(1 << 22);
    let fine = Transducers { counts_per_turn, full_scale_torque: 100.0, ..KNOBS };
    let scene = rigid(KNOB, wall_of(STIFFNESS, 0.0, 0));
    let experiment = Experiment { plant: two_masses(), ..Experiment::still(&scene) };
    let by = |method| by_limit(&experiment, method, 1, STIFFNESS);
    let methods = vec![by(Method::Rk4)?, by(Method::Tustin)?];
    let rests = rigid(KNOB, wall_of(900.0, 0.0, 0));
    let mut runs = [
        loop_run("2750 N m/rad", &scene, fine, Outcome::Diverges).with_claimed_passivity(3.0),
        loop_run("900 N m/rad", &rests, fine, Outcome::Converges),
    ]
    .map(|loop_run| loop_run.pushed(2.0, 15_000));
    runs.iter_mut().for_each(|loop_run| loop_run.experiment.plant = two_masses());
    Ok(CaseResult::of(&scene, methods, by(Method::Exact)?, runs))
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
