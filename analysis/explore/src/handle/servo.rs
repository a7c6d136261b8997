//! The servo that renders a scene: the certified servo; or a servo without proof, in simulation only; or
//! none.

use haptic_model::controller::{Controller, Tick, controller};
use haptic_model::file::SceneFile;
use haptic_servo::certificate::assess;
use haptic_servo::dac::DacCode;
use haptic_servo::encoder::{CounterWidth, Position, RawCount};
use haptic_servo::number::OutOfRange;
use haptic_servo::servo::Transducers;
use haptic_servo::torque::LimitReason;
use serde::Serialize;

use super::unchecked::Unchecked;

/// The source of the torque.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Rendering {
    /// The servo of a certified scene, as on a board.
    Certified,
    /// The servo of a scene that is not certified: no board runs it.
    Unchecked,
    /// Nothing: the motor is off.
    Off,
}

/// A servo, and the reason if it is not that of a certified scene.
pub struct Rendered {
    /// The servo.
    pub servo: Box<dyn Controller>,
    /// The kind of servo.
    pub rendering: Rendering,
    /// The reason if it is not that of a certified scene.
    pub refusal: Option<String>,
}

impl Rendered {
    /// The servo of a scene; with the check, only of a certified scene.
    pub fn of(file: &SceneFile, transducers: &Transducers, is_checked: bool) -> Self {
        let refusal = match certified(file, transducers) {
            Ok(servo) => return Self { servo, rendering: Rendering::Certified, refusal: None },
            Err(refusal) => refusal,
        };
        let unchecked = if is_checked {
            Err(None)
        } else {
            Unchecked::new(&file.scene, transducers).map_err(Some)
        };
        match unchecked {
            Ok(servo) => Self {
                servo: Box::new(servo),
                rendering: Rendering::Unchecked,
                refusal: Some(refusal),
            },
            Err(error) => Self {
                servo: Box::new(Off::new(transducers)),
                rendering: Rendering::Off,
                refusal: Some(error.map_or(refusal, |error| error.to_string())),
            },
        }
    }
}

/// The servo of a scene file, as `haptic run` builds it.
///
/// # Errors
/// The reason of a refusal, in a sentence, without remedies: the page's verdict has them.
pub fn certified(
    file: &SceneFile,
    transducers: &Transducers,
) -> Result<Box<dyn Controller>, String> {
    transducers
        .check(file.scene.timing, file.scene.torque_limit)
        .map_err(|error| error.to_string())?;
    assess(&file.scene).outcome.map_err(|rejection| rejection.to_string())?;
    let certified = file.scene.certify().map_err(|rejection| rejection.to_string())?;
    controller::<_, f32>(&certified, transducers).map_err(|error| error.to_string())
}

/// A motor that is off: the encoder is read, and every code is mid-scale.
struct Off {
    position: Position,
    radians_per_count: f64,
}

impl Off {
    fn new(transducers: &Transducers) -> Self {
        let radians_per_count = std::f64::consts::TAU / transducers.counts_per_turn;
        Self { position: Position::new(CounterWidth::Bits32), radians_per_count }
    }
}

impl Controller for Off {
    fn tick(&mut self, raw: i32) -> Tick {
        self.position.update(RawCount::from(raw));
        let count = self.position.count();
        Tick {
            count,
            angle: count as f64 * self.radians_per_count,
            torque: 0.0,
            code: DacCode::MID_SCALE.get(),
            limit: LimitReason::None,
        }
    }

    fn tick_at(&mut self, _: f64) -> Result<f64, OutOfRange> {
        Ok(0.0)
    }
}
