//! A push that is played in place of the user's motion.

use haptic_model::device::HandSetpoint;
use haptic_model::hand::HandTrajectory;
use haptic_servo::environment::{Environment, Wall};

/// Time in s in which the set-point moves to the beginning of the trajectory.
const APPROACH: f64 = 0.5;

/// A hand's trajectory, and the present position in it.
pub struct Push {
    trajectory: HandTrajectory,
    period: f64,
    ticks: u64,
}

impl Push {
    /// The trajectory that demonstrates an environment, at its face, from a set-point in rad on.
    pub fn new(environment: &Environment, setpoint: f64, period: f64) -> Self {
        let mut trajectory = HandTrajectory::for_environment(environment);
        let face = environment.wall().map_or(0.0, Wall::face);
        for (time, position) in &mut trajectory.path {
            *time += APPROACH;
            *position += face;
        }
        trajectory.path.insert(0, (0.0, setpoint));
        trajectory.release += APPROACH;
        Self { trajectory, period, ticks: 0 }
    }

    /// The set-point over the next tick; `None` if the hand has let go.
    pub fn next(&mut self) -> Option<HandSetpoint> {
        let start = self.ticks as f64 * self.period;
        self.ticks += 1;
        (start < self.trajectory.release)
            .then(|| self.trajectory.setpoint(start, self.ticks as f64 * self.period))
    }
}
