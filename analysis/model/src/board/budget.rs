//! The budget of a host on a board, as parameters with the names of a scene file.

use haptic_servo::host::HostTorque;

use crate::file::key;

/// Its numbers and their names.
pub fn numbers(mut host: HostTorque) -> [(&'static str, f64); 5] {
    places(&mut host).map(|(name, value)| (name, *value))
}

/// The name of this text; `None` if no number of a budget has it.
pub fn name(text: &str) -> Option<&'static str> {
    NAMES.into_iter().find(|name| *name == text)
}

/// The budget with some numbers changed.
pub fn changed(mut host: HostTorque, changes: &[(&'static str, f64)]) -> HostTorque {
    for (name, value) in places(&mut host) {
        if let Some((_, to)) = changes.iter().find(|(changed, _)| *changed == name) {
            *value = *to;
        }
    }
    host
}

/// The names.
pub const NAMES: [&str; 5] = [
    key::HOST_ENERGY.path,
    key::HOST_POWER.path,
    key::HOST_DAMPING.path,
    key::HOST_TORQUE.path,
    key::HOST_TIMEOUT.path,
];

fn places(host: &mut HostTorque) -> [(&'static str, &mut f64); 5] {
    let HostTorque { energy, power, damping, torque, timeout } = host;
    let [a, b, c, d, e] = NAMES;
    [(a, energy), (b, power), (c, damping), (d, torque), (e, timeout)]
}
