//! The margin: the damping that the device may lose while everything else stays unchanged.
//!
//! The coupling was designed for the declared passivity. For a device with less, the comparison of index and
//! `delta` does not apply, so the margin is not `delta` less the index.

use super::assessment::Assessment;
use super::loop_intervals::{LoopIntervals, Missed};
use super::model::{largest_gain, largest_solved};
use super::problem::PassivityProblem;
use super::rules::{Rule, RuleAnswer, paper_limit};
use super::static_law::{End, needed_at_port, share_of_damper};
use crate::environment::{Environment, EnvironmentModel, Profile};
use crate::passivity::bernstein::Precision;
use crate::passivity::interval::Interval;
use crate::scene::{Device, Scene};

impl Assessment {
    /// Damping in N m s/rad that the device may certainly lose while coupling, environment and timing stay
    /// unchanged; at most `delta`.
    ///
    /// For a rejected linear scene, the damping that the device lacks, as a negative number. `None` for an
    /// undecided scene and for a rejected one-sided or limited scene, which have no such number, and where it
    /// is not known.
    ///
    /// `scene` is the assessed scene.
    pub const fn margin(&self, scene: &Scene) -> Option<f64> {
        match (self.rule, &self.outcome, self.exact) {
            (Rule::Nonlinear, Ok(()), _) => {
                let (bound, n) = (some!(self.bound), &LoopIntervals::of(scene, self.format));
                let limited = match n.is_at_port {
                    true => Limited::at_port::<Environment>(scene, n, 0.0),
                    false => Limited::of(scene, n, bound),
                };
                match limited {
                    Some(limited) => limited.margin(0.0),
                    None => Some(0.0),
                }
            }
            (Rule::Exact, Ok(()), _) => Some(match self.linear(scene) {
                Some(margin) => margin.max(0.0).min(self.delta.lo()),
                None => 0.0,
            }),
            (Rule::Exact, Err(_), RuleAnswer::Fail) => match self.linear(scene) {
                Some(margin) if margin < 0.0 => Some(margin),
                _ => None,
            },
            _ => None,
        }
    }

    /// For a linear scene: `delta` less the index at the port.
    const fn linear(&self, scene: &Scene) -> Option<f64> {
        let n = LoopIntervals::of(scene, self.format);
        // The search would design a matched coupling anew.
        if n.missed.is_some() && n.latency.is_none() {
            return searched(scene, self);
        }
        let Ok(posed) = &PassivityProblem::in_format(scene, self.format) else { return None };
        let Ok(found) = posed.at_port(&Precision::TIGHT) else { return None };
        Some(n.delta.sub(found.minimum).lo())
    }
}

/// Halvings in the search for a margin.
const HALVINGS: u32 = 24;

/// The margin of a linear scene whose updates may be missed: the largest loss found with which the scene
/// certifies.
const fn searched(scene: &Scene, assessment: &Assessment) -> Option<f64> {
    let declared = scene.device.passivity();
    let (mut passes, mut fails) = (0.0, declared);
    each!(_halving in 0..HALVINGS => {
        let loss = 0.5 * (passes + fails);
        let device = Device { passivity: Some(declared - loss), ..scene.device };
        let scene = Scene { device, ..*scene };
        match &PassivityProblem::in_format(&scene, assessment.format) {
            Ok(posed) if posed.is_certified() => passes = loss,
            _ => fails = loss,
        }
    });
    if assessment.outcome.is_ok() { Some(passes) } else { None }
}

/// A scene whose torque is limited: its own limit, or that of a board.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Limited {
    /// Bound on the index.
    pub bound: Interval,
    /// Its upper bound: [`paper_limit`].
    limit: Interval,
    /// [`largest_gain`].
    gain: Interval,
    /// `K_vc T / 2`.
    pub coupling: Interval,
    delta: Interval,
    missed: Option<Missed>,
    /// Whether torques lag.
    lags: bool,
    /// Whether its torque jumps when a knob snaps, so that [`Limited::gain`] is the gain between two snaps.
    snaps: bool,
    /// Whether other torques may be added to its own; not for an environment that is solved in front of its
    /// coupling.
    takes_more: bool,
    /// Whether there is no coupling, so that [`Limited::gain`] is the share of the passivity that a switched
    /// damper takes, over the damper.
    is_at_port: bool,
}

/// Whether it is a torque profile without delay, whose solution does not include added torques.
const fn is_solved_in_front(environment: &Environment) -> bool {
    matches!(environment.profile(), Some(Profile { delay: 0, .. }))
}

impl Limited {
    /// The limits of a scene without a coupling, whose counts may be read late by `reading` s. `None` if no
    /// bound below its passivity is known.
    #[inline(never)]
    pub const fn at_port<E: EnvironmentModel>(
        scene: &Scene,
        n: &LoopIntervals,
        reading: f64,
    ) -> Option<Self> {
        let bound = Interval::exact(some!(needed_at_port::<E>(scene, n, reading, End::Upper)));
        if !bound.is_below(n.delta) {
            return None;
        }
        Some(Self {
            bound,
            limit: n.delta,
            gain: share_of_damper(scene, n, reading),
            coupling: n.delta,
            delta: n.delta,
            missed: None,
            lags: false,
            snaps: false,
            takes_more: !(E::PROFILE.is_prompt && is_solved_in_front(&scene.environment)),
            is_at_port: true,
        })
    }

