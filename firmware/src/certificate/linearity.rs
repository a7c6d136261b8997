//! Which scenes are judged by a bound in place of the exact rule.

use crate::environment::{Environment, Wall};
use crate::latency::Latency;
use crate::scene::{Coupling, Scene};

/// Whether the scene is judged by the nonlinear bound.
pub(super) const fn is_nonlinear(scene: &Scene) -> bool {
    scene.torque_limit.is_some()
        || scene.environment.parts().is_switched()
        || !scene.environment.has_transfer()
        || replaces_exact_rule(scene)
}

/// Whether a scene without a coupling is judged by its index at the port although it is linear: the exact
/// rule has no proof for missed updates beside latency, and none for jitter, or updates beside a sensor filter, that
/// cost a spring nothing. For torques and counts that deviate at the same time the exact rule alone has a proof. Of
/// an encoder's age, window, nonlinearity and dropped readings the index of a spring takes no more than the exact
/// rule does.
const fn replaces_exact_rule(scene: &Scene) -> bool {
    let (latency, encoder) = (&scene.latency, scene.latency.encoder);
    if latency.is_none() && encoder.is_ideal() || !matches!(scene.coupling, Coupling::Rigid) {
        return false;
    }
    let Environment::Parts(parts) = &scene.environment else { return false };
    if parts.profile.is_some() || matches!(&parts.wall, Some(wall) if wall.stiffness < 0.0) {
        return false;
    }
    let is_in_window = latency.total_jitter() > 0.0 || latency.is_filtered_beside_updates();
    let is_in_one_window = is_in_window && !latency.jitters_twice();
    let misses_updates = scene.timing.longer_period().is_some();
    let is_damped = parts.is_damped();
    let is_late_or_missed =
        !latency.is_none() && (misses_updates || !is_damped && is_in_one_window);
    let is_beyond_exact_rule = match is_damped {
        true => encoder.linearity != 0.0 && (misses_updates || !is_delay_alone(latency)),
        false => {
            let is_beyond_times = encoder.linearity != 0.0 || encoder.dropped > 0;
            is_beyond_times || !encoder.is_ideal() && !latency.jitters_twice()
        }
    };
    is_late_or_missed || is_beyond_exact_rule
}

/// Whether all of a latency is one known delay, for which the exact rule covers a nonlinear encoder.
pub(super) const fn is_delay_alone(latency: &Latency) -> bool {
    latency.total_jitter() == 0.0
        && latency.output_delay.is_exact()
        && latency.actuator_lag.is_zero()
        && latency.sensor_lag.is_zero()
        && latency.actuator_response.is_zero()
        && latency.actuator_updates == 0
}

/// Whether a nonlinear encoder reads the device behind whose coupling spring a static environment is, of which no part
/// is late: the whole controller is then a static law (theory, section 18.3).
pub(super) const fn is_behind_spring(scene: &Scene) -> bool {
    matches!(scene.coupling, Coupling::Spring { .. })
        && scene.latency.encoder.linearity != 0.0
        && is_nonlinear(scene)
        && scene.environment.parts().longest_delay() == 0
        && is_static(&scene.environment)
}

/// Whether a dropped reading costs a scene no more than its age: the torque depends on one position.
pub const fn is_static_at_port(scene: &Scene) -> bool {
    matches!(scene.coupling, Coupling::Rigid) && is_static(&scene.environment)
}

/// Whether the torque depends on one position, without dampers, and pushes back.
const fn is_static(environment: &Environment) -> bool {
    let Environment::Parts(parts) = environment else { return false };
    let pushes = match &parts.wall {
        Some(wall) => wall.stiffness >= 0.0,
        None => true,
    };
    pushes && !parts.is_damped() && !environment.snaps()
}

/// The wall that is all of an environment, late and without a damper.
pub(super) const fn late_spring(environment: &Environment) -> Option<&Wall> {
    match environment.wall() {
        Some(wall)
            if environment.parts().count() == 1
                && wall.delay > 0
                && wall.damping() == 0.0
                && wall.stiffness >= 0.0 =>
        {
            Some(wall)
        }
        _ => None,
    }
}
