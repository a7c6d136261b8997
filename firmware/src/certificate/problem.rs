//! A scene that can be judged, and the answers of the two rules without their numbers.

use super::anticogging::passivity_for_anticogging;
use super::endless::{mean_torque, turns_by_inl};
use super::linearity::is_nonlinear;
use super::loop_intervals::LoopIntervals;
use super::model::{solved_bound, transfer};
use super::profile::{ExtremeSlopes, is_motor, is_motor_where_limited};
use super::rejection::Rejection;
use super::remedy::Remedies;
use super::rules::{Rule, RuleAnswer, compare, exact_limit, paper_limit};
use super::static_law::{IndexAtPort, index_at_port};
use super::validity::check;
use crate::encoder_reading::EncoderReading;
use crate::environment::{Environment, FULL_SCALE, Parts, Profile, Wall};
use crate::number::Format;
use crate::passivity::bernstein::Precision;
use crate::passivity::discrete::{RealPart, index_looked_at, reduced_index};
use crate::passivity::interval::Interval;
use crate::passivity::poles::{
    IndexError, Reduced, UndecidedReason, cancelled, hidden_mode, reduce_velocity,
};
use crate::passivity::transfer::{Transfer, Unbuildable};
use crate::scene::Scene;

/// Relative width of an index in a search: it moves the root by a tenth of the last of three digits.
const ROUGHLY: f64 = 1e-4;

/// A scene whose numbers are valid, whose device is passive, and whose coupling and environment have exactly
/// one solution in every tick.
///
/// It gives the same verdict as [`super::assess`] at a fraction of the cost: an index is only enclosed until
/// it is clear on which side of its limit it is. For searches and maps with thousands of scenes.
#[derive(Clone, Copy)]
pub struct PassivityProblem {
    pub(super) numbers: LoopIntervals,
    pub(super) environment: Transfer,
    /// The stated index, if there is no transfer function.
    stated: Option<Interval>,
    /// The reason if there is no transfer function.
    no_transfer: Option<UndecidedReason>,
    pub(super) rule: Rule,
    /// Bound on the index of a one-sided or limited scene.
    pub(super) bound: Option<Interval>,
    /// Whether a scene whose bound fails is rejected. At the port it is undecided, unless less passivity than
    /// the bound is known to be too little.
    is_necessary: bool,
    /// Whether the encoder's readings are other than those of an ideal encoder with the same times.
    pub(super) misreads: bool,
}

impl PassivityProblem {
    /// Poses a scene with unrounded coefficients.
    ///
    /// # Errors
    /// The reason why it cannot be judged: an invalid number, a device without passivity, an environment that
    /// is not causal, or a loop without one solution.
    pub const fn of(scene: &Scene) -> Result<Self, Rejection> {
        Self::in_format(scene, Format::F64)
    }

    /// The same with the coefficients rounded to a number format.
    ///
    /// # Errors
    /// As [`PassivityProblem::of`].
    pub const fn in_format(scene: &Scene, format: Format) -> Result<Self, Rejection> {
        match check(scene) {
            Err(invalid) => Err(Rejection::Invalid(invalid)),
            Ok(()) => {
                let mut posed = Self::unposed(scene, format);
                ok!(posed.pose(scene));
                Ok(posed)
            }
        }
    }

    /// The numbers of a scene that are valid, for [`PassivityProblem::pose`].
    #[inline(always)]
    pub(super) const fn unposed(scene: &Scene, format: Format) -> Self {
        Self {
            numbers: LoopIntervals::of(scene, format),
            environment: Transfer::ZERO,
            stated: None,
            no_transfer: None,
            rule: Rule::Exact,
            bound: None,
            is_necessary: true,
            misreads: false,
        }
    }

