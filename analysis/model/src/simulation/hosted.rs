//! The torques of a host in a simulation, by the tank of the servo.

use haptic_servo::environment::VariableDelay;
use haptic_servo::host::{HostResponse, Sampling, Tank};
use haptic_servo::torque::LimitReason;

use super::error::SimulationError;
use super::experiment::{Experiment, HostSignal};

/// A host and its tank.
#[derive(Debug)]
pub struct Hosted {
    tank: Tank<VariableDelay<i64>, 1>,
    wanted: Vec<f64>,
    /// Its largest torque in N m.
    largest: f64,
    sampling: Sampling,
    /// The position in counts of the last tick.
    count: Option<i64>,
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
        let HostSignal { budget, sampling, wanted } = host.clone();
        let response = HostResponse::of(&budget, &experiment.scene.latency, &sampling)?;
        let tank = Tank::new(&budget, &response)?;
        Ok(Some(Self { tank, wanted, largest: budget.torque, sampling, count: None }))
    }

    /// The tick of sample `k`, with the device read at `position` rad.
    pub fn tick(&mut self, k: usize, position: f64) -> HostSample {
        let Sampling { count, code, .. } = self.sampling;
        // A position that an encoder shows is at the edge of a count.
        let count = (position / count + 1e-6).floor() as i64;
        if let Some(before) = self.count.replace(count) {
            self.tank.book((count - before) as i32);
        }
        let energy = self.tank.energy();
        let wanted = self.wanted.get(k).copied().unwrap_or(0.0);
        let codes = self.tank.in_range(wanted as f32);
        let given = self.tank.allowed(codes);
        self.tank.give(given);
        let limit = if given != codes {
            LimitReason::Energy
        } else if wanted.abs() > self.largest {
            LimitReason::Torque
        } else {
            LimitReason::None
        };
        let [command, torque] = [f64::from(given), self.tank.mean()].map(|codes| codes * code);
        HostSample { command, torque, energy, limit }
    }
}
