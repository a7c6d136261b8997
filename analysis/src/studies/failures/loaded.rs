//! The device around a servo with all features of a simulation: masses in a hand, Coulomb friction,
//! missed ticks, encoder counts and DAC codes.

use haptic_servo::dac::DacCode;
use haptic_servo::servo::Transducers;

use crate::device::SimulatedEncoder;
use crate::lockstep::PlantIo;
use crate::simulation::plant::POSITION;
use crate::simulation::torque_signal::TorqueSignal;
use crate::simulation::{Experiment, Integration, Machine, SimulationError};

/// A device that records its positions.
pub struct LoadedDevice {
    machine: Machine,
    hand_torque: TorqueSignal,
    encoder: SimulatedEncoder,
    torque_per_code: f64,
    missed: Box<dyn Iterator<Item = bool> + Send>,
    /// Position in rad at each tick, missed or not.
    pub positions: Vec<f64>,
}

impl LoadedDevice {
    /// The device of an experiment at its start, with the encoder and the motor of the servo.
    pub fn new(
        experiment: &Experiment,
        transducers: &Transducers,
    ) -> Result<Self, SimulationError> {
        let integration = Integration::default();
        // Checks the plant's motion.
        experiment.tick(integration)?;
        let mut missed = experiment.missed.ticks();
        // The first tick is never missed.
        missed.next();
        let full_scale = transducers.full_scale_torque;
        Ok(Self {
            machine: Machine::new(experiment, integration),
            hand_torque: experiment.hand_torque.clone(),
            encoder: SimulatedEncoder::new(transducers.counts_per_turn),
            torque_per_code: full_scale / f64::from(DacCode::CODES_TO_FULL_SCALE),
            missed: Box::new(missed),
            positions: Vec::new(),
        })
    }

    /// Position in rad.
    pub fn position(&self) -> f64 {
        self.machine.state()[POSITION]
    }

    /// Applies the motor's `torque` in N m over a tick, and over the missed ticks after it.
    fn apply(&mut self, torque: f64) {
        loop {
            self.positions.push(self.position());
            self.machine.tick(self.positions.len() - 1, &self.hand_torque, torque);
            if !self.missed.next().unwrap_or(false) {
                return;
            }
        }
    }
}

impl PlantIo for LoadedDevice {
    fn count(&mut self) -> Option<i32> {
        Some(self.encoder.read(self.position()))
    }

    fn hold(&mut self, code: u16) {
        let codes = f64::from(code) - f64::from(DacCode::MID_SCALE.get());
        self.apply(codes * self.torque_per_code);
    }
}
