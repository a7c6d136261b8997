//! Whether a certified scene may have a host that adds torques, and what the host may do, in words.

use std::f64::consts::TAU;

use haptic_servo::dac::DacCode;
use haptic_servo::host::{HostError, HostResponse, HostTorque, Sampling};
use haptic_servo::servo::Transducers;

use crate::file::SceneFile;
use crate::quantity::{rounded_down, significant};

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
    let sampling = sampling(file);
    HostResponse::of(host, &file.scene.latency, &sampling).map(drop)
}

/// The reason why no board has the host beside a scene without a torque limit: that takes the full scale.
pub fn not_on_a_board(file: &SceneFile, host: &HostTorque) -> Option<HostError> {
    let full_scale = file.transducers(None, None).full_scale_torque;
    file.scene.torque_limit.is_none().then(|| host.check_range(None, full_scale).err())?
}

/// How a file's servo reads positions and gives torques, each at its count.
pub fn sampling(file: &SceneFile) -> Sampling {
    let Transducers { counts_per_turn, full_scale_torque, .. } = file.transducers(None, None);
    let code = full_scale_torque / f64::from(DacCode::CODES_TO_FULL_SCALE);
    Sampling::simultaneous(&file.scene.timing, TAU / counts_per_turn, code)
}

/// What the host may do.
pub fn budget(host: &HostTorque) -> String {
    let [energy, power] = [host.energy, host.power].map(|value| significant(value, 12));
    format!("{energy} J at once and {power} W on average, whatever it sends")
}

/// What remedies of a rejected scene leave out.
pub fn without_host(host: &HostTorque) -> String {
    format!(
        "the remedies are those of the scene without its host, whose share of {} N m s/rad has to be below the margin \
         that they leave",
        host.damping
    )
}

/// What the verdict assumes of the host, with the damping that is left for the scene.
pub fn assumption(host: &HostTorque, left: f64) -> String {
    let HostTorque { damping, torque, timeout, .. } = host;
    format!(
        "a host's torque of at most {torque} N m is scaled down to what its budget pays for, {}, and fades to zero \
         within {timeout} s if it is not renewed; its share of {damping} N m s/rad is taken from delta, which leaves \
         {} N m s/rad for the scene, and from the damping that the device may lose without the host",
        budget(host),
        rounded_down(left, 12)
    )
}
