//! Environments without a coupling.

use super::law::{Discretize, LawContext};
use crate::build_error::BuildError;
use crate::coupling::Coupling;
use crate::number::Number;
use crate::parameter::{NamedParameters, Parameter};

/// An environment without a coupling, [`Coupling::Rigid`], that a board renders.
///
/// The law is that of the environment. The type adds to a program the certificate's code for a law at the
/// device's port (theory, section 16), which the programs of coupled scenes do not have.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Uncoupled<E> {
    /// The environment.
    pub environment: E,
}

impl<E: NamedParameters> NamedParameters for Uncoupled<E> {
    fn value(&mut self, parameter: Parameter) -> Option<&mut f64> {
        self.environment.value(parameter)
    }
}

impl<N: Number, E: Discretize<N>> Discretize<N> for Uncoupled<E> {
    type Law = E::Law;

    fn law(&self, setting: &LawContext) -> Result<Self::Law, BuildError> {
        match setting.coupling {
            Coupling::Rigid => self.environment.law(setting),
            _ => Err(BuildError::CouplingMemory),
        }
    }
}
