//! What each part of a sum adds to the numbers of the certificate, apart from a torque profile: its transfer
//! function, its bounds (theory, sections 5, 14.3 and 16), and the errors of its torque (section 14.4).
//!
//! A program omits the code for a canceller or a drag that its type of environment does not have
//! ([`EnvironmentModel::PARTS`]). A drag adds what a wall without stiffness adds (equation 69).

use super::loop_intervals::LoopIntervals;
use super::profile::{profile_bound, profile_gain};
use crate::environment::{Canceller, EnvironmentModel, Parts, Wall};
use crate::number::Format;
use crate::passivity::interval::Interval;
use crate::passivity::polynomial::Polynomial;
use crate::passivity::transfer::Transfer;

/// Writes the sum of the transfer functions into `out`; `false` if its degree is too high. A torque profile is late
/// and has none: it adds no feedthrough. In place, and each part by itself, for the stack of a small board.
#[inline(never)]
pub(super) const fn transfer(out: &mut Transfer, parts: &Parts, n: &LoopIntervals) -> bool {
    *out = Transfer::ZERO;
    let mut is_first = true;
    if let Some(canceller) = &parts.canceller {
        *out = free_mode(canceller, n);
        is_first = false;
    }
    if let Some(wall) = &parts.wall {
        if !add(out, &self::wall(wall, n), is_first) {
            return false;
        }
        is_first = false;
    }
    match &parts.drag {
        Some(drag) => add(out, &self::wall(&drag.as_wall(), n), is_first),
        None => true,
    }
}

/// The first part is the sum itself, without the rounding of an addition.
#[inline(never)]
const fn add(sum: &mut Transfer, part: &Transfer, is_first: bool) -> bool {
    if is_first {
        *sum = *part;
        return true;
    }
    sum.add(part)
}

/// `z^-n (K + B (1 - a)(z - 1) / (T (z - a)))`, `a = 0` without a filter (equation 24).
const fn wall(w: &Wall, n: &LoopIntervals) -> Transfer {
    let k = n.coefficient(Interval::decimal(w.stiffness));
    let Washout { gain: b, pole: a } = damper(w, n);
    let denominator = Polynomial::ascending(&[a.neg().mul(n.period), n.period]);
    let shift = -(w.delay as i32);
    if k.is_zero() {
        // A pure damper keeps its exact zero at z = 1; so does a wall whose stiffness is rounded to zero.
        let numerator = Polynomial::ascending(&[b]);
        return Transfer { shift, ones: 1, ..Transfer::new(numerator, denominator) };
    }
    let kt = k.mul(n.period);
    let numerator = Polynomial::ascending(&[kt.mul(a).add(b).neg(), kt.add(b)]);
    Transfer { shift, ..Transfer::new(numerator, denominator) }
}

/// `(gain / T) (z - 1) / (z - pole)`, as a servo computes it: from the gain over the period and
/// from the rate `1 - pole`.
pub(super) struct Washout {
    pub gain: Interval,
    pub pole: Interval,
}

impl Washout {
    /// From the unrounded gain over the period and the unrounded rate.
    const fn rounded(gain: Interval, rate: Interval, n: &LoopIntervals) -> Self {
        let gain = n.coefficient(gain).mul(n.period);
        Self { gain, pole: Interval::ONE.sub(n.coefficient(rate)) }
    }

    /// `sum abs(h)` of its impulse response from velocity to torque.
    const fn l1_norm(&self) -> Interval {
        self.gain.abs().div(Interval::ONE.sub(self.pole.abs()))
    }
}

/// The damper of a wall.
pub(super) const fn damper(w: &Wall, n: &LoopIntervals) -> Washout {
    let b = Interval::decimal(w.damping());
    let rate = match w.filter() {
        Some(a) if w.damping() != 0.0 => Interval::ONE.sub(Interval::decimal(a)),
        _ => Interval::ONE,
    };
    match (n.format, w.filter()) {
        (Format::F64, Some(a)) if w.damping() != 0.0 => {
            Washout { gain: b.mul(rate), pole: Interval::decimal(a) }
        }
        (Format::F64, _) => Washout { gain: b, pole: Interval::ZERO },
        _ => Washout::rounded(b.div(n.period).mul(rate), rate, n),
    }
}

