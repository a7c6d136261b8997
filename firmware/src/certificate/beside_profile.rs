//! Errors of the torque of a wall and a canceller, alone or beside a torque profile (theory, section 14.4).

use super::loop_intervals::LoopIntervals;
use super::model::{Washout, canceller, damper, free_mode};
use crate::environment::{Parts, Wall};
use crate::passivity::interval::Interval;

/// Largest error of the torque of wall and canceller in N m, for errors of up to 1 rad in each position.
pub(super) fn peak_gain_beside(parts: &Parts, n: &LoopIntervals) -> f64 {
    let of_washout = |washout: Washout| {
        let decays = Interval::ONE.sub(washout.pole.abs());
        let after = Interval::ONE.sub(washout.pole).div(decays);
        washout.gain.div(n.period).abs().mul(Interval::ONE.add(after))
    };
    let of_wall = |wall: &Wall| {
        let spring = n.coefficient(Interval::decimal(wall.stiffness)).abs();
        spring.add(of_washout(damper(wall, n)))
    };
    let wall = parts.wall.as_ref().map_or(Interval::ZERO, of_wall);
    let cancelled = parts.canceller.map_or(Interval::ZERO, |_| of_washout(canceller(n)));
    wall.add(cancelled).hi()
}

/// Largest relative difference between the rounded gains that solve a tick in contact and out of it: a face
/// changes the torque of the other parts by this fraction.
pub(super) fn jump_at_face(parts: &Parts, n: &LoopIntervals) -> f64 {
    match &parts.wall {
        Some(wall) if wall.is_one_sided() && wall.delay == 0 => {
            let free = match &parts.canceller {
                Some(canceller) => free_mode(canceller, n).feedthrough(),
                None => Interval::ZERO,
            };
            let spring = n.coefficient(Interval::decimal(wall.stiffness));
            let contact = free.add(spring).add(damper(wall, n).gain.div(n.period));
            n.solved(contact).sub(n.solved(free)).magnitude()
        }
        _ => 0.0,
    }
}
