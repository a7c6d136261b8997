//! The intervals of a scene, with the passivity that its anticogging leaves.

use super::anticogging::passivity_left;
use super::linearity::{is_behind_spring, is_nonlinear, late_spring};
use super::loop_intervals::{Lagging, LoopIntervals, Missed, has_latency, rounded, standard};
use crate::environment::{Environment, EnvironmentModel, Wall};
use crate::matched::{MatchedCoupling, limit_behind_spring};
use crate::number::{Format, Rounding};
use crate::output_timing::READ_WITHIN;
use crate::passivity::interval::Interval;
use crate::scene::{Coupling, Scene, Timing};

impl LoopIntervals {
    pub const fn of(scene: &Scene, format: Format) -> Self {
        let mut out = Self::of_late::<Environment>(scene, scene.environment.is_late(), format);
        out.is_at_port = matches!(scene.coupling, Coupling::Rigid) && is_nonlinear(scene)
            || is_behind_spring(scene);
        let linearity = scene.latency.encoder.linearity;
        if linearity != 0.0 && out.linearity.is_zero() && !is_nonlinear(scene) {
            // The exact rule has its own proof.
            out.linearity = Interval::decimal(linearity);
            let is_late = scene.environment.is_late();
            let passivity = passivity_left::<Environment>(scene, is_late, format);
            out.delta = Interval::decimal(passivity);
        }
        if let (Some(stiffness), None) = (out.coupling, &out.latency) {
            let unrounded = Interval::ONE.div(stiffness);
            out.is_standard = unrounded.sub(standard(out.period, out.delta)).contains(0.0);
        }
        out
    }

    /// The same if it is known whether the environment [is late](Environment::is_late), for the paper's rule,
    /// which does not depend on whether the coupling is the standard one.
    ///
    /// Only a type that [stores](EnvironmentModel::MEMORY) torques for its coupling has latency on a board:
    /// the program of any other type omits the code. Inlined, because a result of this size would be copied.
    #[inline(always)]
    pub const fn of_late<E: EnvironmentModel>(
        scene: &Scene,
        is_late: bool,
        format: Format,
    ) -> Self {
        let period = Interval::decimal(scene.timing.period);
        let passivity = passivity_left::<E>(scene, is_late, format);
        let delta = Interval::decimal(passivity);
        let (delta, missed) = match scene.timing.longer_period() {
            Some(worst) => {
                let worst = Interval::decimal(worst);
                let missed = Missed { stretch: worst.div(period), declared: delta };
                (delta.mul(period).div(worst), if is_late { Some(missed) } else { None })
            }
            None => (delta, None),
        };
        let cancelled = match scene.environment.canceller() {
            Some(canceller) => {
                Interval::decimal(scene.device.damping).sub(Interval::decimal(canceller.residual))
            }
            None => Interval::ZERO,
        };
        let (coupling, written) = match scene.coupling {
            Coupling::Rigid => (None, Interval::ZERO),
            Coupling::Spring { stiffness } => {
                let stiffness = Interval::decimal(stiffness);
                (Some(stiffness), Interval::ONE.div(stiffness))
            }
            // The compliance for the torque of the same tick.
            Coupling::Matched => {
                let standard = standard(period, delta);
                (Some(Interval::ONE.div(standard)), standard)
            }
        };
        let compliance = rounded(written, format, Rounding::Outward);
        let mut out = Self {
            delta,
            missed,
            cancelled,
            coupling,
            compliance,
            is_matched: matches!(scene.coupling, Coupling::Matched),
            ..Self::timed(scene.timing, format)
        };
        if E::MAY_MISREAD && scene.latency.encoder.linearity != 0.0 {
            out.read_through_inl(scene);
        }
        if E::MEMORY.is_stored() && has_latency(scene) {
            if E::MEMORY.has_updates() {
                out.add_latency::<true>(scene, passivity);
            } else {
                out.add_latency::<false>(scene, passivity);
            }
        }
        out
    }

    #[inline(never)]
    const fn read_through_inl(&mut self, scene: &Scene) {
        self.linearity = Interval::decimal(scene.latency.encoder.linearity);
        let is_plain = scene.latency.is_none() && !self.misses_updates && !self.is_matched;
        if let Some(wall) = late_spring(&scene.environment)
            && is_plain
            && self.coupling.is_some()
            && let Some(left) = self.left_by_inl(wall)
        {
            (self.delta, self.linearity) = (left, Interval::ZERO);
        }
    }

    /// The passivity that a nonlinear encoder leaves of that of a device, for a late spring on one side or on
    /// both that is behind a coupling spring (equation 67); `None` if none is left, or no bound is known.
    const fn left_by_inl(&self, wall: &Wall) -> Option<Interval> {
        let spring = self.coefficient(Interval::decimal(wall.stiffness));
        let fed_back = spring.mul(self.compliance);
        let settles = Interval::ONE.sub(fed_back);
        if !settles.is_positive() {
            return None;
        }
        let slope = spring.div(Interval::ONE.add(fed_back));
        let memory = slope.mul(Interval::exact(wall.delay as f64)).div(settles);
        let factor = Interval::ONE.add(self.linearity);
        // A board may read a count late.
        let longest = self.period.add(Interval::exact(2.0 * READ_WITHIN));
        let taken = self.linearity.mul(factor).mul(longest).mul(slope.half().add(memory));
        let left = self.delta.sub(taken).div(factor.mul(factor));
        if left.is_positive() { Some(left) } else { None }
    }

    // Not inlined: scenes without latency do not need its frame.
    #[inline(never)]
    const fn add_latency<const UPDATES: bool>(&mut self, scene: &Scene, passivity: f64) {
        let Scene { latency, timing, .. } = *scene;
        let mut lagging = Lagging { latency, timing, matched: None, limit: None };
        // A latched torque is that of a count before the missed ones.
        let may_be_latched = self.missed.is_some() && latency.output_delay.least == 0.0;
        if self.is_matched && !may_be_latched {
            let Timing { period, worst_period } = timing;
            let format = self.format;
            lagging.matched = MatchedCoupling::of_kind::<UPDATES>(
                period,
                worst_period,
                passivity,
                &latency,
                format,
            );
            if let Some(matched) = &lagging.matched {
                lagging.limit = Some(matched.limit);
                self.compliance = Interval::exact(matched.compliance);
            }
        } else if self.coupling.is_some() && !self.is_matched && !self.misses_updates {
            lagging.limit = limit_behind_spring::<UPDATES>(
                timing.period,
                self.delta,
                self.compliance,
                &latency,
            );
        }
        self.latency = Some(lagging);
    }
}