    /// Poses a scene with its numbers. In place, because a small board's stack has no room for a second
    /// problem.
    #[inline(never)]
    pub(super) const fn pose(&mut self, scene: &Scene) -> Result<(), Rejection> {
        let numbers = &self.numbers;
        if scene.environment.parts().anticogging.is_some() && !numbers.delta.is_positive() {
            let (needed, delta) =
                (passivity_for_anticogging(scene, numbers.format), scene.device.passivity());
            if delta > 0.0 {
                return Err(Rejection::Anticogging { needed, delta, remedies: Remedies::NONE });
            }
        }
        if !numbers.delta.is_positive() {
            return Err(Rejection::NoPassivity { delta: numbers.delta });
        }
        if let Some(profile) = scene.environment.profile()
            && let Some(rejection) = profile_rejection(profile, scene, numbers)
        {
            return Err(rejection);
        }
        if turns_by_inl::<Environment>(scene, numbers)
            && let Some(mean) = mean_torque::<Environment>(scene, numbers)
        {
            let EncoderReading { linearity, friction, .. } = *scene.latency.encoder;
            let anticogs = scene.environment.parts().anticogging.is_some();
            let remedies = Remedies::NONE;
            return Err(Rejection::MotorByInl { linearity, mean, friction, anticogs, remedies });
        }
        // Its bound in a sum with a profile does not detect this.
        if let Parts { wall: Some(Wall { stiffness, .. }), profile: Some(_), .. } =
            scene.environment.parts()
            && *stiffness < 0.0
        {
            let residue = Interval::decimal(*stiffness).mul(numbers.period);
            return Err(Rejection::NegativeResidue { residue });
        }
        if let Err(error) = transfer(&mut self.environment, &scene.environment, numbers) {
            return Err(unbuildable(error));
        }
        let environment = &self.environment;
        if scene.environment.rational().is_some()
            && let Some(cos_theta) = hidden_mode(environment)
        {
            return Err(Rejection::HiddenMode { cos_theta });
        }
        let loop_gain = Interval::ONE.add(environment.feedthrough().mul(numbers.compliance));
        let at_port = if numbers.is_at_port { index_at_port(scene, numbers, 0.0) } else { None };
        let (rule, bound, solvable) = if is_nonlinear(scene) {
            let bound = match at_port {
                Some(IndexAtPort { sufficient, .. }) => Some(sufficient),
                None if numbers.is_at_port || !numbers.linearity.is_zero() => None,
                None => solved_bound(&scene.environment, numbers),
            };
            // A clipped or one-sided law has one solution with the coupling only if both slopes
            // agree.
            (Rule::Nonlinear, bound, loop_gain.is_positive())
        } else {
            (Rule::Exact, None, !loop_gain.contains(0.0))
        };
        if !solvable {
            return Err(Rejection::IllPosed { loop_gain });
        }
        self.stated = if scene.environment.has_transfer() { None } else { bound };
        let is_behind_inl = !numbers.is_at_port && !numbers.linearity.is_zero();
        self.no_transfer = match &scene.environment {
            environment if is_behind_inl && !environment.has_transfer() => {
                Some(UndecidedReason::NoProofWithInl)
            }
            environment if environment.snaps() => Some(UndecidedReason::NoSnapBound),
            environment if environment.profile().is_some() => Some(UndecidedReason::NoBoundAtPort),
            environment if environment.has_transfer() => None,
            _ => Some(UndecidedReason::NoTransferFunction),
        };
        self.is_necessary = match at_port {
            Some(index) => index.is_necessary,
            None => !numbers.is_at_port && numbers.linearity.is_zero(),
        };
        self.misreads = !scene.latency.encoder.is_ideal();
        (self.rule, self.bound) = (rule, bound);
        Ok(())
    }

    /// The verdict: whether the deciding rule proves the scene, that is, whether the outcome of
    /// [`super::assess`] is `Ok`.
    pub const fn is_certified(&self) -> bool {
        match self.rule {
            Rule::Exact => self.passes_exact(),
            Rule::Nonlinear => self.passes_paper(),
        }
    }

    /// The answer of the deciding rule, as in [`super::assess`]: a scene that is not certified is either
    /// rejected or undecided.
    pub const fn answer(&self) -> RuleAnswer {
        match self.rule {
            // "Rejected" may need more precision than "not certified".
            Rule::Exact => {
                match self.exact(&self.coupled(None, &near(exact_limit(&self.numbers)))) {
                    RuleAnswer::Undecided => self.exact(&self.coupled(None, &Precision::TIGHT)),
                    clear => clear,
                }
            }
            Rule::Nonlinear => {
                // The index must exist, with any value.
                let alone = self.alone(&near(Interval::exact(f64::MAX)));
                match (&alone, self.bound, self.paper(&alone)) {
                    (Ok(_), None, _) => RuleAnswer::Undecided,
                    (Ok(_), _, RuleAnswer::Undecided) if self.fails_in_contact().is_some() => {
                        RuleAnswer::Fail
                    }
                    (_, _, answer) => answer,
                }
            }
        }
    }

