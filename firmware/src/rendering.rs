//! What a servo needs of a scene: the law of its environment, and the memory of its coupling.

use crate::build_error::BuildError;
use crate::certificate::passivity_left;
use crate::coupling_memory::{AnyMemory, CouplingMemory, NoMemory};
use crate::environment::{
    Anticogging, AnticoggingLaw, Compensation, Delayed, Discretize, Environment, EnvironmentModel,
    LawContext, Memory, NoAnticogging, PartSet, ProfileUse, StatedEnvironment, VariableDelay,
    sealed,
};
use crate::host::{AnyHosted, BesideServo, HostTorque, NoHost};
use crate::number::{Format, Number};
use crate::parameter::{NamedParameters, Parameter};
use crate::scene::Scene;

/// An environment that a servo renders in the number format `N`.
pub trait Rendering<N: Number>: Discretize<N> {
    /// The torques that its coupling stores.
    type Memory: CouplingMemory<N>;
    /// The anticogging, or none.
    type Anticogging: Compensation<N>;
    /// The host beside the servo, or none.
    type Host: BesideServo;
    /// What that host may do in the program.
    const HOST: Option<HostTorque> = None;
    /// Largest torque in N m that opposes cogging in the program.
    const AGAINST_COGGING: f64 = 0.0;
    /// What it may do now.
    fn budget(&self) -> <Self::Host as BesideServo>::Budget;
    /// The same environment with another budget of the host.
    #[must_use]
    fn with_budget(self, budget: <Self::Host as BesideServo>::Budget) -> Self;

    /// The anticogging's data, and its delay in whole samples.
    fn anticogging(&self) -> Option<(Anticogging, usize)> {
        None
    }

    /// The rest of a scene for the environment and the coupling, which have the passivity that the anticogging
    /// leaves.
    fn context(scene: &Scene<Self>) -> LawContext
    where
        Self: Sized,
    {
        scene.context()
    }
}

/// [`Scene::context`] of a scene in a number format, with the passivity that its anticogging leaves.
/// As for the scene's verdict, so that a program has the code once.
pub fn context_beside_anticogging<E: EnvironmentModel>(
    scene: &Scene,
    format: Format,
) -> LawContext {
    let is_late = scene.environment.is_late();
    let passivity = passivity_left::<E>(scene, is_late, format);
    LawContext { passivity, ..scene.context() }
}

impl<N: Number> Rendering<N> for Environment {
    type Memory = AnyMemory<N>;
    type Anticogging = Option<AnticoggingLaw<N, VariableDelay<N>>>;
    type Host = NoHost;

    fn budget(&self) {}

    fn with_budget(self, (): ()) -> Self {
        self
    }

    fn anticogging(&self) -> Option<(Anticogging, usize)> {
        self.parts().late_anticogging()
    }

    fn context(scene: &Scene) -> LawContext {
        context_beside_anticogging::<Self>(scene, N::FORMAT)
    }
}

impl<N: Number, E: StatedEnvironment + Discretize<N>> Rendering<N> for E {
    type Memory = NoMemory;
    type Anticogging = NoAnticogging;
    type Host = NoHost;

    fn budget(&self) {}

    fn with_budget(self, (): ()) -> Self {
        self
    }
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
    type Anticogging = <Environment as Rendering<N>>::Anticogging;
    type Host = AnyHosted;

    fn budget(&self) -> HostTorque {
        self.host
    }

    fn with_budget(self, host: HostTorque) -> Self {
        Self { host, ..self }
    }

    fn anticogging(&self) -> Option<(Anticogging, usize)> {
        <Environment as Rendering<N>>::anticogging(&self.environment)
    }

    fn context(scene: &Scene<Self>) -> LawContext {
        context_beside_anticogging::<Environment>(
            &scene.in_environment(scene.environment.environment),
            N::FORMAT,
        )
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
