//! What a servo needs of a scene: the law of its environment, and the memory of its coupling.

use crate::coupling_memory::{AnyMemory, CouplingMemory, NoMemory};
use crate::environment::{Discretize, Environment, StatedEnvironment};
use crate::host::{BesideServo, HostTorque, NoHost};
use crate::number::Number;

/// An environment that a servo renders in the number format `N`.
pub trait Rendering<N: Number>: Discretize<N> {
    /// The torques that its coupling stores.
    type Memory: CouplingMemory<N>;
    /// The host beside the servo, or none.
    type Host: BesideServo;
    /// What that host may do in the program.
    const HOST: Option<HostTorque> = None;
    /// What it may do now.
    fn budget(&self) -> <Self::Host as BesideServo>::Budget;
    /// The same environment with another budget of the host.
    #[must_use]
    fn with_budget(self, budget: <Self::Host as BesideServo>::Budget) -> Self;
}

impl<N: Number> Rendering<N> for Environment {
    type Memory = AnyMemory<N>;
    type Host = NoHost;

    fn budget(&self) {}

    fn with_budget(self, (): ()) -> Self {
        self
    }
}

impl<N: Number, E: StatedEnvironment + Discretize<N>> Rendering<N> for E {
    type Memory = NoMemory;
    type Host = NoHost;

    fn budget(&self) {}

    fn with_budget(self, (): ()) -> Self {
        self
    }
}
