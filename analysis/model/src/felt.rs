//! The effect of a scene on the hand: the stiffness at the handle.
//!
//! Coupling and environment are two springs in series: a torque `F` moves the handle by `V F` more than the
//! environment's position, where `V` is the coupling's compliance at rest.

use haptic_servo::matched::MatchedCoupling;
use haptic_servo::number::Format;
use haptic_servo::passivity::polynomial::{Polynomial, UnitRoot};
use haptic_servo::scene::{Coupling, Scene};

/// Compliance in rad/(N m) at rest between handle and environment; 0 if they are rigidly connected, `None` if
/// the coupling does not exist. That of a matched coupling is about `(T + d + tau)/(2 delta)`, with all of
/// its delays and lags.
pub fn compliance(scene: &Scene) -> Option<f64> {
    match scene.coupling {
        Coupling::Rigid => Some(0.0),
        Coupling::Spring { stiffness } => Some(1.0 / stiffness),
        Coupling::Matched => {
            let (timing, delta) = (scene.timing, scene.device.passivity());
            let matched = MatchedCoupling::of(
                timing.period,
                timing.worst_period,
                delta,
                &scene.latency,
                Format::F64,
            )?;
            let (numerator, denominator) = matched.transfer()?;
            let at_rest = |p: &Polynomial| p.at_unit_root(UnitRoot::Plus).midpoint();
            Some(at_rest(&numerator) / at_rest(&denominator))
        }
    }
}

/// Stiffness in N m/rad at the handle of the scene's wall; `None` without a wall.
pub fn stiffness(scene: &Scene) -> Option<f64> {
    let wall = scene.environment.wall()?.stiffness;
    Some(wall / (1.0 + wall * compliance(scene)?))
}
