//! The loss of the device's passivity by motion through a current loop (theory, section 15.8).
//!
//! Motion induces a voltage, and the feedback removes its current one instant late. The map from velocity to
//! the torque of that current lacks a small passivity, which is subtracted from the device's damping.

use super::motor::{Motor, Winding};
use super::plant::Plant;
use super::resolution::CurrentResolution;
use crate::passivity::interval::Interval;

/// The data of a current loop that a measurement of the device needs.
///
/// The feedback leaves a path from the velocity through the back-EMF to the torque: a device measured through
/// the loop has this path in addition to its own inertia and damping. The resolution of the torque is that of
/// the current.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "wire", derive(serde::Serialize))]
pub struct TorqueSource {
    /// `Kt Ke`, torque in N m/A times back-EMF in V s/rad.
    pub gain: f64,
    /// `R` in ohm.
    pub resistance: f64,
    /// `L` in H.
    pub inductance: f64,
    /// `K`, the gain of the feedback's loop.
    pub feedback: f64,
    /// `h`, time in s between two instants.
    pub instant: f64,
    /// Damping in N m s/rad that the loop takes, rounded up (equation 52); infinite if no bound is known.
    pub loss: f64,
    /// Torque in N m of a count of the current: [`CurrentResolution::step`].
    pub step: f64,
    /// Deviation of the torque in N m after the current has changed its sign:
    /// [`CurrentResolution::zero_crossing`].
    pub zero_crossing: f64,
}

impl TorqueSource {
    /// The data for a motor, the feedback of its current, and the resolution of its torque.
    pub(super) const fn of(
        motor: &Motor,
        plant: &Plant,
        instant: f64,
        resolution: &CurrentResolution,
    ) -> Self {
        Self {
            gain: motor.torque_constant * motor.back_emf(),
            resistance: motor.resistance,
            inductance: motor.inductance,
            feedback: plant.feedback,
            instant,
            loss: motion_loss(motor, plant, instant),
            step: resolution.step,
            zero_crossing: resolution.zero_crossing,
        }
    }
}

/// The most power that the current of the back-EMF gives to a motion on average, over the mean square of its
/// velocity, in N m s/rad: `Kt Ke h/(4 sqrt(3) L)`, rounded up (equation 52). Infinite if equation 53 does
/// not hold, so that no bound is known.
const fn motion_loss(motor: &Motor, plant: &Plant, instant: f64) -> f64 {
    let (resistance, inductance) =
        (Interval::decimal(motor.resistance), Interval::decimal(motor.inductance));
    let torque = Interval::decimal(motor.torque_constant);
    let instant = Interval::decimal(instant);
    let part = Interval::ONE.div(Interval::exact(48.0).sqrt());
    let ratio = resistance.mul(instant).div(inductance);
    if !is_positive(ratio, Interval::exact(plant.feedback), part) {
        return f64::INFINITY;
    }
    // `Motor::back_emf`, enclosed.
    let back_emf = match motor.winding {
        Winding::Brushed => torque,
        Winding::Brushless { .. } => torque.double().div(Interval::exact(3.0)),
    };
    torque.mul(back_emf).mul(instant).div(inductance).mul(part).hi()
}

/// Whether the polynomial of equation 53 is positive, for `rho = R h/L`, the gain `K` of the feedback, and
/// `lambda = 1/(4 sqrt(3))`.
const fn is_positive(rho: Interval, feedback: Interval, lambda: Interval) -> bool {
    let a = rho.exp_of_negative();
    let kappa = feedback.mul(rho).div(Interval::ONE.sub(a));
    let x = lambda.mul(rho);
    let g = Interval::ONE.add(x.double());
    let (q, twice) = (rho.mul(Interval::ONE.add(x)), lambda.double());
    let (slope, gain) = (q.div(g.mul(g)), kappa.mul(twice));
    let odd = kappa.div(g);
    // By Bernstein over c from -1 to 1: the values at the ends, and the constant less the quadratic coefficient.
    let left = twice.double().add(gain.mul(Interval::ONE.add(a)));
    let right =
        slope.sub(gain.mul(Interval::ONE.sub(a))).add(odd.mul(a.double().sub(Interval::ONE)));
    let constant = twice.add(slope.half()).sub(gain.mul(a)).sub(odd.half());
    let middle = constant.sub(gain.double().mul(a)).sub(odd.mul(a));
    let is_convex = left.mul(right).sub(middle.mul(middle)).is_positive();
    left.is_positive() && right.is_positive() && (middle.is_positive() || is_convex)
}
