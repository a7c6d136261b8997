//! The index of a torque profile, which depends only on its extreme slopes (theory, section 14).

use super::loop_intervals::LoopIntervals;
use crate::environment::{Ends, Environment, EnvironmentModel, Profile, SnapPoint};
use crate::passivity::interval::Interval;

/// The steepest slopes of a profile with rounded coefficients, in N m/rad, both not negative. For an
/// undelayed profile they are those behind the coupling.
#[derive(Clone, Copy)]
pub(super) struct ExtremeSlopes {
    /// The slope of a rising torque, which pushes back.
    pub rise: Interval,
    /// The slope of a falling torque, which pulls on.
    pub fall: Interval,
}

impl ExtremeSlopes {
    /// `None` if there is none, because a torque in front of the coupling rises faster than the coupling's
    /// own.
    #[cfg_attr(target_os = "none", inline(never))]
    pub const fn of<E: EnvironmentModel>(profile: &Profile, n: &LoopIntervals) -> Option<Self> {
        let Self { rise, fall } = Self::of_table::<E>(profile, n);
        if profile.delay > 0 || !E::PROFILE.is_prompt {
            return Some(Self { rise, fall });
        }
        let left = Interval::ONE.sub(rise.mul(n.compliance));
        if !left.is_positive() {
            return None;
        }
        let fed_back = Interval::ONE.add(fall.mul(n.compliance));
        Some(Self { rise: rise.div(left), fall: fall.div(fed_back) })
    }

    /// The slopes of the table, its end stops and the line to a snap point, independently of the coupling:
    /// all branches have the same slopes.
    pub const fn of_table<E: EnvironmentModel>(profile: &Profile, n: &LoopIntervals) -> Self {
        let outline = profile.outline();
        let unit = around(n.format.torque_of_part(profile.scale().torque_of_part));
        let unit = unit.mul(parts_per_rad(profile, n));
        let inside = unit.mul(Interval::exact(outline.rise as f64));
        let rise = match profile.ends {
            Some(Ends { stiffness, .. }) => inside.max(n.coefficient(Interval::decimal(stiffness))),
            None => inside,
        };
        let fall = unit.mul(Interval::exact(outline.fall as f64));
        match &profile.snap {
            Some(snap) if E::PROFILE.snaps => {
                let line = line(snap, profile, n);
                Self { rise: rise.add(line), fall: fall.sub(line).max(Interval::ZERO) }
            }
            _ => Self { rise, fall },
        }
    }

    /// The steeper of the two.
    pub const fn steepest(&self) -> Interval {
        self.rise.max(self.fall)
    }
}

/// Slope in N m/rad of the line to a snap point, with the law's rounding.
const fn line(snap: &SnapPoint, profile: &Profile, n: &LoopIntervals) -> Interval {
    let part = snap.torque_of_part(profile.torque, profile.outline().knots);
    around(n.format.torque_of_part(part)).mul(parts_per_rad(profile, n))
}

/// Whether branches may change between the torques of a profile: the steps of a profile that is late by at
/// most a sample telescope from branch to branch; at the port none do (theory, section 14.5).
const fn snaps_unproved(profile: &Profile, n: &LoopIntervals) -> bool {
    profile.snap.is_some() && (profile.delay > 1 || n.coupling.is_none())
}

/// Upper bound on the index of a profile: `T L/2` for a torque that is a sample late and rises by up to `L`,
/// `T M` for each sample more, where `M` is the steepest slope (equation 46). An undelayed profile has `T/2`
/// times the steepest fall (equation 47).
///
/// A limit on the torque reduces slopes and adds none.
pub(super) const fn profile_bound<E: EnvironmentModel>(
    profile: &Profile,
    n: &LoopIntervals,
) -> Option<Interval> {
    if is_motor(profile) || E::PROFILE.snaps && snaps_unproved(profile, n) {
        return None;
    }
    let Some(slopes) = ExtremeSlopes::of::<E>(profile, n) else { return None };
    let half = n.period.half();
    if profile.delay == 0 && E::PROFILE.is_prompt {
        return Some(half.mul(slopes.fall));
    }
    let more = Interval::exact(profile.delay as f64 - 1.0);
    let damping = damper::<E>(profile, n).mul(n.period).abs();
    let late = n.period.mul(more).mul(slopes.steepest());
    Some(half.mul(slopes.rise).add(late).add(damping))
}

