//! An environment in a crate other than [`haptic_servo`]: a spring that gets stiffer beyond a knee, like a
//! pedal. It shows the parts of such a type; to make your own, copy this package.
//!
//! 1. The type, with the numbers of a scene.
//! 2. Its law: the servo's computation in each tick, [`Discretize`] and [`Law`].
//! 3. Its statement to the certificate, [`StatedEnvironment`], with a proof in the comment. The test of
//!    this package tries to disprove it.
//! 4. The numbers that may be changed while it runs, [`NamedParameters`].
//!
//! `src/bin/pedal.rs` is a program with it.
#![cfg_attr(not(test), no_std)]

use haptic_servo::coupling::{Response, Slopes};
use haptic_servo::environment::{
    DelayLine, Delayed, Discretize, FixedDelay, Law, LawContext, StatedBound, StatedEnvironment,
    StatedModel,
};
use haptic_servo::number::Number;
use haptic_servo::parameter::{NamedParameters, Parameter};
use haptic_servo::servo::BuildError;

/// A spring of stiffness `soft` up to `knee` on both sides of zero and of stiffness `stiff` beyond, late
/// by `DELAY` samples: `F = soft x + (stiff - soft) (x - x clamped to the knee)`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ProgressiveSpring<const DELAY: usize> {
    /// Stiffness around zero in N m/rad.
    pub soft: f64,
    /// Stiffness beyond the knee in N m/rad.
    pub stiff: f64,
    /// Angle in rad at which it becomes stiff.
    pub knee: f64,
}

/// Largest error of a rounded coefficient: half a unit of the last place of `I16F16`, the coarsest of the
/// fixed-point formats, or of `f32` relative to its magnitude.
const ROUNDING: f64 = 1.0 / 131_072.0;
const ROUNDING_F32: f64 = f32::EPSILON as f64;

impl<const DELAY: usize> ProgressiveSpring<DELAY> {
    /// Its model for the certificate at this period in s, for constants.
    ///
    /// The torque depends on one position. If neither stiffness is negative, it never falls with rising
    /// position; if the knee is not negative, it is zero at zero. It is then a monotone spring with at most
    /// the larger of the two slopes. For other numbers nothing is claimed. The servo multiplies by two
    /// rounded coefficients, which add up to the steepest slope.
    pub const fn stated_at(&self, period: f64) -> StatedModel {
        let is_spring = self.soft >= 0.0 && self.stiff >= 0.0 && self.knee >= 0.0;
        let coefficients = self.soft + (self.stiff - self.soft).abs();
        let rounding = 2.0 * ROUNDING + ROUNDING_F32 * coefficients;
        let steepest = if is_spring { self.soft.max(self.stiff) + rounding } else { f64::NAN };
        let bound = StatedBound::of_monotone_spring(steepest, DELAY, period);
        StatedModel::Bounded { delay: DELAY, bound }
    }
}

impl<const DELAY: usize> StatedEnvironment for ProgressiveSpring<DELAY> {
    fn stated(&self, context: &LawContext) -> StatedModel {
        self.stated_at(context.period)
    }
}

// Every torque is late by at least one sample.
impl Delayed for ProgressiveSpring<1> {}
impl Delayed for ProgressiveSpring<2> {}

impl<const DELAY: usize> NamedParameters for ProgressiveSpring<DELAY> {
    fn value(&mut self, parameter: Parameter) -> Option<&mut f64> {
        match parameter {
            Parameter::Stiffness => Some(&mut self.stiff),
            Parameter::Face => Some(&mut self.knee),
            _ => None,
        }
    }
}

/// The law of a [`ProgressiveSpring`].
#[derive(Clone, Debug)]
pub struct ProgressiveLaw<N: Number, const DELAY: usize> {
    soft: N::Coefficient,
    added: N::Coefficient,
    knee: N,
    delay: FixedDelay<N, DELAY>,
}

impl<N: Number, const DELAY: usize> ProgressiveLaw<N, DELAY> {
    /// The torque in N m of the position `x` (rad).
    #[inline(always)]
    fn torque(&self, x: N) -> N {
        let beyond = x.minus(x.smaller(self.knee).larger(self.knee.negated()));
        x.times(self.soft).plus(beyond.times(self.added))
    }
}

impl<N: Number, const DELAY: usize> Law<N> for ProgressiveLaw<N, DELAY> {
    #[inline(always)]
    fn evaluate(&self, _: N) -> Response<N> {
        // There is a due torque whenever there is a delay.
        Response::Held(self.delay.due().unwrap_or(N::ZERO))
    }

    #[inline(always)]
    fn update(&mut self, x_e: N) {
        let torque = self.torque(x_e);
        self.delay.push(torque);
    }

    fn rest_at(&mut self, x_e: N) {
        self.delay.fill(self.torque(x_e));
    }

    fn slopes(&self) -> Slopes {
        Slopes::default()
    }
}

impl<N: Number, const DELAY: usize> Discretize<N> for ProgressiveSpring<DELAY> {
    type Law = ProgressiveLaw<N, DELAY>;

    fn law(&self, _: &LawContext) -> Result<Self::Law, BuildError> {
        Ok(ProgressiveLaw {
            soft: BuildError::coefficient::<N>("soft stiffness", self.soft)?,
            added: BuildError::coefficient::<N>(
                "stiffness beyond the knee",
                self.stiff - self.soft,
            )?,
            knee: BuildError::number("knee", self.knee)?,
            delay: FixedDelay::at_rest(DELAY)?,
        })
    }
}

#[cfg(test)]
mod tests;
