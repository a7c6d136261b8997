//! A run as samples over time: what a simulation, a scenario or a recording gave.

use std::ops::Range;
use std::path::Path;

use crate::file::SceneFile;
use crate::simulation::drive::Drive;
use crate::simulation::served::Served;
use crate::simulation::{Experiment, SimulationError, Stride, simulate, wall};

/// What the samples are counted in.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Clock {
    /// Seconds.
    #[default]
    Seconds,
    /// Ticks, of a period that is not known.
    Ticks,
}

/// A run to draw.
#[derive(Clone, Debug, Default)]
pub struct Trace {
    /// What it is called.
    pub title: String,
    /// What the times are in.
    pub clock: Clock,
    /// When the samples were taken, each later than the one before.
    pub time: Vec<f64>,
    /// Angle of the device in rad, a sample each.
    pub position: Vec<f64>,
    /// Where the hand wanted to be in rad, as long as it held the device.
    pub hand: Vec<f64>,
    /// Velocity in rad/s, a sample each; empty where it was not recorded, to be taken from the angle.
    pub velocity: Vec<f64>,
    /// Coupling torque in N m; the motor applies the opposite.
    pub torque: Vec<f64>,
    /// Torque in N m with which the hand drives the device, in the direction of the angle; empty where
    /// it is not known or there is none.
    pub hand_torque: Vec<f64>,
    /// What the torque is limited to, in N m.
    pub torque_limit: Option<f64>,
    /// Why the torque is not what the scene asked for.
    pub limit: Vec<Served>,
    /// When the hand lets go, on the same clock.
    pub release: Option<f64>,
    /// Angle in rad beyond which a one-sided wall is felt.
    pub face: Option<f64>,
    /// When the run went beyond what a picture can show, if it did; there are no samples from
    /// there on.
    pub lost: Option<f64>,
}

impl Trace {
    /// What a scene file's simulation does, taken exactly through each tick; `folder` is where its
    /// torque file is looked for.
    ///
    /// # Errors
    /// Where the file has no `[simulation]`, or its scene cannot run.
    pub fn simulated(file: &SceneFile, folder: &Path) -> Result<Self, SimulationError> {
        let experiment = Experiment::of(file, folder)?;
        let motion = simulate(&experiment, Stride::default())?;
        let period = file.scene.timing.period;
        let drive = |k: usize| experiment.drive.held(k) + experiment.drive.sine(k, period)[0];
        let is_driven = experiment.drive != Drive::Free;
        let driven = is_driven.then(|| (0..experiment.samples).map(drive).collect());
        let trace = Self {
            title: file.name.clone(),
            clock: Clock::Seconds,
            time: (0..experiment.samples).map(|sample| sample as f64 * period).collect(),
            position: motion.position,
            velocity: motion.velocity,
            torque: motion.torque,
            hand_torque: driven.unwrap_or_default(),
            torque_limit: file.scene.torque_limit,
            limit: motion.limit,
            face: wall(&file.scene).filter(|wall| wall.one_sided).map(|wall| wall.face),
            ..Self::default()
        };
        Ok(trace)
    }

    /// Ends the run at the first sample that is not fine, or where there is no more of it.
    pub fn until(mut self, is_fine: impl Fn(f64) -> bool) -> Self {
        let fine = |column: &[f64], i: usize| column.get(i).is_none_or(|value| is_fine(*value));
        let all = |&i: &usize| {
            [&self.position, &self.velocity, &self.torque].iter().all(|column| fine(column, i))
        };
        let recorded = self.position.len().min(self.torque.len());
        let kept = (0..recorded).take_while(all).count();
        self.lost = self.time.get(kept).copied();
        self.time.truncate(kept);
        for column in [
            &mut self.position,
            &mut self.velocity,
            &mut self.torque,
            &mut self.hand,
            &mut self.hand_torque,
        ] {
            column.truncate(kept);
        }
        self.limit.truncate(kept);
        self
    }

    /// When a sample begins, and when the last one ends.
    pub fn begin(&self, sample: usize) -> f64 {
        match (self.time.get(sample), &self.time[..]) {
            (Some(&time), _) => time,
            (None, [.., before, last]) => 2.0 * last - before,
            (None, _) => 0.0,
        }
    }

    /// From the first sample to the end of the last.
    pub fn times(&self) -> Range<f64> {
        self.begin(0)..self.begin(self.time.len())
    }

    /// Samples over which a velocity is taken that was not recorded: as many as a picture does not
    /// show apart, so that the steps of the encoder do not hide it.
    pub fn window(&self) -> usize {
        (self.time.len() / 400).max(1)
    }

    /// The velocity as it was recorded, or the mean over a few samples.
    pub fn velocities(&self) -> Vec<f64> {
        if !self.velocity.is_empty() {
            return self.velocity.clone();
        }
        let mean = |i: usize| {
            let from = i.saturating_sub(self.window());
            let to = if from == i { i + 1 } else { i };
            let step = self.position[to] - self.position[from];
            step / (self.time[to] - self.time[from])
        };
        (0..self.time.len()).map(mean).collect()
    }
}
