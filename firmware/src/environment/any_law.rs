//! The law of any environment as data.

use super::any::Environment;
use super::law::{Discretize, Law, LawContext, LawOf};
use super::rational::RationalLaw;
use super::sum_law::AnySumLaw;
use super::turn::Turn;
use crate::build_error::BuildError;
use crate::coupling::{Response, Slopes};
use crate::number::Number;

/// The law of any [`Environment`].
#[derive(Clone, Debug)]
pub enum AnyLaw<N: Number> {
    /// Of a sum of parts.
    Parts(AnySumLaw<N>),
    /// Of a rational environment.
    Rational(RationalLaw<N>),
}

macro_rules! of_any {
    ($any:expr, $law:ident => $value:expr) => {
        match $any {
            Self::Parts($law) => $value,
            Self::Rational($law) => $value,
        }
    };
}

impl<N: Number> Law<N> for AnyLaw<N> {
    fn evaluate(&self, x: N) -> Response<N> {
        of_any!(self, law => law.evaluate(x))
    }

    fn update(&mut self, x_e: N) {
        of_any!(self, law => law.update(x_e))
    }

    fn rest_at(&mut self, x_e: N) {
        of_any!(self, law => law.rest_at(x_e))
    }

    fn turn(&mut self) -> Option<&mut Turn<N>> {
        of_any!(self, law => law.turn())
    }

    fn shift(&mut self, by: N) {
        of_any!(self, law => law.shift(by))
    }

    fn hysteresis(&self) -> f64 {
        of_any!(self, law => law.hysteresis())
    }

    fn slopes(&self) -> Slopes {
        of_any!(self, law => law.slopes())
    }
}

impl<N: Number> Discretize<N> for Environment {
    type Law = AnyLaw<N>;

    fn law(&self, context: &LawContext) -> Result<Self::Law, BuildError> {
        match self {
            Self::Parts(parts) => Ok(AnyLaw::Parts(AnySumLaw::law_of(parts, context)?)),
            Self::Rational(rational) => Ok(AnyLaw::Rational(rational.law(context)?)),
            // Its statement does not contain its law.
            Self::Stated(_) => Err(BuildError::LawElsewhere),
        }
    }
}
