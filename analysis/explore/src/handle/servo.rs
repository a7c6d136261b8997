//! The servo that renders a scene: the certified servo; or a servo without proof, in simulation only; or
//! none.

use haptic_model::controller::{Controller, controller};
use haptic_model::file::SceneFile;
use haptic_servo::certificate::assess;
use haptic_servo::servo::Transducers;
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
    pub servo: Box<dyn Controller>,
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
                servo: Box::new(Unchecked::off(transducers)),
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
        .check(file.scene.timing, file.scene.latency.encoder, file.scene.torque_limit)
        .map_err(|error| error.to_string())?;
    assess(&file.scene).outcome.map_err(|rejection| rejection.to_string())?;
    let certified = file.scene.certify().map_err(|rejection| rejection.to_string())?;
    controller::<_, f32>(&certified, transducers).map_err(|error| error.to_string())
}
