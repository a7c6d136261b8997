//! The current loop as the actuator of a servo: the winding, the reference model and the feedback as numbers of one
//! instant (theory, sections 15.1 and 15.2), and how the torque responds to codes and to motion.

use super::drive::{Drive, Motor, Winding};
use super::power_stage::PowerStage;
use crate::passivity::interval::Interval;

/// Largest gain of the feedback: with it the loop has a double pole at 1/2, and with a smaller gain two real
/// poles, so that an error of the measurement is not amplified.
const LARGEST_FEEDBACK: f64 = 0.25;

/// Coefficients of one instant, in SI units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Plant {
    /// `exp(-R h/L)`: the part of a current that remains.
    pub decay: f64,
    /// `(1 - a)/R`: current in A per volt.
    pub gain: f64,
    /// `1 - p` with `p = exp(-h/tau)`: the part of a step that the model makes in an instant.
    pub model_gain: f64,
    /// `K`, the gain of the feedback's loop.
    pub feedback: f64,
}

impl Plant {
    /// The coefficients for a motor and a model with this time constant in s, with instants of `instant` s.
    pub(super) const fn of(motor: &Motor, lag: f64, instant: f64) -> Self {
        let decay = exp_of_negative(motor.resistance * instant / motor.inductance);
        let model_gain = 1.0 - exp_of_negative(instant / lag);
        Self {
            decay,
            gain: (1.0 - decay) / motor.resistance,
            model_gain,
            feedback: model_gain.min(LARGEST_FEEDBACK),
        }
    }

    /// Largest voltage in V of the feed-forward in the step of a model from `-current` to `current` in A: at
    /// its beginning, for the inductance, or at its end, for the resistance.
    pub(super) const fn largest_voltage(&self, current: f64) -> f64 {
        let first = current * (self.decay - 1.0 + 2.0 * self.model_gain) / self.gain;
        let last = current * (1.0 - self.decay) / self.gain;
        first.max(last)
    }
}

const fn exp_of_negative(x: f64) -> f64 {
    Interval::exact(x).exp_of_negative().midpoint()
}

/// The time response of a current loop for the certificate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TorqueResponse {
    /// Time in s from the code to the beginning of its torque: `Latency::output_delay`.
    pub delay: f64,
    /// Time constant in s of the lag behind it: `Latency::actuator_lag`.
    pub lag: f64,
    /// Updates in a period of the servo, at which the torque is that of the lag.
    pub updates: u16,
}

/// The resolution of the torque of a current loop in N m (theory, section 15.4).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CurrentResolution {
    /// Torque of a count of the current.
    pub step: f64,
    /// Largest deviation of the settled torque from the model's, because counts, compare values and offsets
    /// are whole numbers.
    pub deviation: f64,
    /// Largest additional deviation after the current has changed its sign, from an instant in which the
    /// compensation of the dead time has the wrong sign.
    pub zero_crossing: f64,
    /// Largest ripple of the modulation, from peak to peak, at the highest supply. At the instants of the
    /// samples the ripple is zero.
    pub ripple: f64,
}

impl CurrentResolution {
    /// The resolution of a drive on a power stage, with instants of `instant` s.
    pub(super) const fn of(
        Drive { motor, supply, .. }: &Drive,
        stage: &PowerStage,
        plant: &Plant,
        counts: u16,
        instant: f64,
    ) -> Self {
        let Motor { winding, resistance, inductance, torque_constant } = *motor;
        let (supply, amps_per_count) = (supply.highest, stage.amps_per_count);
        // The factors from a count to the step of the current, from the errors of two phases to the current, from
        // the errors of compare values and dead times to the voltage, and from the supply to the ripple in the
        // middle of the range.
        let (step, current, voltage, dead, swing) = match winding {
            // Half the difference of two counts; the compare values differ by the rounded number.
            Winding::Brushed => (0.5, 1.0, 0.5, 2.0, 1.0 / 8.0),
            // The vector of `i_u` and `(i_u + 2 i_v)/sqrt 3` is at most twice a phase's error; the vector of
            // the three phases' voltages is at most 4/3 of one phase's.
            Winding::Brushless { .. } => (1.0, 2.0, 4.0 / 3.0 * 0.5, 4.0 / 3.0, 1.0 / 12.0),
        };
        // Largest current in A caused by any voltage error of up to one volt: the sum of the impulse response
        // (theory, section 15.3).
        let admittance = 2.0 / resistance * ((1.0 - plant.decay) / plant.feedback).min(1.0);
        // Half a count of the sample, and half a count of the offset.
        let sampled = current * amps_per_count;
        let compare = voltage * supply / counts as f64;
        // During the dead time the current's sign decides whether the phase loses or gains voltage. A
        // compensation with the wrong sign makes the voltage wrong by twice as much, in one instant only.
        let crossing = 2.0 * dead * supply * stage.dead_time / instant;
        Self {
            step: torque_constant * amps_per_count * step,
            deviation: torque_constant * (sampled + admittance * compare),
            zero_crossing: torque_constant * plant.gain * crossing,
            ripple: torque_constant * swing * supply * instant / inductance,
        }
    }
}

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

    /// Sum over the instants in A of the deviation by a change of the speed in rad/s, for a motor with this torque
    /// in N m/A: `Ke/(K R)` of the speed (theory, section 15.10).
    pub(super) const fn deviation_by(&self, torque_constant: f64, speed: f64) -> f64 {
        self.gain * speed / (torque_constant * self.feedback * self.resistance)
    }
}

/// Damping in N m s/rad that the loop takes from the device by motion: `Kt Ke h/(4 sqrt(3) L)`, rounded up (theory,
/// section 15.8, equation 52). Infinite if equation 53 does not hold, so that no bound is known.
///
/// Motion induces a voltage, and the feedback removes its current one instant late: the most power that this current
/// gives to a motion on average is this damping times the mean square of the velocity.
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