    /// [`Self::answer`] of a scene with latency, by another method for its index at the port.
    pub(super) fn answer_by(
        &self,
        index: impl Fn(&Precision) -> Result<RealPart, IndexError>,
    ) -> RuleAnswer {
        if matches!(self.rule, Rule::Nonlinear) || self.no_transfer.is_some() {
            return self.answer();
        }
        match self.exact(&index(&near(exact_limit(&self.numbers)))) {
            RuleAnswer::Undecided => self.exact(&index(&Precision::TIGHT)),
            clear => clear,
        }
    }

    /// Bound on the index of a one-sided or limited scene, in N m s/rad; `None` for linear scenes, or if none
    /// is known.
    pub const fn bound(&self) -> Option<Interval> {
        self.bound
    }

    /// Upper bound on the deciding index, in N m s/rad; `None` if no index passes the rule.
    pub const fn limit(&self) -> Option<Interval> {
        match self.rule {
            Rule::Exact => Some(exact_limit(&self.numbers)),
            Rule::Nonlinear => self.paper_limit(),
        }
    }

    /// Upper bound on the index of the environment alone for equations 17 to 19, in N m s/rad; `None` if no
    /// index passes: without compliance, and above the standard coupling.
    pub const fn paper_limit(&self) -> Option<Interval> {
        paper_limit(&self.numbers)
    }

    /// Whether equations 17 to 19 prove the scene.
    pub const fn passes_paper(&self) -> bool {
        let Some(limit) = paper_limit(&self.numbers) else { return false };
        let index = match (self.rule, self.bound) {
            (Rule::Exact, _) => self.alone(&near(limit)),
            // The bound decides; the index must exist, with any value.
            (Rule::Nonlinear, Some(bound)) if matches!(compare(bound, limit), RuleAnswer::Pass) => {
                self.alone(&near(Interval::exact(f64::MAX)))
            }
            (Rule::Nonlinear, _) => return false,
        };
        matches!(self.paper(&index), RuleAnswer::Pass)
    }

    /// Whether the rule of theory, section 4.1, proves the scene without one-sidedness and torque limit.
    pub const fn passes_exact(&self) -> bool {
        let index = self.coupled(None, &near(exact_limit(&self.numbers)));
        matches!(self.exact(&index), RuleAnswer::Pass)
    }

    /// Answer of equations 17 to 19, given the index of the environment alone.
    pub(super) const fn paper(&self, alone: &Result<RealPart, IndexError>) -> RuleAnswer {
        let Some(limit) = paper_limit(&self.numbers) else { return RuleAnswer::Fail };
        match (alone, self.rule, self.bound) {
            (Err(IndexError::Undecided(_)), ..) => RuleAnswer::Undecided,
            (Err(_), ..) => RuleAnswer::Fail,
            (Ok(found), Rule::Exact, _) => compare(found.minimum, limit),
            (Ok(_), Rule::Nonlinear, Some(bound)) => match compare(bound, limit) {
                RuleAnswer::Fail if !self.is_necessary => RuleAnswer::Undecided,
                answer => answer,
            },
            (Ok(_), Rule::Nonlinear, None) => RuleAnswer::Undecided,
        }
    }

    /// Answer of theory, section 4.1, given the index of `E'`.
    pub(super) const fn exact(&self, coupled: &Result<RealPart, IndexError>) -> RuleAnswer {
        match coupled {
            Ok(found) => compare(found.minimum, exact_limit(&self.numbers)),
            Err(IndexError::Undecided(_)) => RuleAnswer::Undecided,
            Err(_) => RuleAnswer::Fail,
        }
    }

    /// The index of a scene at the port that is not proved, if small motions in contact and below the torque
    /// limit show that it is not passive: they are those of the linear scene (theory, section 16.4).
    #[inline(never)]
    pub(super) const fn fails_in_contact(&self) -> Option<RealPart> {
        let is_constant = match &self.numbers.latency {
            Some(lagging) => lagging.latency.total_jitter() == 0.0,
            None => true,
        };
        if !self.numbers.is_at_port || self.misreads || self.no_transfer.is_some() || !is_constant {
            return None;
        }
        match self.at_port(&Precision::TIGHT) {
            Ok(found) if found.minimum.lo() >= self.numbers.delta.hi() => Some(found),
            _ => None,
        }
    }

