//! The servo in `f64` and radians: the firmware's law and coupling without its converters.
//!
//! Nothing here is certified: what a scene would do is asked before it is safe.

use firmware::coupling::Solver;
use firmware::environment::{EnvironmentLaw, Law, Renderable, Setting};
use firmware::scene::Scene;
use firmware::servo::BuildError;

/// Environment and coupling of a scene, at rest at zero to begin with.
#[derive(Clone, Debug)]
pub struct Rendering {
    law: EnvironmentLaw<f64>,
    solver: Solver<f64>,
    limit: f64,
}

impl Rendering {
    /// The servo of a scene.
    ///
    /// # Errors
    /// Where coupling and environment have no unique solution, or the environment needs samples
    /// from the future.
    pub fn new(scene: &Scene) -> Result<Self, BuildError> {
        let setting = Setting {
            period: scene.timing.period,
            damping: scene.device.damping,
            coupling: scene.coupling,
        };
        let law = scene.environment.law(&setting)?;
        let solver = Solver::new(scene.coupling, law.slopes())?;
        Ok(Self { law, solver, limit: scene.torque_limit.unwrap_or(f64::INFINITY) })
    }

    /// One tick with the encoder at `x` rad: the coupling torque `F` in N m, limited before the
    /// coupling is solved. The motor applies `-F`.
    pub fn tick(&mut self, x: f64) -> f64 {
        let torque = self.solver.torque(self.law.offer(x)).clamp(-self.limit, self.limit);
        self.law.advance(self.solver.environment_position(x, torque));
        torque
    }
}
