//! The tables that only a simulation uses.

use super::quoted;
use crate::device::Hand;
use crate::file::simulation::{HandTorque, Simulation};
use crate::missed::Missed;

/// `[simulation]`.
pub fn simulation(lines: &mut Vec<String>, simulation: &Simulation) {
    let Simulation {
        samples,
        position,
        velocity,
        torque,
        friction,
        latency,
        missed,
        dropped,
        host,
    } = simulation;
    lines.push(format!("[simulation]\nsamples = {samples}"));
    lines.push(format!("position = {position:?}\nvelocity = {velocity:?}"));
    lines.extend(hand_torque(torque));
    lines.extend(host.as_ref().map(|torques| format!("host = {torques:?}")));
    lines.push(format!("friction = {friction:?}\nlatency = {latency:?}"));
    lines.extend([("missed", missed), ("dropped", dropped)].into_iter().filter_map(
        |(name, law)| match law {
            Missed::None => None,
            Missed::Every { count, length } => {
                Some(format!("{name} = {{ every = {count}, length = {length} }}"))
            }
            Missed::Random { fraction, seed } => {
                Some(format!("{name} = {{ fraction = {fraction:?}, seed = {seed} }}"))
            }
        },
    ));
}

fn hand_torque(torque: &HandTorque) -> Option<String> {
    Some(match torque {
        HandTorque::Free => return None,
        HandTorque::Held(values) => format!("torque = {values:?}"),
        HandTorque::File(path) => format!("torque_file = {}", quoted(&path.to_string_lossy())),
        HandTorque::Sine { amplitude, omega, phase, held } => format!(
            "torque_sine = {{ amplitude = {amplitude:?}, omega = {omega:?}, phase = {phase:?}, \
             held = {held} }}"
        ),
        HandTorque::Pulses { amplitude, every, length } => format!(
            "torque_pulses = {{ amplitude = {amplitude:?}, every = {every}, length = {length} }}"
        ),
    })
}

/// `[human]`.
pub fn hand(lines: &mut Vec<String>, hand: &Hand) {
    let Hand { inertia, damping, stiffness } = hand;
    lines.push("[human]".to_owned());
    lines.push(format!("inertia = {inertia:?}\ndamping = {damping:?}\nstiffness = {stiffness:?}"));
}