    /// An estimate of the missing damping, relative to `delta`: negative if
    /// [`PassivityProblem::is_certified`], but imprecise near zero. `None` if there is no index. Searches
    /// find its root.
    pub(super) const fn shortage(&self) -> Option<f64> {
        let shortage = match self.rule {
            Rule::Exact => self.exact_shortage(),
            Rule::Nonlinear => self.nonlinear_shortage(),
        };
        Some(some!(shortage).midpoint() / self.numbers.delta.midpoint())
    }

    const fn exact_shortage(&self) -> Option<Interval> {
        let Ok(found) = self.coupled(None, &Precision::within(ROUGHLY)) else { return None };
        Some(found.minimum.sub(exact_limit(&self.numbers)))
    }

    const fn nonlinear_shortage(&self) -> Option<Interval> {
        let (bound, delta) = (some!(self.bound), self.numbers.delta);
        if self.numbers.is_at_port {
            return Some(bound.sub(delta));
        }
        let coupling = some!(self.numbers.coupling_damping());
        let over_the_limit = match paper_limit(&self.numbers) {
            Some(limit) => bound.sub(limit),
            None if self.numbers.latency.is_some() => delta.max(bound),
            None => bound.sub(delta.min(coupling)),
        };
        if self.numbers.latency.is_some() {
            return Some(over_the_limit);
        }
        // With a coupling stiffer than the standard one, its excess over `delta` is missing.
        Some(if delta.is_below(coupling) {
            over_the_limit.max(coupling.sub(delta))
        } else {
            over_the_limit
        })
    }

    /// An estimate of the passivity that this law needs, scaled to the worst period; `None` if no passivity
    /// suffices.
    ///
    /// By the exact rule this is [`PassivityProblem::at_port`]. A one-sided or limited scene needs the
    /// damping equivalent to its coupling, if its own bound is less.
    pub(super) const fn needed_passivity(&self) -> Option<f64> {
        match self.rule {
            Rule::Exact => match self.at_port(&Precision::within(ROUGHLY)) {
                Ok(found) => Some(found.minimum.midpoint()),
                Err(_) => None,
            },
            Rule::Nonlinear if self.numbers.is_at_port => Some(some!(self.bound).hi()),
            Rule::Nonlinear => match (self.bound, self.numbers.coupling_damping()) {
                (Some(bound), Some(coupling)) if bound.is_below(coupling) => Some(coupling.hi()),
                _ => None,
            },
        }
    }

    /// Index at the device's port, independent of `delta`: that of the whole controller, a sample late. The
    /// loop is passive while `delta + Re(T C / (z - 1)) > 0` (equation 30).
    pub(super) const fn at_port(&self, closeness: &Precision) -> Result<RealPart, IndexError> {
        if !self.numbers.linearity.is_zero() {
            let (_, needed) = ok!(self.through_inl(closeness, true));
            return Ok(RealPart::everywhere(needed));
        }
        if self.numbers.latency.is_some() {
            return Ok(RealPart::everywhere(ok!(self.port_needed())));
        }
        self.without_delay(closeness)
    }

    /// The same for torques at the instants of their counts, through a linear encoder.
    pub(super) const fn without_delay(
        &self,
        closeness: &Precision,
    ) -> Result<RealPart, IndexError> {
        reduced_index(&self.behind_reduced(self.numbers.compliance, true), closeness)
    }

    /// Whether the coupling is the standard one within the precision of its digits, so that `E'` is the
    /// environment itself. With a rounded compliance the coupling is a little softer, and [`exact_limit`] is
    /// then the limit of the paper's rule (theory, section 6).
    pub(super) const fn is_standard(&self) -> bool {
        self.numbers.is_standard
    }

    pub(super) const fn alone(&self, closeness: &Precision) -> Result<RealPart, IndexError> {
        if let Some(minimum) = self.stated {
            return Ok(RealPart::everywhere(minimum));
        }
        if let Some(doubt) = self.no_transfer {
            return Err(IndexError::Undecided(doubt));
        }
        index_looked_at(&self.environment, self.numbers.period, true, closeness)
    }

