//! Anticogging outside of the coupling: a static law at the port with its own part of the passivity, and the scene
//! with the rest (theory, section 18.6, equation 70).

use super::loop_intervals::LoopIntervals;
use super::static_law::{End, needed_by_profile};
use crate::environment::{Environment, EnvironmentModel};
use crate::number::Format;
use crate::passivity::interval::Interval;
use crate::scene::Scene;

/// The passivity in N m s/rad that the anticogging needs, which is not the scene's then: 0 without one. `None` if no
/// bound is known for these times.
#[inline(never)]
const fn passivity_taken<E: EnvironmentModel>(
    scene: &Scene,
    is_late: bool,
    format: Format,
) -> Option<f64> {
    let anticogging = match &scene.environment.parts().anticogging {
        Some(anticogging) if E::PARTS.anticogging => anticogging,
        _ => return Some(0.0),
    };
    let n = &LoopIntervals::timed(scene.timing, format);
    let profile = &anticogging.profile(is_late as usize);
    let needed = some!(needed_by_profile::<E>(profile, scene, n, End::Upper));
    // All indices are scaled to the worst period.
    Some(Interval::exact(needed).mul(n.stretch).hi())
}

/// The passivity in N m s/rad that the anticogging leaves of that of the device: 0 if it leaves none.
#[inline(always)]
pub(crate) const fn passivity_left<E: EnvironmentModel>(
    scene: &Scene,
    is_late: bool,
    format: Format,
) -> f64 {
    let declared = scene.device.passivity();
    let has_none = !E::PARTS.anticogging || scene.environment.parts().anticogging.is_none();
    // A device without passivity stays one.
    if has_none || declared.is_nan() || declared <= 0.0 {
        return declared;
    }
    match passivity_taken::<E>(scene, is_late, format) {
        Some(taken) => Interval::decimal(declared).sub(Interval::exact(taken)).lo().max(0.0),
        None => 0.0,
    }
}

/// The passivity that the anticogging of a scene needs, in N m s/rad, with the coefficients rounded to a number
/// format: 0 without one. `None` if no bound is known for its times.
pub const fn passivity_for_anticogging(scene: &Scene, format: Format) -> Option<f64> {
    passivity_taken::<Environment>(scene, scene.environment.is_late(), format)
}

#[cfg(test)]
mod tests;
