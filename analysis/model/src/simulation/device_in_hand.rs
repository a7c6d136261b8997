//! The simulated device between the DAC's codes and the encoder's counts, held or released: all that is
//! simulated beside a servo on a board, or in the place of one, moves this.

use std::f64::consts::TAU;

use haptic_servo::dac::DacCode;
use haptic_servo::scene::{Scene, Timing};
use haptic_servo::servo::Transducers;

use super::error::SimulationError;
use super::held_device::{DeviceState, HeldDevice};
use super::reading::Reading;
use crate::device::{Energy, Hand, HandSetpoint, Motion, SimulatedEncoder};
use crate::disturbance::Disturbance;
use crate::missed::Missed;

/// What has come of a reading of the encoder.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ReadingOutcome {
    /// An angle.
    #[default]
    Read,
    /// It has failed, and the one before takes its place.
    Replaced,
    /// It has failed, and the servo leaves its tick out.
    LeftOut,
    /// More in a row have failed than so many, which the scene allows.
    Fault(u16),
}

/// A device that a hand holds or not. A code acts after the output delay of the scene, and amplifier and sensor
/// have the lags of the scene: the middle of each range, without jitter.
#[derive(Clone, Debug)]
pub struct DeviceInHand {
    held: HeldDevice,
    free: HeldDevice,
    disturbance: Disturbance,
    state: DeviceState,
    reading: Reading,
    encoder: SimulatedEncoder,
    /// The last reading that did not fail, in counts.
    counted: i32,
    /// What has come of the last reading.
    outcome: ReadingOutcome,
    /// Whether a tick whose reading fails is left out.
    leaves_out: bool,
    /// Readings in a row that have failed, and how many may.
    failed: u16,
    may_fail: u16,
    torque_per_code: f64,
    energy: Energy,
}

impl DeviceInHand {
    /// A scene's device in a hand, at rest at zero, with the encoder and the motor of the servo.
    ///
    /// # Errors
    /// If device and hand are too fast for their motion over a period to be computed.
    pub fn new(
        scene: &Scene,
        hand: Hand,
        transducers: &Transducers,
    ) -> Result<Self, SimulationError> {
        let full_scale = transducers.full_scale_torque;
        let Timing { period, worst_period } = scene.timing;
        let held = HeldDevice::of(scene, hand)?;
        Ok(Self {
            state: held.at(Motion::default()),
            held,
            free: HeldDevice::of(scene, Hand::default())?,
            disturbance: Disturbance::default(),
            reading: Reading::new(scene.latency.encoder, Some(TAU / transducers.counts_per_turn)),
            encoder: SimulatedEncoder::new(transducers.counts_per_turn),
            counted: 0,
            outcome: ReadingOutcome::Read,
            leaves_out: scene.latency.encoder.leaves_out(period, worst_period),
            failed: 0,
            may_fail: scene.latency.encoder.dropped,
            torque_per_code: full_scale / f64::from(DacCode::CODES_TO_FULL_SCALE),
            energy: Energy::default(),
        })
    }

    /// The same with friction and cogging of its motor.
    pub fn with_disturbance(self, disturbance: Disturbance) -> Self {
        let [held, free] =
            [self.held, self.free].map(|device| device.with_disturbance(disturbance));
        Self { held, free, disturbance, ..self }
    }

    /// The same with readings of the encoder that fail.
    pub fn failing(self, dropped: Missed) -> Self {
        Self { reading: self.reading.failing(dropped), ..self }
    }

    /// The same in the motion of another device, with its torques in transit if it has the same states.
    pub fn moving_as(mut self, other: &Self, has_same_states: bool) -> Self {
        self.state = match has_same_states {
            true => other.state.clone(),
            false => self.held.at(other.motion()),
        };
        self
    }

    /// Changes the hand.
    ///
    /// # Errors
    /// As [`DeviceInHand::new`].
    pub fn change_hand(&mut self, scene: &Scene, hand: Hand) -> Result<(), SimulationError> {
        self.held = HeldDevice::of(scene, hand)?.with_disturbance(self.disturbance);
        Ok(())
    }

    /// The counter's content, as the encoder reads it now; that of the last tick if the reading fails.
    pub fn count(&mut self) -> i32 {
        let fails = self.reading.fails();
        self.failed = if fails { self.failed.saturating_add(1) } else { 0 };
        if !fails {
            self.counted = self.encoder.read(self.reading.angle(self.state.measured()));
        }
        self.outcome = match fails {
            false => ReadingOutcome::Read,
            true if self.failed > self.may_fail => ReadingOutcome::Fault(self.may_fail),
            true if self.leaves_out => ReadingOutcome::LeftOut,
            true => ReadingOutcome::Replaced,
        };
        self.counted
    }

    /// What has come of the reading of the last count.
    pub fn reading(&self) -> ReadingOutcome {
        self.outcome
    }

    /// The fault of a servo after the last count, if more readings in a row have failed than its scene allows.
    pub fn fault(&self) -> Option<String> {
        let ReadingOutcome::Fault(allowed) = self.outcome else { return None };
        Some(format!(
            "the fault encoder-reading: more readings of the encoder in a row have failed than \
             `encoder.dropped` = {allowed}"
        ))
    }

    /// The present motion of the device.
    pub fn motion(&self) -> Motion {
        self.state.motion()
    }

    /// Energy that passed between hand and device.
    pub fn energy(&self) -> Energy {
        self.energy
    }

    /// Torque in N m of a code.
    pub fn torque(&self, code: u16) -> f64 {
        (f64::from(code) - f64::from(DacCode::MID_SCALE.get())) * self.torque_per_code
    }

    /// A tick with a motor torque in N m, in a hand with this set-point, or free.
    pub fn push(&mut self, torque: f64, setpoint: HandSetpoint, is_held: bool) {
        let device = if is_held { &self.held } else { &self.free };
        let work = device.step(&mut self.state, torque, setpoint);
        if is_held {
            self.energy.add(work);
        }
    }
}
