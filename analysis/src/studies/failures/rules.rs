//! Rules of thumb and theorems short of a condition.

use std::f64::consts::PI;

use firmware::environment::{Coefficients, Environment, Rational};
use firmware::scene::{Device, Scene};
use nalgebra::Complex;

use super::case::{FailureError, Study};
use super::claim::{Claim, Says};
use super::fate::End;
use super::setting::{
    KNOB, KNOBS, PADDLE, PADDLES, PERIOD, coupled, friction_for_rest, rigid, trial, wall_of,
};
use super::trial::Trial;
use crate::limits::{Limit, largest_stiffness};
use crate::response::Response;
use crate::simulation::closed_loop::transfers;
use crate::simulation::{Experiment, Integration, SimulationError};

/// Continuous time: a mass, a damper and any spring come to rest.
pub fn continuous_time() -> Result<Study, FailureError> {
    const STIFFNESS: f64 = 5000.0;
    let scene = rigid(KNOB, wall_of(STIFFNESS, 0.0, 0));
    // m s^2 + b s + K = 0
    let Device { inertia, damping, .. } = KNOB;
    let root = Complex::from(damping * damping - 4.0 * inertia * STIFFNESS).sqrt();
    let slowest = ((root - damping) / (2.0 * inertia)).re;
    let because = "the slowest root of m s^2 + b s + K has the real part {} 1/s, whatever K > 0";
    // K/(j w): a spring gives back what it took.
    let lossless = "in continuous time a spring's real part is {} N m s/rad at every frequency";
    let claims = vec![
        Claim::new("continuous time", Says::of(slowest < 0.0), slowest, because),
        Claim::new("continuous-time passivity", Says::of(0.0 < damping), 0.0, lossless),
    ];
    let shakes = trial("5000 N m/rad", &scene, KNOBS, End::Grows).pushed(1.0, 1000).believing(10.0);
    let rests = rigid(KNOB, wall_of(900.0, 0.0, 0));
    let rests = trial("900 N m/rad", &rests, KNOBS, End::Rests).pushed(1.0, 3000);
    study(claims, &scene, vec![shakes, rests])
}

/// Colgate's and Schenkel's inequality alone: a negative spring passes.
pub fn negative_spring() -> Result<Study, FailureError> {
    const STIFFNESS: f64 = -200.0;
    let one = |value: f64| Coefficients::new(&[value]).expect("one coefficient fits");
    let spring = |stiffness: f64| {
        let (numerator, denominator) = (one(stiffness), one(1.0));
        Environment::Rational(Rational { numerator, denominator, delay: 0, unit_zeros: 0 })
    };
    let scene = rigid(KNOB, spring(STIFFNESS));
    let needed = colgate_schenkel(&scene)?;
    let because = "b > T/(2 (1 - cos)) Re((1 - e^-j) C) asks for b above {} N m s/rad";
    let enough = scene.device.damping > needed;
    let residue = controller(&scene)?.at(Complex::from(1.0)).re;
    let pulls = "and C(1) = {} N m/rad must not be negative";
    let claims = vec![
        Claim::new("Colgate-Schenkel without the residue", Says::of(enough), needed, because),
        Claim::new("the same with it", Says::of(enough && residue >= 0.0), residue, pulls),
    ];
    let runs_away = trial("-200 N m/rad", &scene, KNOBS, End::Grows).pushed(0.01, 2000);
    let rests = trial("200 N m/rad", &rigid(KNOB, spring(-STIFFNESS)), KNOBS, End::Rests);
    let mut rests = rests.pushed(1.0, 3000);
    rests.experiment.friction = friction_for_rest(&rigid(KNOB, wall_of(200.0, 0.0, 0)), &KNOBS);
    study(claims, &scene, vec![runs_away.believing(10.0), rests])
}

/// The damping in N m s/rad that Colgate's and Schenkel's inequality asks for, on a fine grid.
fn colgate_schenkel(scene: &Scene) -> Result<f64, FailureError> {
    const POINTS: u32 = 10_000;
    let controller = controller(scene)?;
    let at = |theta: f64| {
        let z = Complex::from_polar(1.0, theta);
        let increment = (Complex::from(1.0) - z.inv()) * controller.at(z);
        scene.timing.period / (2.0 * (1.0 - theta.cos())) * increment.re
    };
    let angles = (1..=POINTS).map(|point| PI * f64::from(point) / f64::from(POINTS));
    Ok(angles.map(at).fold(f64::NEG_INFINITY, f64::max))
}

/// From the sampled position to the torque.
fn controller(scene: &Scene) -> Result<Response, FailureError> {
    Ok(Response::new(transfers(scene).map_err(SimulationError::from)?.controller))
}

/// The rule `K < (b + B) / (T/2 + t_d)` at `B = b`.
pub fn damped_rule() -> Result<Study, FailureError> {
    const DELAY: usize = 1;
    let damping = PADDLE.damping;
    let limit = (PADDLE.damping + damping) / (PERIOD * (0.5 + DELAY as f64));
    let stiffness = 0.7 * limit;
    let scene = rigid(PADDLE, wall_of(stiffness, damping, DELAY));
    let undamped = PADDLE.damping / (PERIOD * (0.5 + DELAY as f64));
    let rule = |by, limit| Claim::new(by, Says::of(stiffness < limit), limit, "allows {} N m/rad");
    let claims = vec![rule("K < (b + B)/(T/2 + t_d)", limit), rule("K < b/(T/2 + t_d)", undamped)];
    let shakes = trial("B = b, 0.7 of that", &scene, PADDLES, End::Grows).pushed(5.0, 100);
    let without = coupled(PADDLE, wall_of(0.0, 0.5 * damping, DELAY));
    let Limit::RoundUp3(most) = largest_stiffness(&without) else {
        return Err(FailureError::NoLimit);
    };
    let rests = coupled(PADDLE, wall_of(0.95 * most, 0.5 * damping, DELAY));
    let rests = trial("B = b/2 behind the coupling", &rests, PADDLES, End::Rests);
    study(claims, &scene, vec![shakes.believing(10.0), rests.pushed(1.0, 2000)])
}

/// A study whose truth is the eigenvalues of the device in no hand.
fn study(claims: Vec<Claim>, scene: &Scene, trials: Vec<Trial>) -> Result<Study, FailureError> {
    let alone = Experiment::still(scene);
    let truth =
        Claim::eigenvalues("exact exponential, in no hand", &alone, Integration::default())?;
    Ok(Study { claims, certificate: Claim::certificate(scene), truth, trials })
}
