//! A servo without a certificate, from the encoder's counts to the DAC's codes: for simulation only. Its law
//! is the firmware's, in `f64`.

use std::f64::consts::TAU;

use haptic_model::controller::{Controller, Tick};
use haptic_model::simulation::unquantized_servo::UnquantizedServo;
use haptic_servo::dac::DacCode;
use haptic_servo::encoder::{Position, RawCount};
use haptic_servo::number::{Number, OutOfRange};
use haptic_servo::scene::Scene;
use haptic_servo::servo::{BuildError, Transducers};
use haptic_servo::torque::LimitReason;

/// An uncertified servo, initially at rest at zero, or a motor that is off.
#[derive(Clone, Debug)]
pub struct Unchecked {
    /// `None`: the encoder is read, and every code is mid-scale.
    servo: Option<UnquantizedServo>,
    position: Position,
    radians_per_count: f64,
    code_scale: f64,
    /// The reason for a torque at its limit.
    limit: LimitReason,
}

impl Unchecked {
    /// The servo of a scene, with the torque limited as on a board: by the scene, or otherwise by the DAC.
    ///
    /// # Errors
    /// If coupling and environment have no unique solution, or no law.
    pub fn new(scene: &Scene, transducers: &Transducers) -> Result<Self, BuildError> {
        transducers.check(scene.timing, scene.latency.encoder, scene.torque_limit)?;
        let full_scale = transducers.full_scale_torque;
        let torque_limit = Some(scene.torque_limit.unwrap_or(full_scale));
        let has_limit = scene.torque_limit.is_some();
        let code_scale = f64::code_scale(f64::from(DacCode::CODES_TO_FULL_SCALE) / full_scale)
            .map_err(|reason| BuildError::Unrepresentable { name: "codes per N m", reason })?;
        Ok(Self {
            servo: Some(UnquantizedServo::new(&Scene { torque_limit, ..*scene })?),
            code_scale,
            limit: if has_limit { LimitReason::Torque } else { LimitReason::DacRange },
            ..Self::off(transducers)
        })
    }

    /// A motor that is off.
    pub fn off(transducers: &Transducers) -> Self {
        Self {
            servo: None,
            position: Position::new(transducers.counter),
            radians_per_count: TAU / transducers.counts_per_turn,
            code_scale: 0.0,
            limit: LimitReason::None,
        }
    }

    fn torque(&mut self, angle: f64) -> (f64, LimitReason) {
        let none = LimitReason::None;
        self.servo.as_mut().map_or((0.0, none), |servo| servo.tick(angle, none))
    }
}

impl Controller for Unchecked {
    fn tick(&mut self, raw: i32) -> Tick {
        self.position.update(RawCount::from(raw));
        let count = self.position.count();
        let angle = count as f64 * self.radians_per_count;
        let (torque, limit) = self.torque(angle);
        Tick {
            count,
            angle,
            torque,
            code: torque.codes_below(DacCode::MID_SCALE.get(), self.code_scale),
            limit: if limit == LimitReason::Torque { self.limit } else { limit },
            is_left_out: false,
        }
    }

    fn tick_at(&mut self, angle: f64) -> Result<f64, OutOfRange> {
        Ok(self.torque(angle).0)
    }
}