/// The gain from changes of position to changes of torque, times the period: [`super::model::largest_gain`].
/// With snap points, that of a branch.
pub(super) const fn profile_gain<E: EnvironmentModel>(
    profile: &Profile,
    n: &LoopIntervals,
) -> Option<Interval> {
    let Some(slopes) = ExtremeSlopes::of::<E>(profile, n) else { return None };
    let damping = damper::<E>(profile, n).mul(n.period).abs();
    Some(slopes.steepest().mul(n.period).add(damping.double()))
}

/// Largest error of the whole controller's torque in N m, for errors of up to 1 rad in each position: the sum
/// of the steepest slope `M`, twice the damper's `B / T`, and `beside` for the other parts. Earlier torques
/// are fed back through a coupling whose compliances add up to `V`, and the sum is `M / (1 - M V)`. `None` if
/// the sum diverges.
pub(super) const fn peak_gain(
    profile: &Profile,
    beside: f64,
    n: &LoopIntervals,
    compliance: f64,
) -> Option<f64> {
    let steepest = ExtremeSlopes::of_table::<Environment>(profile, n).steepest();
    let gain =
        steepest.add(damper::<Environment>(profile, n).abs().double()).add(Interval::exact(beside));
    if profile.delay == 0 && !n.is_matched {
        // In front of the coupling.
        return Some(gain.hi());
    }
    let left = Interval::ONE.sub(gain.mul(Interval::exact(compliance)));
    if left.is_positive() { Some(gain.div(left).hi()) } else { None }
}

/// Largest torque in N m over a part of a cell, which is the smallest step of a place.
pub(super) const fn step_of_part(profile: &Profile, n: &LoopIntervals) -> f64 {
    ExtremeSlopes::of_table::<Environment>(profile, n)
        .steepest()
        .div(parts_per_rad(profile, n))
        .hi()
}

/// Whether a nonzero mean torque would turn the device without end.
pub(super) const fn is_motor(profile: &Profile) -> bool {
    let outline = profile.outline();
    match profile.ends {
        // Only springs that push back keep the device within its ends.
        Some(Ends { stiffness, .. }) => stiffness.is_nan() || stiffness <= 0.0,
        None => outline.sum != 0 || !outline.wraps,
    }
}

/// Whether a torque limit may make it a motor: if it repeats without end and its torque is clipped more on
/// one side than on the other.
pub(super) const fn is_motor_where_limited<E: EnvironmentModel>(profile: &Profile) -> bool {
    let is_odd = profile.outline().is_odd
        && match &profile.snap {
            Some(snap) if E::PROFILE.snaps => snap.is_centred(),
            _ => true,
        };
    profile.ends.is_none() && !is_odd
}

/// `B / T` in N m/rad of its damper.
pub(super) const fn damper<E: EnvironmentModel>(profile: &Profile, n: &LoopIntervals) -> Interval {
    match profile.damping {
        Some(damping) if E::PROFILE.is_damped => {
            n.coefficient(Interval::decimal(damping).div(n.period))
        }
        _ => Interval::ZERO,
    }
}

/// Parts of a cell per rad, with the law's rounding.
const fn parts_per_rad(profile: &Profile, n: &LoopIntervals) -> Interval {
    around(n.format.parts_per_rad(profile.scale().parts_per_rad))
}

/// An interval around a number that was computed with a few roundings.
const fn around(value: f64) -> Interval {
    Interval::exact(value).mul(Interval::new(1.0 - 4.0 * f64::EPSILON, 1.0 + 4.0 * f64::EPSILON))
}
