//! Frequency grids: the narrow minimum between two points.

use std::f64::consts::PI;

use haptic_servo::certificate::LoopTransfers;
use haptic_servo::environment::{Environment, Rational};

use super::setting::*;
use crate::device::Hand;
use crate::response::Response;
use crate::simulation::SimulationError;

/// Distance of the resonance's pole from the unit circle.
const NARROW: f64 = 1e-6;
/// Points of the grids.
const GRIDS: [u32; 4] = [100, 1000, 10_000, 100_000];
/// Depth of the minimum over the device's passivity.
const DEPTH: f64 = 100.0;

/// An active resonance: its real part is negative within a millionth of a radian, and nowhere else
/// by more than the device's passivity.
pub fn grid() -> Result<CaseReport, StudyError> {
    let scene = coupled(PADDLE, resonance(DEPTH, angle()));
    let delta = PADDLE.damping;
    let velocity = equivalent(&scene)?.from_velocity(PERIOD);
    let methods = GRIDS.map(|points| {
        let angles = (1..points).map(|point| PI * f64::from(point) / f64::from(points));
        let alpha = angles.map(|theta| -velocity.at_angle(theta).re).fold(f64::MIN, f64::max);
        let (name, verdict) = (format!("grid of {points}"), MethodVerdict::of(alpha < delta));
        let reason = "the least real part on the grid asks for {} N m s/rad";
        MethodResult::new(name, verdict, alpha, reason)
    });
    let truth = MethodResult::in_no_hand(&scene)?;
    // A spring with which the device resonates at the minimum.
    let stiffness = PADDLE.inertia * (angle() / PERIOD).powi(2);
    let mut grows = loop_run("in a hand that resonates there", &scene, PADDLES, Outcome::Diverges);
    grows.experiment.plant =
        grows.experiment.plant.with_hand(Hand { stiffness, ..Hand::default() });
    CaseReport::of(&scene, methods.into(), truth, &[grows.pushed(1.0, 300_000)])
}

/// In the middle between two points of the finest grid, a third of the way around.
fn angle() -> f64 {
    let finest = f64::from(GRIDS[GRIDS.len() - 1]);
    PI * ((finest / 3.0).floor() + 0.5) / finest
}

/// `E = -g (z - 1) (z^2 - 1) / (z (z^2 - 2 r c z + r^2))`: from velocity, `-depth delta` at the angle whose
/// cosine is `c`, within `1 - r` of it.
fn resonance(depth: f64, angle: f64) -> Environment {
    let r = 1.0 - NARROW;
    let gain = depth * PADDLE.damping * NARROW / PERIOD;
    // With two declared zeros at 1.
    let denominator = [1.0, -2.0 * r * angle.cos(), r * r, 0.0];
    Environment::Rational(Rational { unit_zeros: 2, ..rational(&[-gain, -gain], &denominator) })
}

/// The environment that gives this scene's controller behind the standard coupling.
fn equivalent(scene: &Scene) -> Result<Response, StudyError> {
    Ok(Response::new(LoopTransfers::of(scene).map_err(SimulationError::from)?.equivalent))
}
