//! The host of a scene file, whose torques an energy budget limits.

use haptic_servo::host::HostTorque;

use super::faults::Read;
use super::key;
use super::section::Section;
use super::simulation::Simulation;
use crate::missed::Missed;

/// Reads `[host]`.
pub fn host(mut section: Section<'_>) -> Read<HostTorque> {
    let keys = [
        &key::HOST_ENERGY,
        &key::HOST_POWER,
        &key::HOST_DAMPING,
        &key::HOST_TORQUE,
        &key::HOST_TIMEOUT,
    ];
    let [energy, power, damping, torque, timeout] = keys.map(|key| section.number(key));
    section.finish();
    Ok(HostTorque {
        energy: energy?,
        power: power?,
        damping: damping?,
        torque: torque?,
        timeout: timeout?,
    })
}

/// Checks a host against the scene's torques, the motor's full scale, both in N m, and a simulation. The scene's
/// torques are its limit and what opposes cogging.
pub fn check(
    top: &Section<'_>,
    host: Option<&HostTorque>,
    limits: [Option<f64>; 2],
    simulation: Option<&Simulation>,
) -> Read<()> {
    let [limit, full_scale] = limits;
    let driven = simulation.filter(|simulation| simulation.host.is_some());
    let torques = |reason: String| Err(top.conflict(&key::HOST_TORQUES, reason));
    let Some(host) = host else {
        let needed = "needs the table `host` with a budget".to_owned();
        return driven.map_or(Ok(()), |_| torques(needed));
    };
    if let Some(full_scale) = full_scale
        && host.check_range(limit, full_scale).is_err()
    {
        let (limit_key, full_key) = (key::TORQUE_LIMIT.path, key::FULL_SCALE.path);
        let cogging = key::ANTICOGGING.path;
        let reason = match limit {
            Some(limit) => format!(
                "and the {limit} N m of the scene, `{limit_key}` with any `{cogging}`, are together above `{full_key}` = {full_scale} N m"
            ),
            None => format!("needs `{limit_key}`, or the scene takes all of `{full_key}`"),
        };
        return Err(top.conflict(&key::HOST_TORQUE, reason));
    }
    let left_out = driven.and_then(|simulation| {
        let laws = [(&key::MISSED, simulation.missed), (&key::FAILED, simulation.dropped)];
        laws.into_iter().find(|(_, law)| *law != Missed::None)
    });
    if let Some((key, _)) = left_out {
        return torques(format!("stands beside `{}`, in which nothing pays", key.path));
    }
    Ok(())
}