/// `-be K (z - 1) / ((K T + be) z - be)`, for a rigid coupling `-be (z - 1) / (T z)` (equation
/// 23, generalised from `K = 2 b / T` to any coupling spring), late by the canceller's delay.
const fn free_mode(canceller: &Canceller, n: &LoopIntervals) -> Transfer {
    let be = n.cancelled;
    let (gain, denominator) = match (n.format, n.coupling) {
        (Format::F64, Some(k)) => {
            let kt = k.mul(n.period);
            (be.mul(k), Polynomial::ascending(&[be.neg(), kt.add(be)]))
        }
        (Format::F64, None) => (be, Polynomial::ascending(&[Interval::ZERO, n.period])),
        _ => {
            let Washout { gain, pole } = self::canceller(n);
            (gain, Polynomial::ascending(&[pole.neg().mul(n.period), n.period]))
        }
    };
    let numerator = Polynomial::ascending(&[gain.neg()]);
    let shift = -(canceller.delay as i32);
    Transfer { shift, ones: 1, ..Transfer::new(numerator, denominator) }
}

/// The canceller as a servo computes it, with the opposite sign.
pub(super) const fn canceller(n: &LoopIntervals) -> Washout {
    let be = n.cancelled;
    match n.coupling {
        Some(k) => {
            let kt = k.mul(n.period);
            let leading = kt.add(be);
            Washout::rounded(be.mul(k).div(leading), kt.div(leading), n)
        }
        None => Washout::rounded(be.div(n.period), Interval::ONE, n),
    }
}

/// The factor of the servo's rounded gains, from the [feedthrough](Transfer::feedthrough) of the sum, or of all
/// parts but a wall that is not in contact. `None` if it is unknown.
pub(super) const fn solved<E: EnvironmentModel>(
    parts: &Parts,
    n: &LoopIntervals,
    is_in_contact: bool,
) -> Option<Interval> {
    if parts.profile.is_some() && !E::PROFILE.is_composed {
        return None;
    }
    let mut feedthrough = match &parts.wall {
        Some(wall) if is_in_contact => self::wall(wall, n).feedthrough(),
        _ => Interval::ZERO,
    };
    if let Some(canceller) = &parts.canceller {
        if !E::PARTS.canceller {
            return None;
        }
        feedthrough = feedthrough.add(free_mode(canceller, n).feedthrough());
    }
    if let Some(drag) = &parts.drag {
        if !E::PARTS.drag {
            return None;
        }
        feedthrough = feedthrough.add(self::wall(&drag.as_wall(), n).feedthrough());
    }
    let scale = n.solved(feedthrough);
    if scale.is_finite() { Some(scale) } else { None }
}

/// A quantity of an environment, the sum of those of its parts.
#[derive(Clone, Copy)]
pub(super) enum Quantity {
    /// [`super::model::nonlinear_bound`].
    Index,
    /// [`super::model::largest_gain`].
    Gain,
}

/// The quantity if a tick is solved exactly; `None` if it is unknown of a part, or if the program of the type
/// `E` has no such sum.
pub(super) const fn sum_of<E: EnvironmentModel>(
    quantity: Quantity,
    parts: &Parts,
    n: &LoopIntervals,
) -> Option<Interval> {
    let is_alone = parts.count() == 1;
    let mut sum = match (quantity, &parts.wall) {
        (_, None) => Interval::ZERO,
        (Quantity::Gain, Some(w)) => wall_gain(w, n),
        // A negative spring is not a monotone law.
        (Quantity::Index, Some(w)) if w.stiffness < 0.0 => return None,
        (Quantity::Index, Some(w)) if is_alone => wall_alone_bound(w, n),
        (Quantity::Index, Some(w)) => wall_bound(w, n),
    };
    if let Some(profile) = &parts.profile {
        if !E::PROFILE.exists || !is_alone && !E::PROFILE.is_composed {
            return None;
        }
        let of_profile = match quantity {
            Quantity::Gain => some!(profile_gain::<E>(profile, n)),
            Quantity::Index if !is_alone && profile.snap.is_some() => return None,
            Quantity::Index => some!(profile_bound::<E>(profile, n)),
        };
        sum = of_profile.add(sum);
    }
    if parts.canceller.is_some() {
        if !E::PARTS.canceller {
            return None;
        }
        let bound = some!(canceller_bound(n));
        sum = sum.add(match quantity {
            Quantity::Index => bound,
            Quantity::Gain => bound.double(),
        });
    }
    if let Some(drag) = &parts.drag {
        if !E::PARTS.drag {
            return None;
        }
        let wall = &drag.as_wall();
        sum = sum.add(match quantity {
            Quantity::Index => wall_bound(wall, n),
            Quantity::Gain => wall_gain(wall, n),
        });
    }
    Some(sum)
}

const fn wall_gain(w: &Wall, n: &LoopIntervals) -> Interval {
    let k = n.coefficient(Interval::decimal(w.stiffness)).abs();
    k.mul(n.period).add(switched_damping(w, n).double())
}

