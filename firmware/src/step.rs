//! The steps from a scene to its servo: a board reports the failed step, and its host computes the reason.

use crate::text::words;

words! {
    /// The step from a scene to its servo that failed.
    #[cfg_attr(feature = "wire", derive(serde::Serialize, serde::Deserialize))]
    Step {
    /// Changing the parameters.
    Change "change",
    /// The certificate, including the board's delay and limits of a torque.
    Certificate "certificate",
    /// The servo in its number format, with its transducers.
    Servo "servo",
    }
}
