//! Whether a certified scene may have a host that adds torques, and what the host may do, in words.

use haptic_servo::host::{HostError, HostResponse, HostTorque, Sampling};

use crate::file::SceneFile;
use crate::quantity::rounded_down;

/// Checks the host of a file against the margins of its certified scene.
pub fn check(
    file: &SceneFile,
    host: &HostTorque,
    margins: impl Iterator<Item = Option<f64>>,
) -> Result<(), HostError> {
    host.check()?;
    if file.supply.is_some_and(|supply| supply.stores()) {
        return Err(HostError::Stores);
    }
    for margin in margins {
        host.check_share(margin)?;
    }
    let count = file.encoder_step.unwrap_or(0.0);
    let sampling = Sampling::simultaneous(&file.scene.timing, count);
    HostResponse::of(host, &file.scene.latency, &sampling).map(drop)
}

/// What the host may do.
pub fn budget(host: &HostTorque) -> String {
    let HostTorque { energy, power, .. } = host;
    format!("{energy} J at once and {power} W on average, whatever it sends")
}

/// What the verdict assumes of the host, with the damping that is left for the scene.
pub fn assumption(host: &HostTorque, left: f64) -> String {
    let HostTorque { damping, torque, timeout, .. } = host;
    format!(
        "a host's torque of at most {torque} N m is scaled down to what its budget pays for, {}, and fades to zero \
         within {timeout} s if it is not renewed; its share of {damping} N m s/rad is taken from delta, which leaves \
         {} N m s/rad for the scene",
        budget(host),
        rounded_down(left, 12)
    )
}