/// Sum of the magnitudes of a wall's torques for a unit of velocity.
pub(super) const fn switched_damping(w: &Wall, n: &LoopIntervals) -> Interval {
    match n.format {
        Format::F64 => Interval::decimal(w.damping()).abs(),
        _ => damper(w, n).l1_norm(),
    }
}

const fn wall_bound(w: &Wall, n: &LoopIntervals) -> Interval {
    let damping = switched_damping(w, n);
    if w.delay == 0 {
        let passive = w.filter().is_none() && w.damping() >= 0.0;
        return if passive { Interval::ZERO } else { damping };
    }
    let samples = Interval::exact(w.delay as f64 - 0.5);
    let k = n.coefficient(Interval::decimal(w.stiffness));
    k.mul(n.period).mul(samples).add(damping)
}

/// The same for a wall that is the only part.
const fn wall_alone_bound(w: &Wall, n: &LoopIntervals) -> Interval {
    let bound = wall_bound(w, n);
    if w.filter().is_none() {
        return bound;
    }
    match filtered_bound(w, n) {
        Some(filtered) => filtered.min(bound),
        None => bound,
    }
}

/// The same for a wall on both sides whose velocity is filtered: `(2 n - 1) B (1 - a) / (1 + a)` in place of
/// `abs(B)`, and 0 without delay (equation 61). `None` if the wall or the filter is another.
const fn filtered_bound(w: &Wall, n: &LoopIntervals) -> Option<Interval> {
    let Washout { gain, pole } = damper(w, n);
    let is_filter = gain.lo() >= 0.0 && pole.lo() >= 0.0 && pole.hi() < 1.0;
    if w.is_one_sided() || !is_filter {
        return None;
    }
    if w.delay == 0 {
        return Some(Interval::ZERO);
    }
    let samples = Interval::exact(w.delay as f64 - 0.5);
    let k = n.coefficient(Interval::decimal(w.stiffness));
    let damping = gain.double().div(Interval::ONE.add(pole));
    Some(k.mul(n.period).add(damping).mul(samples))
}

/// Sum of the magnitudes of a canceller's torques for a unit of velocity; `None` if there is none.
const fn canceller_bound(n: &LoopIntervals) -> Option<Interval> {
    let be = n.cancelled;
    match (n.format, n.coupling) {
        (Format::F64, Some(k)) if be.lo() < 0.0 => {
            // Added damping: the lag's pole be / (K T + be) is negative, its l1 norm larger.
            let kt = k.mul(n.period);
            let room = kt.sub(be.abs().double());
            if room.is_positive() { Some(kt.mul(be.abs()).div(room)) } else { None }
        }
        (Format::F64, _) => Some(be.abs()),
        _ => {
            let canceller = canceller(n);
            let settles = Interval::ONE.sub(canceller.pole.abs()).is_positive();
            if settles { Some(canceller.l1_norm()) } else { None }
        }
    }
}

/// The damping that canceller and drag take at the device's port, in N m s/rad; `None` if it is unknown.
pub(super) const fn dampers<E: EnvironmentModel>(
    parts: &Parts,
    n: &LoopIntervals,
) -> Option<Interval> {
    let cancelled = match &parts.canceller {
        Some(_) if E::PARTS.canceller => some!(canceller_bound(n)),
        Some(_) => return None,
        None => Interval::ZERO,
    };
    match &parts.drag {
        Some(drag) if E::PARTS.drag => Some(cancelled.add(switched_damping(&drag.as_wall(), n))),
        Some(_) => None,
        None => Some(cancelled),
    }
}

/// Largest error of the torque of all parts but a torque profile in N m, for errors of up to 1 rad in each position.
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
    let drag = parts.drag.map_or(Interval::ZERO, |drag| of_wall(&drag.as_wall()));
    wall.add(cancelled).add(drag).hi()
}

/// Largest relative difference between the rounded gains that solve a tick in contact and out of it: a face
/// changes the torque of the other parts by this fraction.
pub(super) fn jump_at_face(parts: &Parts, n: &LoopIntervals) -> f64 {
    match &parts.wall {
        Some(wall) if wall.is_one_sided() && wall.delay == 0 => {
            let mut free = match &parts.canceller {
                Some(canceller) => free_mode(canceller, n).feedthrough(),
                None => Interval::ZERO,
            };
            if let Some(drag) = &parts.drag {
                free = free.add(self::wall(&drag.as_wall(), n).feedthrough());
            }
            let spring = n.coefficient(Interval::decimal(wall.stiffness));
            let contact = free.add(spring).add(damper(wall, n).gain.div(n.period));
            n.solved(contact).sub(n.solved(free)).magnitude()
        }
        _ => 0.0,
    }
}
