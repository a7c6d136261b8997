//! The simulated device between the DAC's codes and the encoder's counts, held or released.

use haptic_model::device::{Energy, Hand, HandSetpoint, SimulatedEncoder};
use haptic_model::simulation::SimulationError;
use haptic_model::simulation::held_device::{DeviceState, HeldDevice};
use haptic_servo::dac::DacCode;
use haptic_servo::scene::Scene;
use haptic_servo::servo::Transducers;

/// A device that a hand holds or not.
pub struct DeviceInHand {
    held: HeldDevice,
    free: HeldDevice,
    state: DeviceState,
    encoder: SimulatedEncoder,
    torque_per_code: f64,
    energy: Energy,
}

impl DeviceInHand {
    /// A scene's device in a hand, which continues its motion from the previous scene, if there was one.
    ///
    /// # Errors
    /// If device and hand are too fast for their motion over a period to be computed.
    pub fn new(
        scene: &Scene,
        hand: Hand,
        transducers: &Transducers,
        before: Option<(&Self, &Scene)>,
    ) -> Result<Self, SimulationError> {
        let held = HeldDevice::of(scene, hand)?;
        let state = match before {
            Some((device, old)) if moves_as(old, scene) => device.state.clone(),
            // Torques in transit are discarded.
            Some((device, _)) => held.at(device.state.motion()),
            None => held.at(Default::default()),
        };
        Ok(Self {
            held,
            free: HeldDevice::of(scene, Hand::default())?,
            state,
            encoder: SimulatedEncoder::new(transducers.counts_per_turn),
            torque_per_code: transducers.full_scale_torque
                / f64::from(DacCode::CODES_TO_FULL_SCALE),
            energy: Energy::default(),
        })
    }

    /// Changes the hand.
    ///
    /// # Errors
    /// As [`DeviceInHand::new`].
    pub fn change_hand(&mut self, scene: &Scene, hand: Hand) -> Result<(), SimulationError> {
        self.held = HeldDevice::of(scene, hand)?;
        Ok(())
    }

    /// The counter's content.
    pub fn count(&self) -> i32 {
        self.encoder.read(self.state.measured())
    }

    /// Angle of the device in rad.
    pub fn position(&self) -> f64 {
        self.state.motion().position
    }

    /// Energy that passed between hand and device.
    pub fn energy(&self) -> Energy {
        self.energy
    }

    /// A tick with a code, in a hand with this set-point, or free.
    pub fn step(&mut self, code: u16, setpoint: Option<HandSetpoint>) {
        let torque = (f64::from(code) - f64::from(DacCode::MID_SCALE.get())) * self.torque_per_code;
        match setpoint {
            Some(setpoint) => {
                let work = self.held.step(&mut self.state, torque, setpoint);
                self.energy.add(work);
            }
            None => {
                self.free.step(&mut self.state, torque, HandSetpoint::default());
            }
        }
    }
}

/// Whether the devices of two scenes have the same states.
fn moves_as(one: &Scene, other: &Scene) -> bool {
    one.timing.period == other.timing.period && one.latency == other.latency
}
