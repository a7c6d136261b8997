//! The part of an environment that cancels the device's own damping, so that the hand feels almost nothing:
//! free mode.

use super::delay_line::{DelayLine, VariableDelay};
use super::late_velocity::LateVelocity;
use super::law::{AnyPart, LawContext, LawOf};
use super::velocity::Washout;
use crate::build_error::BuildError;
use crate::coupling::Coupling;
use crate::number::Number;
use crate::parameter::Parameter;

/// Cancels the device's damping down to a residual (equations 22 and 23).
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "wire", derive(serde::Serialize, serde::Deserialize))]
pub struct Canceller {
    /// Damping `epsilon` in N m s/rad that the hand still feels.
    pub residual: f64,
    /// Delay in whole samples; beside other parts it must be 0.
    pub delay: usize,
}

impl Canceller {
    /// Without a delay.
    pub const fn to(residual: f64) -> Self {
        Self { residual, delay: 0 }
    }

    /// The same structure with this number.
    #[inline(always)]
    pub(crate) fn with_numbers(&self, number: impl Fn(Parameter) -> Option<f64>) -> Self {
        Self { residual: number(Parameter::Residual).unwrap_or(self.residual), ..*self }
    }
}

/// The canceller's high-pass.
///
/// The wanted controller is `C = -be s` with `be = b - epsilon`; behind the coupling this is the environment
/// `E = C / (1 - C / K_vc)`, by backward differences `E(z) = -g (z - 1) / (z - rho)` with
/// `g = be K_vc / (K_vc T + be)` and `rho = be / (K_vc T + be)` (equation 23 at `K_vc = 2 b / T`); rigid:
/// `g = be / T`, `rho = 0`.
fn high_pass<N: Number>(residual: f64, context: &LawContext) -> Result<Washout<N>, BuildError> {
    let be = context.damping - residual;
    let stiffness = match context.coupling {
        Coupling::Rigid => None,
        Coupling::Spring { stiffness } => Some(stiffness),
        Coupling::Matched => Some(2.0 * context.passivity / context.period),
    };
    match stiffness {
        None => Washout::new(-be / context.period, 1.0),
        Some(stiffness) => {
            let leading = stiffness * context.period + be;
            Washout::new(-be * stiffness / leading, stiffness * context.period / leading)
        }
    }
}

/// The law of a [`Canceller`].
pub type CancellerLaw<N, D> = LateVelocity<Washout<N>, D>;

impl<N: Number> AnyPart<N> for Canceller {
    type Law = CancellerLaw<N, VariableDelay<N>>;
}

impl<N: Number, D: DelayLine<N>> LawOf<N, Canceller> for CancellerLaw<N, D> {
    fn law_of(canceller: &Canceller, context: &LawContext) -> Result<Self, BuildError> {
        let velocity = high_pass(canceller.residual, context)?;
        Ok(Self { velocity, delay: D::at_rest(canceller.delay)? })
    }
}
