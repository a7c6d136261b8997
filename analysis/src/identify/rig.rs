//! A rig that measures a simulated device, with what spoils a measurement: an encoder of whole
//! counts, torque noise that nobody records, records that are skewed in time.

use firmware::scene::Device;

use super::record::Record;
use crate::device::{Grip, Hand, HeldDevice, Motion, SimulatedEncoder};

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

/// A rig.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rig {
    /// What is measured.
    pub device: Device,
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

impl Rig {
    /// Applies one sine after the other, from rest, and records.
    pub fn measure(&self, sines: &[Excitation]) -> Record {
        let held = |time: f64| HeldDevice::new(self.device, Hand::default(), time);
        let (until, after) = (held(self.period - self.skew), held(self.skew));
        let encoder = SimulatedEncoder::new(self.counts_per_turn);
        let mut noise = fastrand::Rng::with_seed(self.seed);
        let (mut motion, mut seen) = (Motion::default(), Motion::default());
        let (mut torque, mut counts, mut frequency) = (vec![], vec![], vec![]);
        for sine in sines {
            let ticks = (sine.duration / self.period).round() as usize;
            for tick in 0..ticks {
                let time = tick as f64 * self.period;
                let command =
                    sine.amplitude * (std::f64::consts::TAU * sine.frequency * time).sin();
                torque.push(command);
                counts.push(f64::from(encoder.read(seen.position)));
                frequency.push(sine.frequency);
                let motor = command + self.torque_noise * normal(&mut noise);
                seen = until.step(motion, motor, Grip::default()).0;
                // A step of no length would be solved as 0/0.
                motion = match self.skew {
                    0.0 => seen,
                    _ => after.step(seen, motor, Grip::default()).0,
                };
            }
        }
        Record { period: self.period, torque, counts, frequency: Some(frequency) }
    }
}

/// Normally distributed with deviation 1, to the accuracy of a sum of twelve uniform numbers.
fn normal(rng: &mut fastrand::Rng) -> f64 {
    (0..12).map(|_| rng.f64()).sum::<f64>() - 6.0
}
