//! Methods of integration that show a loop as it is not (theory, section 9).

use firmware::servo::Transducers;

use super::claim::{Claim, Says};
use super::fate::End;
use super::setting::{KNOB, KNOBS, coupled, rigid, trial, wall_of};
use super::{FailureError, Study};
use crate::chain::{Chain, Link, Mass};
use crate::device::Hand;
use crate::simulation::method::Method;
use crate::simulation::plant::Plant;
use crate::simulation::{Experiment, Stride};
use crate::stability::{closed_loop, critical_stiffness, eigenvalues, radius};

/// Two masses of which the first has motor and encoder: 1183 rad/s, hardly damped.
pub fn two_masses() -> Chain {
    let mass = |inertia, damping| Mass { inertia, damping };
    let link = Link { stiffness: 20_000.0, damping: 0.2 };
    let chain = Chain::new(vec![mass(0.05, 0.5), mass(0.02, 0.0)], vec![link]);
    chain.expect("inertias are positive, nothing else is negative")
}

/// The hand in which the fourth-order method is wrong on these two masses.
pub const HAND: Hand = Hand { inertia: 0.1, damping: 1.0, stiffness: 300.0 };

/// Explicit Euler: a stable device grows.
pub fn explicit_euler() -> Result<Study, FailureError> {
    let chain = two_masses();
    let scene = coupled(chain.as_rigid()?, wall_of(500.0, 0.0, 1));
    let experiment = Experiment { plant: Plant::of(&chain), ..Experiment::still(&scene) };
    let mut claims = Vec::new();
    for substeps in [1, 50] {
        claims.push(by_radius(&experiment, Method::Euler, substeps)?);
    }
    let truth = by_radius(&experiment, Method::Exact, 1)?;
    let mut certified = trial("the certified wall", &scene, KNOBS, End::Rests).pushed(1.0, 3000);
    certified.experiment.plant = experiment.plant;
    Ok(Study { claims, certificate: Claim::certificate(&scene), truth, trials: vec![certified] })
}

/// Semi-implicit Euler in few steps: a wall that shakes comes to rest.
pub fn semi_implicit_euler() -> Result<Study, FailureError> {
    let scene = rigid(KNOB, wall_of(1500.0, 0.0, 0));
    let experiment = Experiment::still(&scene);
    let mut claims = Vec::new();
    for substeps in [1, 2, 10] {
        claims.push(by_limit(&experiment, Method::SemiImplicit, substeps, 1500.0)?);
    }
    let truth = by_limit(&experiment, Method::Exact, 1, 1500.0)?;
    let shakes = trial("1500 N m/rad", &scene, KNOBS, End::Grows).pushed(1.0, 3000).believing(2.0);
    let rests = rigid(KNOB, wall_of(900.0, 0.0, 0));
    let rests = trial("900 N m/rad", &rests, KNOBS, End::Rests).pushed(1.0, 3000);
    let certificate = Claim::certificate(&scene);
    Ok(Study { claims, certificate, truth, trials: vec![shakes, rests] })
}

/// Runge-Kutta of fourth order in one step a tick: two masses in a hand.
pub fn runge_kutta() -> Result<Study, FailureError> {
    const STIFFNESS: f64 = 2450.0;
    // Friction hides what grows slowly; a finer encoder needs less of it. The motor is strong enough
    // for a motion that friction does not hide.
    let counts_per_turn = f64::from(1 << 22);
    let fine = Transducers { counts_per_turn, full_scale_torque: 100.0, ..KNOBS };
    let chain = two_masses();
    let scene = rigid(chain.as_rigid()?, wall_of(STIFFNESS, 0.0, 0));
    let plant = Plant::of(&chain).held(HAND);
    let experiment = Experiment { plant: plant.clone(), ..Experiment::still(&scene) };
    let claims = vec![
        by_limit(&experiment, Method::Rk4, 1, STIFFNESS)?,
        by_limit(&experiment, Method::Tustin, 1, STIFFNESS)?,
    ];
    let truth = by_limit(&experiment, Method::Exact, 1, STIFFNESS)?;
    let mut trials = vec![
        trial("2450 N m/rad", &scene, fine, End::Grows).pushed(2.0, 15_000).believing(3.0),
        trial("900 N m/rad", &rigid(scene.device, wall_of(900.0, 0.0, 0)), fine, End::Rests)
            .pushed(2.0, 15_000),
    ];
    for trial in &mut trials {
        trial.experiment.plant = plant.clone();
    }
    Ok(Study { claims, certificate: Claim::certificate(&scene), truth, trials })
}

/// The name of a method in so many steps.
pub fn name(method: Method, substeps: u32) -> String {
    let method = match method {
        Method::Exact => return "exact exponential".to_owned(),
        Method::Euler => "explicit Euler",
        Method::SemiImplicit => "semi-implicit Euler",
        Method::Rk4 => "Runge-Kutta 4",
        Method::Tustin => "Tustin",
    };
    let steps = if substeps == 1 { "step" } else { "steps" };
    format!("{method}, {substeps} {steps} a tick")
}

/// What the loop's eigenvalues say by a method.
fn by_radius(
    experiment: &Experiment,
    method: Method,
    substeps: u32,
) -> Result<Claim, FailureError> {
    let closed = closed_loop(experiment, Stride { method, substeps })?;
    let radius = radius(&eigenvalues(&closed.matrix)?);
    let says = Says::of(radius <= 1.0);
    let because = "the largest eigenvalue has the modulus {}";
    Ok(Claim::new(name(method, substeps), says, radius, because))
}

/// What a method says about a stiffness, and up to which it would say yes.
fn by_limit(
    experiment: &Experiment,
    method: Method,
    substeps: u32,
    stiffness: f64,
) -> Result<Claim, FailureError> {
    let stride = Stride { method, substeps };
    let limit = critical_stiffness(experiment, stride)?.unwrap_or(f64::INFINITY);
    let says = Says::of(stiffness < limit);
    Ok(Claim::new(name(method, substeps), says, limit, "stable up to {} N m/rad"))
}
