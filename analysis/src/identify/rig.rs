//! A rig that measures a simulated device, with the errors of a real measurement: an encoder of
//! whole counts, unrecorded torque noise, records that are skewed in time, torques that are late.

use std::collections::VecDeque;

use nalgebra::DVector;

use crate::device::SimulatedEncoder;
use crate::simulation::SimulationError;
use crate::simulation::discrete_plant::{DiscretePlant, Discretization};
use crate::simulation::plant::{POSITION, Plant};

/// How a device is driven and measured.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sensing {
    /// Sampling period in s.
    pub period: f64,
    /// Counts of the encoder in one turn.
    pub counts_per_turn: f64,
    /// Standard deviation in N m of the torque noise, which acts but is not recorded, new in every tick.
    pub torque_noise: f64,
    /// Time in s, less than the period, by which the counts of a row are older than its time.
    pub skew: f64,
    /// Time in s by which the torque of a row is applied later than its time, periods and parts.
    pub output_delay: f64,
    /// The noise's seed.
    pub seed: u64,
}

/// A simulated device between motor and encoder, at rest at zero to begin with.
#[derive(Clone, Debug)]
pub struct MeasuredDevice {
    /// A tick in pieces, in their order.
    pieces: Vec<Piece>,
    /// The latest torques, the newest first: as many as the delay reaches back to.
    torques: VecDeque<f64>,
    state: DVector<f64>,
    /// Angle in rad that the encoder sees.
    seen: f64,
    encoder: SimulatedEncoder,
    torque_noise: f64,
    noise: fastrand::Rng,
}

/// A piece of a tick, in which the torque does not change.
#[derive(Clone, Debug)]
struct Piece {
    plant: DiscretePlant,
    /// Ticks by which the torque that acts is older than the newest.
    age: usize,
    /// Whether the next row's counts are taken at its end.
    counts: bool,
}

/// The pieces of a tick: it is cut where the late torque changes, and where the counts are taken.
fn pieces(plant: &Plant, sensing: &Sensing) -> Result<Vec<Piece>, SimulationError> {
    let &Sensing { period, skew, output_delay, .. } = sensing;
    let whole = (output_delay / period).floor();
    let (change, count) = ((output_delay - whole * period).max(0.0), period - skew);
    let cuts = [0.0, change.min(count), change.max(count), period];
    let long = cuts.windows(2).filter(|ends| ends[1] > ends[0]);
    long.map(|ends| {
        let discretization = Discretization::exact(ends[1] - ends[0]);
        Ok(Piece {
            plant: DiscretePlant::checked(plant, &discretization, 0.0)?,
            age: whole as usize + usize::from(ends[0] < change),
            counts: ends[1] == count,
        })
    })
    .collect()
}

impl MeasuredDevice {
    /// A device that is driven and measured in this way.
    pub fn new(plant: &Plant, sensing: &Sensing) -> Result<Self, SimulationError> {
        let pieces = pieces(plant, sensing)?;
        let oldest = pieces.iter().map(|piece| piece.age).max().unwrap_or(0);
        Ok(Self {
            pieces,
            torques: VecDeque::from(vec![0.0; oldest + 1]),
            state: plant.state_at(0.0, 0.0),
            seen: 0.0,
            encoder: SimulatedEncoder::new(sensing.counts_per_turn),
            torque_noise: sensing.torque_noise,
            noise: fastrand::Rng::with_seed(sensing.seed),
        })
    }

    /// The counter's content of this tick.
    pub fn count(&self) -> i32 {
        self.encoder.read(self.seen)
    }

    /// Holds a torque in N m until the next tick, both of them later by the output's delay.
    pub fn hold(&mut self, torque: f64) {
        self.torques.pop_back();
        self.torques.push_front(torque + self.torque_noise * normal(&mut self.noise));
        for piece in &self.pieces {
            self.state = piece.plant.end(&self.state, self.torques[piece.age], 0.0);
            if piece.counts {
                self.seen = self.state[POSITION];
            }
        }
    }
}

/// Normally distributed with deviation 1, to the accuracy of a sum of twelve uniform numbers.
fn normal(rng: &mut fastrand::Rng) -> f64 {
    (0..12).map(|_| rng.f64()).sum::<f64>() - 6.0
}
