//! The servo in `f64` and radians: the firmware's law and coupling without quantisation by encoder and DAC.
//!
//! Nothing here is certified: a scene is simulated before it is known to be safe.

use haptic_servo::coupling::Solver;
use haptic_servo::coupling_memory::{AnyMemory, CouplingMemory};
use haptic_servo::environment::{AnyLaw, Compensation, Discretize, Environment, Law};
use haptic_servo::number::Format;
use haptic_servo::rendering::{Rendering, context_beside_anticogging};
use haptic_servo::scene::Scene;
use haptic_servo::servo::BuildError;
use haptic_servo::torque::{LimitReason, Limiter};

/// Environment and coupling of a scene, initially at rest at zero.
#[derive(Clone, Debug)]
pub struct UnquantizedServo {
    law: AnyLaw<f64>,
    memory: AnyMemory<f64>,
    anticogging: <Environment as Rendering<f64>>::Anticogging,
    solver: Solver<f64>,
    limiter: Limiter<f64>,
    torque: f64,
}

impl UnquantizedServo {
    /// The servo of a scene.
    ///
    /// # Errors
    /// Where coupling and environment have no unique solution, or the environment needs samples
    /// from the future.
    pub fn new(scene: &Scene) -> Result<Self, BuildError> {
        let context = context_beside_anticogging::<Environment>(scene, Format::F64);
        let memory = AnyMemory::of(&context)?;
        let law = Discretize::<f64>::law(&scene.environment, &context)?;
        let compliance = scene.coupling.compliance(memory.compliance())?;
        let solver = Solver::new(compliance, law.slopes())?;
        // There is no DAC range here.
        let bound = scene.torque_limit.unwrap_or(f64::INFINITY);
        let limiter = Limiter::new(bound, LimitReason::Torque);
        let parts = scene.environment.parts();
        // Angles here are no counts: any number of them fits a turn.
        let anticogging = Compensation::of(parts.late_anticogging(), &context, 1.0)?;
        Ok(Self { law, memory, anticogging, solver, limiter, torque: 0.0 })
    }

    /// One tick with the encoder at `x` rad: the coupling torque `F` in N m, limited before the
    /// coupling is solved, with what opposes the cogging, and the reason if it was limited;
    /// `otherwise` if not. The motor applies `-F`.
    pub fn tick(&mut self, x: f64, otherwise: LimitReason) -> (f64, LimitReason) {
        self.anticogging.tick_at(x, &self.limiter);
        let x = x - self.memory.deflection_after(self.torque);
        let wanted = self.solver.torque(self.law.evaluate(x));
        let (torque, limit) = self.limiter.limit(wanted, otherwise);
        self.law.update(self.solver.environment_position(x, torque));
        self.torque = torque;
        (self.anticogging.add_to(torque), limit)
    }
}