    /// The limits of a scene with this bound on its index. `None` if the bound is not below the limit, or no
    /// limit is known.
    pub const fn of(scene: &Scene, n: &LoopIntervals, bound: Interval) -> Option<Self> {
        let solved = some!(largest_solved::<Environment>(&scene.environment, n));
        Self::of_solved::<Environment>(scene, n, bound, solved)
    }

    /// The same if [`largest_solved`] is known.
    pub const fn of_solved<E: EnvironmentModel>(
        scene: &Scene,
        n: &LoopIntervals,
        bound: Interval,
        solved: Interval,
    ) -> Option<Self> {
        let gain = some!(largest_gain::<E>(&scene.environment, solved, n));
        let (coupling, limit) = (some!(n.coupling_damping()), some!(paper_limit(n)));
        if !bound.is_below(limit) {
            return None;
        }
        Some(Self {
            bound,
            limit,
            gain,
            coupling,
            delta: n.delta,
            missed: n.missed,
            lags: n.latency.is_some(),
            snaps: E::PROFILE.snaps && scene.environment.snaps(),
            takes_more: !(E::PROFILE.is_prompt && is_solved_in_front(&scene.environment)),
            is_at_port: false,
        })
    }

    /// The tighter limits of two scenes that only differ in their environment: a loss or an addition that they
    /// allow is allowed by both.
    pub const fn tighter(&self, other: &Self) -> Self {
        Self {
            bound: self.bound.max(other.bound),
            limit: self.limit.min(other.limit),
            gain: self.gain.max(other.gain),
            snaps: self.snaps || other.snaps,
            takes_more: self.takes_more && other.takes_more,
            ..*self
        }
    }

    /// Limit less bound, in N m s/rad.
    pub const fn injectable_damping(&self) -> f64 {
        let left = self.limit.sub(self.bound);
        match (self.takes_more, self.is_at_port) {
            (false, _) => 0.0,
            (true, true) => left.div(self.gain).lo(),
            (true, false) => left.lo(),
        }
    }

    /// The margin while a damper of `injected` N m s/rad may be switched on and off, one sample late, in
    /// addition to the environment; not negative. `None` behind a coupling where torques lag: it is designed
    /// for this passivity, and no loss is known to be allowed.
    ///
    /// Down to `k = K_vc T / 2` conditions 17 and 18 continue to hold. For a device that has only
    /// `delta' < k` the sum over the ticks that theory, section 4, step 5, has is, in the notation of
    /// [`Missed::limit`] and for `delta = k`, `(k - alpha) sum e^2 / T` less `(k - delta') sum d^2 / T`. With
    /// `d = e + V w` and a torque that changes by no more than `norm(w) <= g norm(e)`, that stays positive
    /// while `k - delta' < (k - alpha) / (1 + V g)^2` (equation 37).
    pub const fn margin(&self, injected: f64) -> Option<f64> {
        let injected = Interval::exact(injected);
        if self.is_at_port {
            let left = self.limit.sub(self.bound).sub(injected.mul(self.gain));
            return Some(left.lo().max(0.0));
        }
        if self.lags {
            return None;
        }
        let bound = self.bound.add(injected);
        if !bound.is_below(self.limit) {
            return Some(0.0);
        }
        if self.snaps {
            return Some(self.margin_between_branches());
        }
        let (k, gain) = (self.coupling, self.gain.add(injected.double()));
        // V g, for V = T / (2 k).
        let amplification = Interval::ONE.add(gain.div(k.double()));
        let above = self.delta.sub(k).lo().max(0.0);
        let below = self.delta.min(k).sub(bound).div(amplification.mul(amplification)).lo();
        let margin = match &self.missed {
            None => above + below,
            Some(missed) => where_latched(missed, k, bound, amplification).min(above + below),
        };
        // Each end was rounded, and then their sum.
        Some((margin * (1.0 - f64::EPSILON)).max(0.0).min(self.delta.lo()))
    }

    /// The margin if torques jump and no `g` bounds them: only down to `k`.
    const fn margin_between_branches(&self) -> f64 {
        match &self.missed {
            None => self.delta.sub(self.coupling).lo().max(0.0),
            Some(_) => 0.0,
        }
    }
}

/// The same if torques are latched and updates are missed. As long as the index is below `s k` the form of
/// [`Missed::limit`] for `delta = k` leaves `(s k - alpha) e^2 / T`; of that a device with `delta' >= k / 2`
/// takes `(k - delta') (s d^2 + 2 (1 - s) (V w)^2) / T`. The rest grows with `s` for such a device, so that a
/// pattern of longer and shorter intervals leaves no less.
const fn where_latched(
    missed: &Missed,
    k: Interval,
    bound: Interval,
    amplification: Interval,
) -> f64 {
    let s = Interval::ONE.div(missed.stretch);
    let above = missed.declared.sub(k);
    let left = s.mul(k).sub(bound);
    if left.is_positive() {
        let echo = amplification.sub(Interval::ONE);
        let taken = s.mul(amplification).mul(amplification);
        let taken = taken.add(Interval::ONE.sub(s).double().mul(echo).mul(echo));
        return above.lo().max(0.0) + left.div(taken).lo().min(k.half().lo());
    }
    // Solved for the passivity at which the limit equals the bound.
    let needed = missed.stretch.sub(Interval::ONE).mul(bound).mul(k).div(k.sub(bound));
    above.lo().min(missed.declared.sub(needed).lo())
}
