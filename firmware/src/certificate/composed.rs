//! The index of a sum of a torque profile, a wall and a canceller: the sum of their bounds, which hold with
//! the torque of the sum limited at any level (theory, section 14.3).

use super::loop_intervals::LoopIntervals;
use super::model::{Washout, canceller, damper, feedthrough_of_canceller};
use super::profile::{ExtremeSlopes, delay_at_port, part_of_sample, profile_bound_at_port};
use crate::environment::{Composed, Environment, Wall};
use crate::passivity::interval::Interval;

/// Upper bound on the index at the device's port, without a coupling: equation 48 with the slopes of the
/// wall's spring added. `None` if none is known: with a canceller or a damper, or if there is none for the
/// profile alone.
pub(super) const fn composed_bound_at_port(
    composed: &Composed,
    n: &LoopIntervals,
) -> Option<Interval> {
    let (Some(alone), Some(late)) = (profile_bound_at_port(&composed.profile, n), delay_at_port(n))
    else {
        return None;
    };
    let Some(wall) = &composed.wall else {
        return if composed.residual.is_none() { Some(alone) } else { None };
    };
    if composed.residual.is_some() || wall.damping != 0.0 {
        return None;
    }
    let Some(slopes) = ExtremeSlopes::of::<Environment>(&composed.profile, n) else { return None };
    let spring = n.coefficient(Interval::decimal(wall.stiffness)).mul(n.period);
    let samples = Interval::exact(wall.delay as f64 + 0.5).add(late);
    // The ripple of both slopes together, less the ripple of the profile, which is in the profile's own
    // bound.
    let both = slopes.steepest().mul(n.period).double().add(spring);
    let ripple = part_of_sample(late).mul(spring).mul(both).div(n.delta.double().double());
    Some(alone.add(spring.mul(samples)).add(ripple))
}

/// Largest error of the torque of wall and canceller in N m, for errors of up to 1 rad in each position.
pub(super) fn peak_gain_beside(composed: &Composed, n: &LoopIntervals) -> f64 {
    let of_washout = |washout: Washout| {
        let decays = Interval::ONE.sub(washout.pole.abs());
        let after = Interval::ONE.sub(washout.pole).div(decays);
        washout.gain.div(n.period).abs().mul(Interval::ONE.add(after))
    };
    let of_wall = |wall: &Wall| {
        let spring = n.coefficient(Interval::decimal(wall.stiffness)).abs();
        spring.add(of_washout(damper(wall, n)))
    };
    let wall = composed.wall.as_ref().map_or(Interval::ZERO, of_wall);
    let cancelled = composed.residual.map_or(Interval::ZERO, |_| of_washout(canceller(n)));
    wall.add(cancelled).hi()
}

/// Largest relative difference between the rounded gains that solve a tick in contact and out of it: a face
/// changes the torque of the other parts by this fraction.
pub(super) fn jump_at_face(composed: &Composed, n: &LoopIntervals) -> f64 {
    match &composed.wall {
        Some(wall) if wall.one_sided && wall.delay == 0 => {
            let free = match composed.residual {
                Some(_) => feedthrough_of_canceller(n),
                None => Interval::ZERO,
            };
            let spring = n.coefficient(Interval::decimal(wall.stiffness));
            let contact = free.add(spring).add(damper(wall, n).gain.div(n.period));
            n.solved(contact).sub(n.solved(free)).magnitude()
        }
        _ => 0.0,
    }
}