    /// Index of `E'`; a known index of the environment alone is not computed again.
    ///
    /// The larger of the index for torques at the instant of their counts, and of the index for latched
    /// torques, if updates may be missed: there the coupling's excess is over the standard coupling of the
    /// declared passivity, and the limit is the same (see [`super::loop_intervals::Missed::limit`] with
    /// `nu = 1`).
    pub(super) const fn coupled(
        &self,
        alone: Option<Result<RealPart, IndexError>>,
        closeness: &Precision,
    ) -> Result<RealPart, IndexError> {
        if let Some(doubt) = self.no_transfer {
            return Err(IndexError::Undecided(doubt));
        }
        if !self.numbers.linearity.is_zero() {
            let (found, _) = ok!(self.through_inl(closeness, false));
            return Ok(found);
        }
        if self.numbers.latency.is_some() {
            return self.port_index(closeness);
        }
        let at_once = match alone {
            Some(alone) if self.is_standard() => alone,
            None if self.is_standard() => self.alone(closeness),
            _ => self.behind(self.numbers.excess_compliance(), closeness),
        };
        let Some(excess) = self.numbers.excess_where_latched() else { return at_once };
        let at_once = ok!(at_once);
        Ok(ok!(self.behind(excess, closeness)).or_larger(at_once))
    }

    /// Index of `E'`: only tight enough to prove it below its limit; if it is not, tight for the rejection.
    pub(super) const fn coupled_unless_clear(&self) -> Result<RealPart, IndexError> {
        let roughly = self.coupled(None, &near(exact_limit(&self.numbers)));
        match self.exact(&roughly) {
            RuleAnswer::Pass => roughly,
            RuleAnswer::Fail | RuleAnswer::Undecided => self.coupled(None, &Precision::TIGHT),
        }
    }

    /// Whether there is no transfer function, and at most a bound.
    pub(super) const fn has_no_transfer(&self) -> bool {
        self.no_transfer.is_some()
    }

    /// Index of `E'` for a coupling with this much compliance over the standard one.
    #[inline(never)]
    pub(super) const fn behind(
        &self,
        excess: Interval,
        closeness: &Precision,
    ) -> Result<RealPart, IndexError> {
        reduced_index(&self.behind_reduced(excess, false), closeness)
    }

    /// The velocity-to-torque function of the environment behind a coupling of this compliance, with or
    /// without an additional sample of delay. Not inlined: a small board's stack has no room for its frame
    /// during the search for the minimum.
    #[inline(never)]
    const fn behind_reduced(
        &self,
        compliance: Interval,
        a_sample_late: bool,
    ) -> Result<Reduced, IndexError> {
        if let Some(doubt) = self.no_transfer {
            return Err(IndexError::Undecided(doubt));
        }
        let mut controller = self.controller(compliance);
        let Ok(controller) = &mut controller else {
            return Err(IndexError::Undecided(UndecidedReason::OutOfRange));
        };
        controller.shift -= a_sample_late as i32;
        reduce_velocity(controller, self.numbers.period, false)
    }

    /// The environment behind a coupling of this compliance, without their common factors.
    #[inline(never)]
    const fn controller(&self, compliance: Interval) -> Result<Transfer, Unbuildable> {
        cancelled(&self.environment).behind(compliance)
    }
}

/// The obstacle of a torque profile for any device.
const fn profile_rejection(
    profile: &Profile,
    scene: &Scene,
    n: &LoopIntervals,
) -> Option<Rejection> {
    let outline = profile.outline();
    if is_motor(profile) {
        let units = outline.sum as f64 / (outline.knots as f64 * FULL_SCALE as f64);
        return Some(Rejection::Motor { mean: units * profile.torque });
    }
    if scene.torque_limit.is_some() && is_motor_where_limited::<Environment>(profile) {
        return Some(Rejection::Uneven);
    }
    if profile.delay > 0 || ExtremeSlopes::of::<Environment>(profile, n).is_some() {
        return None;
    }
    let coupling = Interval::ONE.div(n.compliance);
    Some(Rejection::Steep { coupling, remedies: Remedies::NONE })
}

/// The precision that decides on which side of `limit` an index is.
const fn near(limit: Interval) -> Precision {
    Precision::around(limit.neg())
}

const fn unbuildable(error: Unbuildable) -> Rejection {
    match error {
        Unbuildable::Improper => Rejection::Improper,
        Unbuildable::IllPosed => Rejection::IllPosed { loop_gain: Interval::ZERO },
        Unbuildable::OutOfRange | Unbuildable::Unstated => {
            Rejection::undecided(UndecidedReason::OutOfRange, None, None)
        }
    }
}
