//! A run as samples over time: the result of a simulation, a scenario or a recording.

use std::ops::Range;
use std::path::Path;

use haptic_servo::environment::Wall;

use crate::file::SceneFile;
use crate::nominal_latency::titled;
use crate::simulation::tick_status::TickStatus;
use crate::simulation::torque_signal::TorqueSignal;
use crate::simulation::{Experiment, Integration, SimulationError, simulate};

/// A step of the encoder over the window of a velocity is at most the largest velocity over this number.
const STEPS: f64 = 20.0;
/// The window of a velocity is at most the samples of the run over this number.
const SMEARED: usize = 12;

/// Unit of the samples' times.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum TimeUnit {
    /// Seconds.
    #[default]
    Seconds,
    /// Ticks, of a period that is not known.
    Ticks,
}

/// A run to draw.
#[derive(Clone, Debug, Default)]
pub struct Trace {
    /// Its title.
    pub title: String,
    /// Unit of the times.
    pub time_unit: TimeUnit,
    /// Times of the samples, each later than the one before.
    pub time: Vec<f64>,
    /// Angle of the device in rad, a sample each.
    pub position: Vec<f64>,
    /// Set-point of the hand in rad, as long as it held the device.
    pub hand: Vec<f64>,
    /// Velocity in rad/s, a sample each; empty where it was not recorded, to be taken from the angle.
    pub velocity: Vec<f64>,
    /// Coupling torque in N m; the motor applies the opposite.
    pub torque: Vec<f64>,
    /// Torque in N m with which the hand drives the device, in the direction of the angle; empty where
    /// it is not known or there is none.
    pub hand_torque: Vec<f64>,
    /// Limit of the torque in N m.
    pub torque_limit: Option<f64>,
    /// Status of the servo, a sample each.
    pub limit: Vec<TickStatus>,
    /// Time at which the hand lets go, on the same clock.
    pub release: Option<f64>,
    /// Angle in rad beyond which a one-sided wall is felt.
    pub face: Option<f64>,
    /// Time at which the run went beyond the range of a picture, if it did; there are no samples from there
    /// on.
    pub lost: Option<f64>,
}

impl Trace {
    /// The simulation of a scene file, exact through each tick; `folder` is the folder of its torque file.
    ///
    /// # Errors
    /// Where the file has no `[simulation]`, or its scene cannot run.
    pub fn simulated(file: &SceneFile, folder: &Path) -> Result<Self, SimulationError> {
        Self::of(file, &Experiment::of(file, folder)?)
    }

    /// The simulation of an experiment with a file's scene.
    ///
    /// # Errors
    /// Where the scene cannot run.
    pub fn of(file: &SceneFile, experiment: &Experiment) -> Result<Self, SimulationError> {
        let motion = simulate(experiment, Integration::default())?;
        let period = file.scene.timing.period;
        let hand_torque =
            |k: usize| experiment.hand_torque.held(k) + experiment.hand_torque.sine(k, period)[0];
        let is_driven = experiment.hand_torque != TorqueSignal::Free;
        let driven = is_driven.then(|| (0..experiment.samples).map(hand_torque).collect());
        Ok(Self {
            title: titled(&file.name, [&file.scene.latency]),
            time_unit: TimeUnit::Seconds,
            time: (0..experiment.samples).map(|sample| sample as f64 * period).collect(),
            position: motion.position,
            velocity: motion.velocity,
            torque: motion.torque,
            hand_torque: driven.unwrap_or_default(),
            torque_limit: file.scene.torque_limit,
            limit: motion.limit,
            face: file.scene.environment.wall().filter(|wall| wall.is_one_sided()).map(Wall::face),
            ..Self::default()
        })
    }

    /// Ends the run at the first sample that is not fine, or at the end of the recording.
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

    /// Samples over which a velocity is taken that was not recorded: as many as a picture cannot separate,
    /// and more, up to the run over `SMEARED`, until a step of the encoder is a small part of the velocities.
    pub fn window(&self) -> usize {
        let last = self.time.len().saturating_sub(1).max(1);
        let (least, most) = ((self.time.len() / 400).clamp(1, last), (last / SMEARED).max(1));
        let Some(step) = self.step() else { return least };
        let sample = (self.time[last] - self.time[0]) / last as f64;
        let is_fine = |window: &usize| {
            let fastest = self.means(*window).fold(0.0, |fastest: f64, v| fastest.max(v.abs()));
            STEPS * step <= fastest * sample * *window as f64
        };
        let wider = std::iter::successors(Some(least), |window| Some(window + window.div_ceil(4)));
        wider.take_while(|window| *window < most).find(is_fine).unwrap_or(most.max(least))
    }

    /// The encoder's step: the smallest difference, larger than rounding, between two changes of the angle
    /// from a sample to the next; `None` if the angle never changes.
    fn step(&self) -> Option<f64> {
        /// Differences below this fraction of the largest change come from rounding.
        const ROUNDED: f64 = 1e-6;
        let changes = self.position.windows(2).map(|pair| (pair[1] - pair[0]).abs());
        let mut changes: Vec<_> = changes.chain([0.0]).collect();
        changes.sort_by(f64::total_cmp);
        let least = ROUNDED * changes[changes.len() - 1];
        let steps = changes.windows(2).map(|pair| pair[1] - pair[0]);
        steps.filter(|step| *step > least).min_by(f64::total_cmp)
    }

    /// The mean velocity over `window` samples, around each sample as far as the run goes.
    fn means(&self, window: usize) -> impl Iterator<Item = f64> + '_ {
        let last = self.time.len().saturating_sub(1);
        let window = window.min(last);
        (0..self.time.len()).map(move |i| {
            let from = i.saturating_sub(window.div_ceil(2)).min(last - window);
            let to = from + window;
            (self.position[to] - self.position[from]) / (self.time[to] - self.time[from])
        })
    }

    /// The velocity as it was recorded, or the mean over a few samples.
    pub fn velocities(&self) -> Vec<f64> {
        match self.velocity.is_empty() {
            true => self.means(self.window()).collect(),
            false => self.velocity.clone(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 4096 counts a turn, sent every other tick of 1 ms, around 0.3 rad/s.
    #[test]
    fn a_velocity_from_angles_is_no_comb_of_the_encoders_steps() {
        let step = std::f64::consts::TAU / 4096.0;
        let time: Vec<f64> = (0..1000).map(|i| 0.002 * f64::from(i)).collect();
        let angle = |t: &f64| (0.3 * t + 0.01 * (3.0 * t).sin()) / step;
        let position: Vec<f64> = time.iter().map(|t| angle(t).floor() * step).collect();
        let trace = Trace { time, position, ..Trace::default() };
        for (t, v) in trace.time.iter().zip(trace.velocities()) {
            let truth = 0.3 + 0.03 * (3.0 * t).cos();
            assert!((v - truth).abs() < 0.03, "{v} {truth} at {t}");
        }
        // Angles that no encoder has rounded are taken as near to each other as a picture shows.
        let position = trace.time.iter().map(|t| angle(t) * step).collect();
        assert_eq!(Trace { position, ..trace }.window(), 2);
    }
}
