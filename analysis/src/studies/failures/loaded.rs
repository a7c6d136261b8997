//! The device around a servo with all features of a simulation: masses in a hand, Coulomb friction, encoder
//! counts and DAC codes.

use haptic_servo::servo::Transducers;

use crate::device::SimulatedEncoder;
use crate::identify::rig::torque_of;
use crate::lockstep::PlantIo;
use crate::simulation::plant::POSITION;
use crate::simulation::torque_signal::TorqueSignal;
use crate::simulation::{Experiment, Integration, Machine, SimulationError};

/// A device that records its positions.
pub struct LoadedDevice {
    machine: Machine,
    hand_torque: TorqueSignal,
    encoder: SimulatedEncoder,
    /// Torque in N m of the motor at the largest code.
    full_scale: f64,
    /// Position in rad at each tick.
    pub positions: Vec<f64>,
}

impl LoadedDevice {
    /// The device of an experiment at its start, with the encoder and the motor of the servo.
    pub fn new(
        experiment: &Experiment,
        transducers: &Transducers,
    ) -> Result<Self, SimulationError> {
        let integration = Integration::default();
        Ok(Self {
            machine: Machine::new(experiment, integration)?,
            hand_torque: experiment.hand_torque.clone(),
            encoder: SimulatedEncoder::new(transducers.counts_per_turn),
            full_scale: transducers.full_scale_torque,
            positions: Vec::new(),
        })
    }

    pub fn position(&self) -> f64 {
        self.machine.state()[POSITION]
    }
}

impl PlantIo for LoadedDevice {
    fn count(&mut self) -> Option<i32> {
        Some(self.encoder.read(self.position()))
    }

    fn hold(&mut self, code: u16) {
        self.positions.push(self.position());
        let torque = torque_of(code, self.full_scale);
        self.machine.tick(self.positions.len() - 1, &self.hand_torque, torque);
    }
}
