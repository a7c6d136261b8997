//! A motion in and out of contact, and the deviation of a format's torques from those of `f64`.

use haptic_servo::environment::Environment;
use haptic_servo::number::Arithmetic;

use super::FormatProblem;
use crate::controller::controller;
use crate::hand::HandTrajectory;
use crate::lockstep::{SimulatedDevice, run};
use crate::studies::error::StudyError;

/// Counts of a device in a hand, with the servo in `f64`.
#[derive(Clone, Debug)]
pub struct Motion {
    problem: FormatProblem,
    counts: Vec<i32>,
    /// The tick in which the comparison begins.
    begin: usize,
}

/// Time in s in which the device is brought to its offset.
const APPROACH: f64 = 1.0;

impl Motion {
    /// Moves the device by a hand's trajectory, for a time in s.
    pub fn new(
        problem: &FormatProblem,
        trajectory: HandTrajectory,
        seconds: f64,
    ) -> Result<Self, StudyError> {
        let FormatProblem { scene, transducers, .. } = *problem;
        let period = scene.timing.period;
        let mut device = SimulatedDevice::new(&scene, trajectory, &transducers)?;
        let certified = scene.certify().map_err(StudyError::from)?;
        let mut servo = controller::<_, f64>(&certified, &transducers)?;
        let ticks = (seconds / period).ceil() as usize;
        let run = run(&mut device, servo.as_mut(), ticks);
        let counts = run.ticks.iter().map(|tick| tick.count as i32).collect();
        Ok(Self::recorded(problem, counts))
    }

    /// Recorded raw counts.
    pub fn recorded(problem: &FormatProblem, counts: Vec<i32>) -> Self {
        Self { problem: *problem, counts, begin: 0 }
    }

    /// The same motion around the whole count nearest to `angle` rad, with the wall's face there; `None` if
    /// the environment's rest position is always zero.
    pub fn around(&self, angle: f64) -> Option<Self> {
        let counts_per_radian = self.problem.transducers.counts_per_turn / std::f64::consts::TAU;
        let offset = (angle * counts_per_radian).round();
        let place = offset / counts_per_radian;
        let mut problem = self.problem;
        match problem.scene.environment {
            Environment::Rational(_) | Environment::Stated(_) => return None,
            ref mut environment => {
                if let Some(wall) = environment.wall_mut() {
                    wall.side = wall.side.at(wall.face() + place);
                }
            }
        }
        let begin = (APPROACH / problem.scene.timing.period).ceil() as usize;
        let approach = (0..begin).map(|tick| {
            let part = tick as f64 / begin as f64;
            (offset * part * part * (3.0 - 2.0 * part)).round() as i32
        });
        let there = self.counts.iter().map(|count| count + offset as i32);
        Some(Self { problem, counts: approach.chain(there).collect(), begin })
    }

    /// The raw counts, one per tick.
    pub fn counts(&self) -> &[i32] {
        &self.counts
    }

    /// The scene and its transducers.
    pub fn problem(&self) -> &FormatProblem {
        &self.problem
    }

    /// Torques in N m and codes in a format, tick by tick.
    pub fn torques(&self, arithmetic: Arithmetic) -> Result<Vec<(f64, u16)>, StudyError> {
        let mut servo = self.problem.servo(arithmetic)?;
        Ok(self.counts.iter().map(|&count| servo.tick(count)).collect())
    }

    /// Largest difference in N m of a format's torques to those of `f64` on the same counts.
    pub fn error(&self, arithmetic: Arithmetic) -> Result<f64, StudyError> {
        let (here, reference) = (self.torques(arithmetic)?, self.torques(Arithmetic::F64)?);
        let pairs = here.iter().zip(&reference).skip(self.begin);
        Ok(pairs.fold(0.0, |most, (here, reference)| (here.0 - reference.0).abs().max(most)))
    }
}
