//! A rig that measures a simulated device, with the errors of a real measurement: an encoder of
//! whole counts, unrecorded torque noise, records that are skewed in time.

use firmware::scene::Device;
use nalgebra::DVector;

use super::record::Record;
use crate::device::SimulatedEncoder;
use crate::simulation::SimulationError;
use crate::simulation::discrete_plant::{DiscretePlant, Discretization};
use crate::simulation::plant::{POSITION, Plant};

/// One sine.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Excitation {
    /// Frequency in Hz.
    pub frequency: f64,
    /// Amplitude in N m.
    pub amplitude: f64,
    /// How long, in s.
    pub duration: f64,
}

/// How a device is driven and seen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sensing {
    /// Sampling period in s.
    pub period: f64,
    /// Counts of the encoder in one turn.
    pub counts_per_turn: f64,
    /// Standard deviation in N m of the torque that is there and not recorded, new in every tick.
    pub torque_noise: f64,
    /// Time in s, less than the period, by which the counts of a row are older than its time.
    pub skew: f64,
    /// The noise's seed.
    pub seed: u64,
}

/// A simulated device between motor and encoder, at rest at zero to begin with.
#[derive(Clone, Debug)]
pub struct MeasuredDevice {
    /// From a tick to the time at which the next row's counts are taken.
    until: DiscretePlant,
    /// From there to the next tick; none without skew.
    after: Option<DiscretePlant>,
    state: DVector<f64>,
    /// Angle in rad that the encoder sees.
    seen: f64,
    encoder: SimulatedEncoder,
    torque_noise: f64,
    noise: fastrand::Rng,
}

impl MeasuredDevice {
    /// A device that is driven and seen so.
    ///
    /// # Errors
    /// Where the device is too fast for its motion over a period to be computed.
    pub fn new(plant: &Plant, sensing: &Sensing) -> Result<Self, SimulationError> {
        let Sensing { period, counts_per_turn, torque_noise, skew, seed } = *sensing;
        let over = |time| DiscretePlant::checked(plant, &Discretization::exact(time), 0.0);
        Ok(Self {
            until: over(period - skew)?,
            after: (skew > 0.0).then(|| over(skew)).transpose()?,
            state: plant.state_at(0.0, 0.0),
            seen: 0.0,
            encoder: SimulatedEncoder::new(counts_per_turn),
            torque_noise,
            noise: fastrand::Rng::with_seed(seed),
        })
    }

    /// The counter's content of this tick.
    pub fn count(&self) -> i32 {
        self.encoder.read(self.seen)
    }

    /// Holds a torque in N m until the next tick.
    pub fn hold(&mut self, torque: f64) {
        let motor = torque + self.torque_noise * normal(&mut self.noise);
        self.state = self.until.end(&self.state, motor, 0.0);
        self.seen = self.state[POSITION];
        if let Some(after) = &self.after {
            self.state = after.end(&self.state, motor, 0.0);
        }
    }
}

/// A rig with a rigid device.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rig {
    /// The device.
    pub device: Device,
    /// With what.
    pub sensing: Sensing,
}

impl Rig {
    /// Applies one sine after the other, from rest, and records.
    ///
    /// # Errors
    /// Where the device is too fast for its motion over a period to be computed.
    pub fn measure(&self, sines: &[Excitation]) -> Result<Record, SimulationError> {
        let period = self.sensing.period;
        let mut device = MeasuredDevice::new(&Plant::rigid(self.device), &self.sensing)?;
        let (mut torque, mut counts, mut frequency) = (vec![], vec![], vec![]);
        for sine in sines {
            let ticks = (sine.duration / period).round() as usize;
            for tick in 0..ticks {
                let time = tick as f64 * period;
                let command =
                    sine.amplitude * (std::f64::consts::TAU * sine.frequency * time).sin();
                torque.push(command);
                counts.push(f64::from(device.count()));
                frequency.push(sine.frequency);
                device.hold(command);
            }
        }
        Ok(Record { period, torque, counts, frequency: Some(frequency) })
    }
}

/// Normally distributed with deviation 1, to the accuracy of a sum of twelve uniform numbers.
fn normal(rng: &mut fastrand::Rng) -> f64 {
    (0..12).map(|_| rng.f64()).sum::<f64>() - 6.0
}
