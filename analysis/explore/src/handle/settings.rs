//! The rendered scene, and the hand that holds it.

use haptic_model::device::Hand;
use serde::Deserialize;

/// The rendered scene, and the hand that holds it.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Settings {
    pub scene: String,
    /// Counts per turn of a quadrature encoder in place of the scene's; default: the scene's own encoder.
    pub counts_per_turn: Option<f64>,
    pub hand: Hand,
    /// Whether only a certified scene has torque.
    pub is_checked: bool,
    /// The law of a host that wants energy; default: none. A scene without the table `host` has none.
    #[serde(default)]
    pub host: Option<String>,
    /// Whether the host has no tank, and gets every torque.
    #[serde(default)]
    pub has_no_tank: bool,
}

impl Settings {
    /// The hand, if it is passive.
    ///
    /// # Errors
    /// The number that is out of its bounds.
    pub fn passive_hand(&self) -> Result<Hand, String> {
        let Hand { stiffness, damping, inertia } = self.hand;
        for (name, value, unit) in [
            ("stiffness", stiffness, "N m/rad"),
            ("damping", damping, "N m s/rad"),
            ("inertia", inertia, "kg m^2"),
        ] {
            if !(value >= 0.0 && value.is_finite()) {
                return Err(format!(
                    "the hand's {name} of {value} {unit} must be 0 or more, and finite"
                ));
            }
        }
        Ok(self.hand)
    }
}
