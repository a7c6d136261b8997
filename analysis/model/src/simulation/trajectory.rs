//! The result of a simulation: samples at the instants of the ticks.

use serde::Serialize;

use super::tick_status::TickStatus;

/// Samples at the instants of the ticks, all of them finite: a motion that grows beyond the range of numbers
/// is cut off before ([`Experiment::completed`](super::Experiment::completed)).
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Trajectory {
    /// Position of the encoder's mass in rad.
    pub position: Vec<f64>,
    /// Its velocity in rad/s.
    pub velocity: Vec<f64>,
    /// Coupling torque `F` in N m; the motor applies `-F`.
    pub torque: Vec<f64>,
    /// The reason if that torque was limited.
    pub limit: Vec<TickStatus>,
}

impl Trajectory {
    /// A trajectory of that many samples.
    pub fn of_length(samples: usize) -> Self {
        let zeros = || vec![0.0; samples];
        let limit = vec![TickStatus::UNLIMITED; samples];
        Self { position: zeros(), velocity: zeros(), torque: zeros(), limit }
    }

    /// Number of samples.
    pub fn samples(&self) -> usize {
        self.position.len()
    }

    fn is_finite(&self, sample: usize) -> bool {
        [&self.position, &self.velocity, &self.torque].iter().all(|of| of[sample].is_finite())
    }

    /// Drops samples beyond the range of numbers. The last sample shows whether there are any, as a
    /// position that has left the range does not come back.
    pub(super) fn end_in_range(&mut self) {
        let samples = self.samples();
        if samples == 0 || self.is_finite(samples - 1) {
            return;
        }
        let kept = (0..samples).take_while(|&sample| self.is_finite(sample)).count();
        for column in [&mut self.position, &mut self.velocity, &mut self.torque] {
            column.truncate(kept);
        }
        self.limit.truncate(kept);
    }

    /// Where its samples are written.
    pub(super) fn columns(&mut self) -> (Columns<'_>, &mut [TickStatus]) {
        let Self { position, velocity, torque, limit } = self;
        (Columns { position, velocity, torque }, limit)
    }
}

/// Where samples are written, one slice each of the same length.
#[derive(Debug)]
pub struct Columns<'t> {
    /// As [`Trajectory::position`].
    pub position: &'t mut [f64],
    /// As [`Trajectory::velocity`].
    pub velocity: &'t mut [f64],
    /// As [`Trajectory::torque`].
    pub torque: &'t mut [f64],
}
