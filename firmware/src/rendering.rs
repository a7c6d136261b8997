//! What a servo needs of a scene: the law of its environment, and the memory of its coupling.

use crate::certificate::passivity_left;
use crate::coupling_memory::{AnyMemory, CouplingMemory, NoMemory};
use crate::environment::{
    Anticogging, AnticoggingLaw, Compensation, Discretize, Environment, LawContext, NoAnticogging,
    StatedEnvironment, VariableDelay,
};
use crate::host::{BesideServo, HostTorque, NoHost};
use crate::number::{Format, Number};
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
pub fn context_beside_anticogging(scene: &Scene, format: Format) -> LawContext {
    let is_late = scene.environment.is_late();
    let passivity = passivity_left::<Environment>(scene, is_late, format);
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
        context_beside_anticogging(scene, N::FORMAT)
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
