//! Which scenes are judged by a bound in place of the exact rule.

use crate::environment::{Environment, Parts};
use crate::scene::{Coupling, Scene};

/// Whether the scene is judged by the nonlinear bound.
pub(super) const fn is_nonlinear(scene: &Scene) -> bool {
    scene.torque_limit.is_some()
        || matches!(scene.environment.wall(), Some(w) if w.is_one_sided())
        || !scene.environment.has_transfer()
        || replaces_exact_rule(scene)
}

/// Whether a scene without a coupling is judged by its index at the port although it is linear: the exact
/// rule has no proof for missed updates beside latency, and none for jitter that costs a spring nothing. For
/// torques and counts that deviate at the same time the exact rule alone has a proof.
const fn replaces_exact_rule(scene: &Scene) -> bool {
    let latency = &scene.latency;
    if latency.is_none() || !matches!(scene.coupling, Coupling::Rigid) {
        return false;
    }
    let Environment::Parts(Parts { canceller, wall, profile: None }) = &scene.environment else {
        return false;
    };
    let (damping, pulls) = match wall {
        Some(wall) => (wall.damping(), wall.stiffness < 0.0),
        None => (0.0, false),
    };
    let has_damping = damping != 0.0 || canceller.is_some();
    let has_one_jitter = latency.total_jitter() > 0.0 && !latency.jitters_twice();
    !pulls && (scene.timing.longer_period().is_some() || !has_damping && has_one_jitter)
}
