//! The torques of a host in a simulation, by the tank of the servo.

use haptic_servo::environment::VariableDelay;
use haptic_servo::host::{HostResponse, Sampling, Tank};
use haptic_servo::torque::LimitReason;

use super::error::SimulationError;
use super::experiment::Experiment;

/// A host and its tank, in `f64`, rad and N m.
#[derive(Debug)]
pub struct Hosted {
    tank: Tank<f64, VariableDelay<f64>, false>,
    wanted: Vec<f64>,
    /// Its largest torque in N m.
    largest: f64,
    position: Option<f64>,
}

/// What the host did in a sample.
#[derive(Clone, Copy, Debug)]
pub struct HostSample {
    /// Torque in N m that its command adds to the motor's, positive in the direction of the angle.
    pub command: f64,
    /// Mean in N m over the sample of what the motor makes of its commands.
    pub torque: f64,
    /// Level of the tank in J at the sample.
    pub energy: f64,
    /// The reason if less than the wanted torque was given.
    pub limit: LimitReason,
}

impl Hosted {
    /// The host of an experiment, if it has one, with a full tank.
    ///
    /// # Errors
    /// If there is no proof for a host in this experiment.
    pub fn new(experiment: &Experiment) -> Result<Option<Self>, SimulationError> {
        let Some(host) = &experiment.host else { return Ok(None) };
        let count = experiment.encoder_step.unwrap_or(0.0);
        let sampling = Sampling::simultaneous(&experiment.scene.timing, count);
        let response = HostResponse::of(&host.budget, &experiment.scene.latency, &sampling)?;
        let tank = Tank::new(&host.budget, &response, count, [1.0, 1.0])?;
        Ok(Some(Self {
            tank,
            wanted: host.wanted.clone(),
            largest: host.budget.torque,
            position: None,
        }))
    }

    /// The tick of sample `k`, with the device read at `position` rad.
    pub fn tick(&mut self, k: usize, position: f64) -> HostSample {
        if let Some(before) = self.position.replace(position) {
            self.tank.book(position - before);
        }
        let energy = self.tank.energy();
        let wanted = self.wanted.get(k).copied().unwrap_or(0.0);
        let command = self.tank.allowed(self.tank.in_range(wanted));
        self.tank.give(command);
        let limit = if command == wanted {
            LimitReason::None
        } else if command.abs() == self.largest {
            LimitReason::Torque
        } else {
            LimitReason::Energy
        };
        HostSample { command, torque: self.tank.mean(), energy, limit }
    }
}
