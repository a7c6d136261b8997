//! Methods of integration that show a wrong behaviour of a loop (theory, section 9).

use haptic_servo::servo::Transducers;

use super::case::{CaseResult, FailureError};
use super::method_result::{MethodResult, MethodVerdict};
use super::motion::Outcome;
use super::setting::{KNOB, KNOBS, coupled, loop_run, rigid, wall_of};
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
pub fn explicit_euler() -> Result<CaseResult, FailureError> {
    let scene = coupled(KNOB, wall_of(500.0, 0.0, 1));
    let experiment = Experiment { plant: two_masses(), ..Experiment::still(&scene) };
    let mut methods = Vec::new();
    for substeps in [1, 20] {
        let integration = Integration { method: Method::Euler, substeps };
        methods.push(MethodResult::eigenvalues(
            name(Method::Euler, substeps),
            &experiment,
            integration,
        )?);
    }
    let truth =
        MethodResult::eigenvalues(Method::Exact.name(), &experiment, Integration::default())?;
    let mut certified =
        loop_run("the certified wall", &scene, KNOBS, Outcome::Converges).pushed(1.0, 3000);
    certified.experiment.plant = experiment.plant;
    Ok(CaseResult {
        methods,
        certificate: MethodResult::certificate(&scene),
        truth,
        runs: vec![certified],
    })
}

/// Semi-implicit Euler with few steps: an oscillating wall comes to rest.
pub fn semi_implicit_euler() -> Result<CaseResult, FailureError> {
    let scene = rigid(KNOB, wall_of(1500.0, 0.0, 0));
    let experiment = Experiment::still(&scene);
    let mut methods = Vec::new();
    for substeps in [1, 2, 10] {
        methods.push(by_limit(&experiment, Method::SemiImplicit, substeps, 1500.0)?);
    }
    let truth = by_limit(&experiment, Method::Exact, 1, 1500.0)?;
    let shakes = loop_run("1500 N m/rad", &scene, KNOBS, Outcome::Diverges)
        .pushed(1.0, 3000)
        .with_claimed_passivity(2.0);
    let rests = rigid(KNOB, wall_of(900.0, 0.0, 0));
    let rests = loop_run("900 N m/rad", &rests, KNOBS, Outcome::Converges).pushed(1.0, 3000);
    let certificate = MethodResult::certificate(&scene);
    Ok(CaseResult { methods, certificate, truth, runs: vec![shakes, rests] })
}

/// Runge-Kutta of fourth order with one step per tick: two masses in a hand.
pub fn runge_kutta() -> Result<CaseResult, FailureError> {
    const STIFFNESS: f64 = 2750.0;
    // Friction hides slow growth; a finer encoder needs less friction. The motor is strong enough for a
    // motion that friction does not hide.
    let counts_per_turn = f64::from(1 << 22);
    let fine = Transducers { counts_per_turn, full_scale_torque: 100.0, ..KNOBS };
    let scene = rigid(KNOB, wall_of(STIFFNESS, 0.0, 0));
    let experiment = Experiment { plant: two_masses(), ..Experiment::still(&scene) };
    let methods = vec![
        by_limit(&experiment, Method::Rk4, 1, STIFFNESS)?,
        by_limit(&experiment, Method::Tustin, 1, STIFFNESS)?,
    ];
    let truth = by_limit(&experiment, Method::Exact, 1, STIFFNESS)?;
    let mut runs = vec![
        loop_run("2750 N m/rad", &scene, fine, Outcome::Diverges)
            .pushed(2.0, 15_000)
            .with_claimed_passivity(3.0),
        loop_run("900 N m/rad", &rigid(KNOB, wall_of(900.0, 0.0, 0)), fine, Outcome::Converges)
            .pushed(2.0, 15_000),
    ];
    for loop_run in &mut runs {
        loop_run.experiment.plant = two_masses();
    }
    Ok(CaseResult { methods, certificate: MethodResult::certificate(&scene), truth, runs })
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
) -> Result<MethodResult, FailureError> {
    let integration = Integration { method, substeps };
    let limit = critical_stiffness(experiment, integration)?.unwrap_or(f64::INFINITY);
    let verdict = MethodVerdict::of(stiffness < limit);
    Ok(MethodResult::new(name(method, substeps), verdict, limit, "stable up to {} N m/rad"))
}
