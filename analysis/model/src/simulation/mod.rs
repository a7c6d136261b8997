//! Simulates a scene: the sampled loop of servo, device and hand, tick by tick.
//!
//! In tick `k` the servo reads the angle at `t = k T`, computes the coupling torque `F(k)`, and the
//! motor applies `-F(k)` until the next tick. Position, velocity and `F` are recorded at that instant, before
//! the torque acts. With an output delay the torque acts that much later, also by more than a tick; amplifier
//! and encoder may lag. Environment and hidden states start at rest at zero. A scene need not be certified to
//! be simulated: a simulation shows the motion of rejected scenes, too.
//!
//! ```
//! use haptic_model::file::{Format, parse};
//! use haptic_model::simulation::{Experiment, Integration, simulate};
//!
//! let file = parse("bounce.toml", Format::Toml, r#"
//!     name = "bounce"
//!     device = { inertia = 2.2e-5, damping = 0.022 }
//!     servo = { period = 0.001 }
//!     coupling = { stiffness = 44.0 }
//!     environment = { type = "damper-wall", stiffness = 22.0, damping = 0.01, delay = 1 }
//!     simulation = { samples = 1000, position = 0.001 }
//! "#)?;
//! let motion = simulate(&Experiment::of(&file, ".".as_ref())?, Integration::default())?;
//! assert_eq!(motion.position[0], 0.001);
//! assert!(motion.position[999].abs() < 1e-12);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

pub mod closed_loop;
pub mod device_in_hand;
pub mod discrete_plant;
pub mod disturbed_plant;
mod error;
mod experiment;
pub mod held_device;
pub mod kernel;
pub mod method;
pub mod plant;
pub mod tick_status;
pub mod torque_signal;
mod trajectory;
pub mod unquantized_servo;

mod hosted;
mod nonlinear_loop;
mod reading;

pub use error::SimulationError;
pub(crate) use error::unbuildable;
pub use experiment::{Experiment, HostSignal, Integration};
pub use nonlinear_loop::Machine;
pub use reading::Reading;
pub use trajectory::{Columns, Trajectory};

use closed_loop::ClosedLoop;
use discrete_plant::DiscretePlant;
use kernel::Linear;
use nonlinear_loop::NonlinearLoop;
use tick_status::TickStatus;
use torque_signal::TorqueSignal;

/// An experiment in motion.
#[derive(Debug)]
pub struct Simulator {
    hand_torque: TorqueSignal,
    engine: Engine,
}

#[derive(Debug)]
enum Engine {
    Linear(Box<dyn Linear>),
    NonlinearLoop(Box<NonlinearLoop>),
}

impl Simulator {
    /// Sets an experiment up.
    ///
    /// # Errors
    /// If the scene has no law that can run.
    pub fn new(experiment: &Experiment, integration: Integration) -> Result<Self, SimulationError> {
        let hand_torque = experiment.hand_torque.clone();
        // Rejects scenes without law or motion, for every way to run them.
        let nonlinear = NonlinearLoop::new(experiment, integration)?;
        let tick = experiment.tick(integration)?;
        if experiment.is_linear()
            && let Some(linear) = linear(experiment, &tick)
        {
            return Ok(Self { hand_torque, engine: Engine::Linear(linear) });
        }
        Ok(Self { hand_torque, engine: Engine::NonlinearLoop(Box::new(nonlinear)) })
    }

    /// The next samples, as many as `trajectory` has room for; it is cut off where the motion
    /// leaves the range of numbers, and nothing comes after that.
    pub fn fill(&mut self, trajectory: &mut Trajectory) {
        if let Engine::NonlinearLoop(nonlinear) = &self.engine
            && nonlinear.has_host()
        {
            trajectory.add_host();
        }
        let (columns, limit, host) = trajectory.columns();
        match &mut self.engine {
            Engine::Linear(linear) => {
                // Nothing limits a linear loop.
                limit.fill(TickStatus::UNLIMITED);
                linear.fill(&self.hand_torque, columns);
            }
            Engine::NonlinearLoop(nonlinear) => {
                nonlinear.fill(&self.hand_torque, columns, limit, host);
            }
        }
        trajectory.end_in_range();
    }
}

fn linear(experiment: &Experiment, tick: &DiscretePlant) -> Option<Box<dyn Linear>> {
    let closed = ClosedLoop::new(tick, &experiment.scene).ok()?;
    let start = experiment.machine().state_at(experiment.start.position, experiment.start.velocity);
    kernel::kernel(&closed, tick, experiment.scene.timing.period, &start)
}

/// Runs an experiment from its start to its end, or until the motion leaves the range of numbers.
///
/// # Errors
/// If the scene has no law that can run.
pub fn simulate(
    experiment: &Experiment,
    integration: Integration,
) -> Result<Trajectory, SimulationError> {
    let mut trajectory = Trajectory::of_length(experiment.samples);
    Simulator::new(experiment, integration)?.fill(&mut trajectory);
    Ok(trajectory)
}

#[cfg(test)]
mod tests;
