//! A rig that measures a simulated device, with the errors of a real measurement: friction and cogging of the
//! motor, the errors of an encoder, unrecorded torque noise, records that are skewed in time, torques that are
//! late. The device and its encoder are those of every other simulation.

use std::f64::consts::TAU;

use haptic_servo::dac::DacCode;
use haptic_servo::scene::{EncoderReading, Latency, Scene, TimeRange};

use crate::device::SimulatedEncoder;
use crate::disturbance::{Cogging, Disturbance};
use crate::lockstep::PlantIo;
use crate::program::damper_wall;
use crate::simulation::plant::{POSITION, Plant};
use crate::simulation::torque_signal::TorqueSignal;
use crate::simulation::{Experiment, Integration, Machine, Reading, SimulationError};

/// How a device is driven and measured.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sensing {
    /// Sampling period in s.
    pub period: f64,
    /// Counts of the encoder in one turn.
    pub counts_per_turn: f64,
    /// Errors of its readings.
    pub encoder: EncoderReading,
    /// Time constant of the filter between the encoder and its counts.
    pub sensor_lag: TimeRange,
    /// Friction and cogging of the motor.
    pub disturbance: Disturbance,
    /// Standard deviation in N m of the torque noise, which acts but is not recorded, new in every tick.
    pub torque_noise: f64,
    /// Time in s by which the counts of a row are older than its time, besides the age of the readings.
    pub skew: f64,
    /// Time in s by which the torque of a row is applied later than its time, periods and parts.
    pub output_delay: f64,
    /// The noise's seed.
    pub seed: u64,
}

impl Sensing {
    /// Without noise and errors but the steps of the encoder.
    pub const fn ideal(period: f64, counts_per_turn: f64) -> Self {
        Self {
            period,
            counts_per_turn,
            encoder: EncoderReading::IDEAL,
            sensor_lag: TimeRange::ZERO,
            disturbance: Disturbance { friction: 0.0, cogging: Cogging { harmonics: &[] } },
            torque_noise: 0.0,
            skew: 0.0,
            output_delay: 0.0,
            seed: 1,
        }
    }
}

/// A simulated device between motor and encoder, at rest at zero to begin with.
#[derive(Debug)]
pub struct MeasuredDevice {
    machine: Machine,
    reading: Reading,
    encoder: SimulatedEncoder,
    torque_noise: f64,
    noise: fastrand::Rng,
    /// Ticks so far.
    ticks: usize,
}

impl MeasuredDevice {
    /// A device that is driven and measured in this way. Counts that are late are counts in time of a device
    /// whose torque is as much later.
    ///
    /// # Errors
    /// If the device is too fast for its motion over a period to be computed.
    pub fn new(plant: &Plant, sensing: &Sensing) -> Result<Self, SimulationError> {
        // A scene refers to its encoder, as to the table of a torque profile.
        let encoder: &EncoderReading = Box::leak(Box::new(sensing.encoder));
        let late = TimeRange::exactly(sensing.output_delay + sensing.skew);
        let stated =
            Latency { output_delay: late, sensor_lag: sensing.sensor_lag, ..Latency::NONE };
        let mut scene = Scene { latency: stated.read_by(encoder), ..damper_wall::SCENE };
        scene.timing.period = sensing.period;
        let Disturbance { friction, cogging } = sensing.disturbance;
        let still = Experiment::still(&scene);
        let experiment = Experiment { plant: plant.clone(), friction, cogging, ..still };
        let integration = Integration::default();
        Ok(Self {
            machine: Machine::new(&experiment, integration)?,
            reading: Reading::new(encoder, Some(TAU / sensing.counts_per_turn)),
            encoder: SimulatedEncoder::new(sensing.counts_per_turn),
            torque_noise: sensing.torque_noise,
            noise: fastrand::Rng::with_seed(sensing.seed),
            ticks: 0,
        })
    }

    /// The counter's content of this tick, which is read once in it.
    pub fn count(&mut self) -> i32 {
        self.encoder.read(self.reading.angle(self.machine.measured()))
    }

    /// Angle in rad of the motor's mass: what an encoder without errors would show.
    pub fn angle(&self) -> f64 {
        self.machine.state()[POSITION]
    }

    /// Holds a torque in N m until the next tick, both of them later by the output's delay.
    pub fn hold(&mut self, torque: f64) {
        let torque = torque + self.torque_noise * normal(&mut self.noise);
        self.machine.tick(self.ticks, &TorqueSignal::Free, torque);
        self.ticks += 1;
    }
}

/// A measured device behind a motor, for a board.
#[derive(Debug)]
pub struct DrivenDevice {
    /// The device.
    pub device: MeasuredDevice,
    /// Torque in N m of the motor at the largest code.
    pub full_scale: f64,
}

impl PlantIo for DrivenDevice {
    fn count(&mut self) -> Option<i32> {
        Some(self.device.count())
    }

    fn hold(&mut self, code: u16) {
        self.device.hold(torque_of(code, self.full_scale));
    }
}

/// Torque in N m of a motor at a code.
pub fn torque_of(code: u16, full_scale: f64) -> f64 {
    let offset = f64::from(code) - f64::from(DacCode::MID_SCALE.get());
    offset * (full_scale / f64::from(DacCode::CODES_TO_FULL_SCALE))
}

/// Normally distributed with deviation 1, to the accuracy of a sum of twelve uniform numbers.
fn normal(rng: &mut fastrand::Rng) -> f64 {
    (0..12).map(|_| rng.f64()).sum::<f64>() - 6.0
}
