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
    /// With a host, the mean in N m of its torque at the motor over the time from this sample to the next,
    /// positive in the direction of the angle.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub host_torque: Option<Vec<f64>>,
    /// With a host, the level of its tank in J at this sample, before the sample's torque is given.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub host_energy: Option<Vec<f64>>,
}

impl Trajectory {
    /// A trajectory of that many samples.
    pub fn of_length(samples: usize) -> Self {
        let zeros = || vec![0.0; samples];
        let limit = vec![TickStatus::UNLIMITED; samples];
        Self { position: zeros(), velocity: zeros(), torque: zeros(), limit, ..Self::default() }
    }

    /// Makes room for what a host does.
    pub(super) fn add_host(&mut self) {
        let zeros = || Some(vec![0.0; self.position.len()]);
        (self.host_torque, self.host_energy) = (zeros(), zeros());
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
        for column in [&mut self.host_torque, &mut self.host_energy].into_iter().flatten() {
            column.truncate(kept);
        }
        self.limit.truncate(kept);
    }

    /// Where its samples are written.
    pub(super) fn columns(&mut self) -> (Columns<'_>, &mut [TickStatus], Option<HostColumns<'_>>) {
        let Self { position, velocity, torque, limit, host_torque, host_energy } = self;
        let host = match (host_torque, host_energy) {
            (Some(torque), Some(energy)) => Some(HostColumns { torque, energy }),
            _ => None,
        };
        (Columns { position, velocity, torque }, limit, host)
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

/// Where the samples of a host are written, of the same length.
#[derive(Debug)]
pub struct HostColumns<'t> {
    /// As [`Trajectory::host_torque`].
    pub torque: &'t mut [f64],
    /// As [`Trajectory::host_energy`].
    pub energy: &'t mut [f64],
}
