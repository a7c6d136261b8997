//! The statement of an environment of another crate for the certificate.

use super::rational::Rational;

/// The model of an environment of another crate for the certificate: a bound, which a board needs because it
/// limits every torque, or a transfer function, which is sufficient for a simulation.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "wire", derive(serde::Serialize, serde::Deserialize))]
pub enum StatedModel {
    /// A law that may be nonlinear.
    Bounded {
        /// Whole samples from a position to the first torque that depends on it; at least one.
        delay: usize,
        /// The bounds that hold for it.
        bound: StatedBound,
    },
    /// A linear law. Its coefficients are judged as the law of a [`Rational`] rounds them.
    // Boards do not render it, and do not report it on the wire.
    #[cfg_attr(feature = "wire", serde(skip))]
    Linear(Rational),
}

/// Bounds of a law that may be nonlinear. They hold for the coefficients of every number format in which the
/// law runs.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "wire", derive(serde::Serialize, serde::Deserialize))]
pub struct StatedBound {
    /// Upper bound on the passivity index `alpha` in N m s/rad: for the positions `x_k` and torques
    /// `F_k` of every motion, `sum F_k (x_k - x_(k-1)) + alpha / T sum (x_k - x_(k-1))^2` is bounded
    /// from below, with the torque limited to any level.
    ///
    /// A servo changes that level while it fades: a falling level may only remove energy, and a rising level
    /// may add, once, the energy that the environment stores there, as for a spring.
    pub index: f64,
    /// Upper bound in N m s/rad on the change of the torque over that of the position, in the l2 norm
    /// and times the period (equation 37).
    pub gain: f64,
}

impl StatedBound {
    /// The bounds of a spring of any shape: its torque depends on the position `delay` samples ago, is zero
    /// at some position, never falls with rising position, and rises by at most `steepest` N m/rad. Without
    /// the zero it could be a motor: a constant torque has no slope. NaN, which is refused, if `steepest` is
    /// negative or the period is not positive.
    ///
    /// Its potential is convex and `steepest`-smooth, so that the torque of the present position is passive
    /// by `(difference of torques)^2 / (2 steepest)` per tick; each sample of delay takes `steepest T`, the
    /// first of them half of it (equation 31). A clipped law is of the same kind.
    pub const fn of_monotone_spring(steepest: f64, delay: usize, period: f64) -> Self {
        if !(steepest >= 0.0 && period > 0.0) {
            return Self { index: f64::NAN, gain: f64::NAN };
        }
        let gain = steepest * period;
        let samples = if delay == 0 { 0.0 } else { delay as f64 - 0.5 };
        // Rounded up twice, for the two products of the index.
        Self { index: (gain * samples).next_up().next_up(), gain: gain.next_up() }
    }
}
