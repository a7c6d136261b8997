//! The mean torque of a torque profile that repeats without end, through a nonlinear encoder (theory, section
//! 18.4).

use super::loop_intervals::LoopIntervals;
use super::profile::ExtremeSlopes;
use crate::environment::EnvironmentModel;
use crate::passivity::interval::Interval;
use crate::scene::Scene;

const QUARTER_OF_PI: Interval = Interval::decimal(core::f64::consts::FRAC_PI_4);

/// Largest mean torque in N m of an endless torque profile that a nonlinear encoder reads, and so the friction
/// that keeps it from turning the device: of a torque up to `f` with slopes up to `M` at most
/// `min(M eta pi/4, f eta/(1 - eta))` (equation 68). `None` of a profile with end stops, and of a linear
/// encoder.
pub(super) const fn mean_torque<E: EnvironmentModel>(
    scene: &Scene,
    n: &LoopIntervals,
) -> Option<Interval> {
    let encoder = scene.latency.encoder;
    let profile = some!(scene.environment.profile());
    if encoder.linearity == 0.0 || profile.ends.is_some() {
        return None;
    }
    let eta = Interval::decimal(encoder.linearity);
    let largest = match scene.torque_limit {
        Some(limit) => profile.torque.min(limit),
        None => profile.torque,
    };
    let by_torque = Interval::decimal(largest).mul(eta).div(Interval::ONE.sub(eta));
    let slope = ExtremeSlopes::of_table::<E>(profile, n).steepest();
    Some(by_torque.min(slope.mul(eta).mul(QUARTER_OF_PI)))
}

/// Whether the stated friction is less than that.
pub(super) const fn turns_by_inl<E: EnvironmentModel>(scene: &Scene, n: &LoopIntervals) -> bool {
    match mean_torque::<E>(scene, n) {
        Some(needed) => {
            let friction = scene.latency.encoder.friction;
            friction.is_nan() || friction < needed.hi()
        }
        None => false,
    }
}
