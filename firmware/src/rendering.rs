//! What a servo needs of a scene: the law of its environment, and the memory of its coupling.

use crate::build_error::BuildError;
use crate::coupling_memory::{AnyMemory, CouplingMemory, NoMemory};
use crate::environment::{
    Delayed, Discretize, Environment, EnvironmentModel, LawContext, Memory, PartSet, ProfileUse,
    StatedEnvironment, sealed,
};
use crate::host::{AnyHosted, BesideServo, HostTorque, NoHost};
use crate::number::Number;
use crate::parameter::{NamedParameters, Parameter};

/// An environment that a servo renders in the number format `N`.
pub trait Rendering<N: Number>: Discretize<N> {
    /// The torques that its coupling stores.
    type Memory: CouplingMemory<N>;
    /// The host beside the servo, or none.
    type Host: BesideServo;

    /// What that host may do.
    #[inline(always)]
    fn host(&self) -> Option<HostTorque> {
        None
    }
}

impl<N: Number> Rendering<N> for Environment {
    type Memory = AnyMemory<N>;
    type Host = NoHost;
}

impl<N: Number, E: StatedEnvironment + Discretize<N>> Rendering<N> for E {
    type Memory = NoMemory;
    type Host = NoHost;
}

/// An environment with a host beside its servo, both known at run time only: those of a scene file.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EnvironmentBesideHost {
    /// The environment.
    pub environment: Environment,
    /// What the host may do.
    pub host: HostTorque,
}

impl<N: Number> Rendering<N> for EnvironmentBesideHost {
    type Memory = AnyMemory<N>;
    type Host = AnyHosted;

    fn host(&self) -> Option<HostTorque> {
        Some(self.host)
    }
}

impl<N: Number> Discretize<N> for EnvironmentBesideHost {
    type Law = <Environment as Discretize<N>>::Law;

    fn law(&self, context: &LawContext) -> Result<Self::Law, BuildError> {
        self.environment.law(context)
    }
}

impl sealed::Sealed for EnvironmentBesideHost {}

impl EnvironmentModel for EnvironmentBesideHost {
    const PARTS: PartSet = Environment::PARTS;
    const PROFILE: ProfileUse = Environment::PROFILE;
    const MEMORY: Memory = Environment::MEMORY;

    fn as_data(&self, _: &LawContext) -> Environment {
        self.environment
    }
}

impl NamedParameters for EnvironmentBesideHost {
    fn value(&mut self, parameter: Parameter) -> Option<&mut f64> {
        self.environment.value(parameter)
    }
}

// Its numbers decide, which are checked with the timing of the scene.
impl Delayed for EnvironmentBesideHost {}
