//! What an environment of another crate states of itself to the certificate.

use super::rational::Rational;

/// What an environment of another crate is to the certificate: a bound, which a board asks for, since it
/// limits every torque, or a transfer function, which is enough for a simulation.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "wire", derive(serde::Serialize, serde::Deserialize))]
pub enum StatedModel {
    /// A law that need not be linear.
    Bounded {
        /// Whole samples from a position to the first torque that depends on it; at least one.
        delay: usize,
        /// What holds for it.
        bound: StatedBound,
    },
    /// A linear law. Its coefficients are judged as the law of a [`Rational`] rounds them.
    // No board renders one, and none says so on its wire.
    #[cfg_attr(feature = "wire", serde(skip))]
    Linear(Rational),
}

/// Bounds of a law that need not be linear. They hold for the coefficients of every number format
/// that the law runs in.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "wire", derive(serde::Serialize, serde::Deserialize))]
pub struct StatedBound {
    /// Upper bound on the passivity index `alpha` in N m s/rad: for the positions `x_k` and torques
    /// `F_k` of every motion, `sum F_k (x_k - x_(k-1)) + alpha / T sum (x_k - x_(k-1))^2` is bounded
    /// from below, with the torque limited to any level.
    ///
    /// A servo moves that level while it fades: a falling level may only remove energy, and a rising
    /// level may add, once, the energy that the environment stores there, as for a spring.
    pub index: f64,
    /// Upper bound in N m s/rad on the change of the torque over that of the position, in the l2 norm
    /// and times the period (equation 37).
    pub gain: f64,
}

impl StatedBound {
    /// Of a law whose torque depends on one position, `delay` samples ago, is zero at some position,
    /// and never falls as the position rises, by no more than `steepest` N m/rad: a spring of any shape.
    /// Without the zero it could be a motor: a constant torque has no slope. No number, which is refused,
    /// where `steepest` is negative or the period is not positive.
    ///
    /// Its potential is convex and `steepest`-smooth, so that the torque of the present position is
    /// passive by `(difference of torques)^2 / (2 steepest)` a tick; each sample of delay takes
    /// `steepest T`, the first of them half of it (equation 31). A clipped law is one of the same kind.
    pub const fn of_monotone_spring(steepest: f64, delay: usize, period: f64) -> Self {
        if !(steepest >= 0.0 && period > 0.0) {
            return Self { index: f64::NAN, gain: f64::NAN };
        }
        let gain = steepest * period;
        let samples = if delay == 0 { 0.0 } else { delay as f64 - 0.5 };
        // Rounded up twice each: both products of the index.
        Self { index: (gain * samples).next_up().next_up(), gain: gain.next_up() }
    }
}
