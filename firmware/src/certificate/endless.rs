//! The mean torque of what repeats in every turn: a torque profile through a nonlinear encoder (theory, section
//! 18.4), and learnt cogging, whose mean over the encoder's angle is not zero (section 18.6).

use super::loop_intervals::LoopIntervals;
use super::profile::ExtremeSlopes;
use crate::environment::{EnvironmentModel, Profile};
use crate::passivity::interval::Interval;
use crate::scene::Scene;

const QUARTER_OF_PI: Interval = Interval::decimal(core::f64::consts::FRAC_PI_4);

/// Largest mean torque in N m of an endless torque profile that a nonlinear encoder reads and of the anticogging,
/// and so the friction that keeps them from turning the device. `None` if it is zero.
pub(super) const fn mean_torque<E: EnvironmentModel>(
    scene: &Scene,
    n: &LoopIntervals,
) -> Option<Interval> {
    let of_profile = match scene.environment.profile() {
        Some(profile) if E::PROFILE.exists && profile.ends.is_none() => {
            by_inl::<E>(profile, scene, n)
        }
        _ => Interval::ZERO,
    };
    let mean = match &scene.environment.parts().anticogging {
        Some(anticogging) if E::PARTS.anticogging => {
            // The bound on its mean over the angle of the encoder has a few roundings.
            let mean = Interval::decimal(anticogging.mean() * (1.0 + 4.0 * f64::EPSILON));
            of_profile.add(mean).add(by_inl::<E>(&anticogging.profile(0), scene, n))
        }
        _ => of_profile,
    };
    if mean.is_zero() { None } else { Some(mean) }
}

/// What a nonlinear encoder adds to the mean of a torque up to `f` with slopes up to `M`: at most
/// `min(M eta pi/4, f eta/(1 - eta))` (equation 68).
const fn by_inl<E: EnvironmentModel>(
    profile: &Profile,
    scene: &Scene,
    n: &LoopIntervals,
) -> Interval {
    let encoder = scene.latency.encoder;
    if !E::MAY_MISREAD || encoder.linearity == 0.0 {
        return Interval::ZERO;
    }
    let eta = Interval::decimal(encoder.linearity);
    let largest = match scene.torque_limit {
        Some(limit) => profile.torque.min(limit),
        None => profile.torque,
    };
    let by_torque = Interval::decimal(largest).mul(eta).div(Interval::ONE.sub(eta));
    let slope = ExtremeSlopes::of_table::<E>(profile, n).steepest();
    by_torque.min(slope.mul(eta).mul(QUARTER_OF_PI))
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
