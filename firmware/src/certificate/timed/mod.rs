//! Turns a [`Certified`] scene into a [`TimingChecked`] one: the delays of scene and board are equal, and the
//! scene also certifies with the board's limits on its torque.

use core::marker::PhantomData;

#[cfg(doc)]
use super::Certified;
use super::assessment::Assessment;
use super::endless::turns_by_inl;
use super::loop_intervals::{LoopIntervals, Missed, has_latency};
use super::margin::Limited;
use super::model::{largest_solved, nonlinear_bound, solved_bound};
use super::profile::is_motor_where_limited;
use super::rules::paper_limit;
use super::static_law::{End, needed_at_port};
use super::validity::check_numbers;
use crate::coupling::Coupling;
use crate::environment::{Environment, EnvironmentModel};
use crate::latency::TimeRange;
use crate::number::Format;
use crate::output_timing::{OutputMode, OutputTiming, READ_WITHIN, SHORTEST_PHASE, longest_phase};
use crate::passivity::interval::Interval;
use crate::scene::Scene;
use crate::step::Step;
use crate::text::{Piece, Sentence, push, sentences};

/// A certified scene that agrees with the output mode `M` of a board.
///
/// Only [`Certified::time`](Certified) makes one, and a servo loop is only built from one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TimingChecked<S, M> {
    scene: S,
    format: Format,
    limited: Limited,
    mode: PhantomData<M>,
}

impl<S, M> TimingChecked<S, M> {
    pub(super) const fn new(scene: S, format: Format, limited: Limited) -> Self {
        Self { scene, format, limited, mode: PhantomData }
    }

    /// Damping in N m s/rad that may be switched arbitrarily, one sample late, in addition to the
    /// environment: with any less the certificate holds.
    ///
    /// An arbitrarily switched damper `B` adds at most `B` to the index (theory, section 5, the nonlinear
    /// bound), and index and damper together must satisfy conditions 17 and 18, which do not require
    /// linearity.
    pub const fn injectable_damping(&self) -> f64 {
        self.limited.injectable_damping()
    }

    /// Damping in N m s/rad that the device may lose while everything else runs unchanged on a board, which
    /// limits the torque; [`Assessment::margin`] of a linear scene ignores the limit. `None` where none is
    /// known, behind a coupling where torques lag.
    pub const fn margin(&self) -> Option<f64> {
        self.limited.margin(0.0)
    }

    /// The same while a damper of `injected` N m s/rad is switched on and off: below
    /// [`TimingChecked::injectable_damping`].
    pub const fn margin_with(&self, injected: f64) -> Option<f64> {
        self.limited.margin(injected)
    }

    /// The scene.
    pub const fn scene(&self) -> &S {
        &self.scene
    }

    /// The number format whose coefficients are certified.
    pub const fn format(&self) -> Format {
        self.format
    }
}

sentences! {
    /// The reason why a board cannot render a certified scene.
    TimingError: Sentence {
    /// The torque takes a sample to reach the motor.
    NotLate => (
        "the environment is not late by a whole sample, but on this board a torque takes one: give all of \
         it a delay of at least 1"),
    /// The bound on the index with a torque limit, which every board has; `None` if none is known. Its upper bound is
    /// unknown behind a rigid coupling, or one stiffer than the standard coupling.
    Limited { bound: Option<f64>, limit: Option<f64> } => (
        "the scene passes only as long as its torque is never limited, and a board limits it while it \
         fades in and out and at the DAC's full scale" {WhereLimited { bound, limit }}),
    /// The middle of the scene's range.
    Phase { scene: f64, board: f64 } => (
        "the scene has an output delay of " {scene} " s, and this board puts its torques out " {board}
        " s after the beginning of a period"),
    DelayRange { least: f64, most: f64 } => (
        "a board puts its torques out at one time in the period, and the scene's output delay is between "
        {least} " s and " {most} " s: give it the period of the board"),
    PhaseRange { phase: f64, shortest: f64, longest: f64 } => (
        "this board would put its torques out " {phase}
        " s after the beginning of a period, but a code takes time to compute and has to be out before the \
         next one is there: the phase must be between " {shortest} " s and " {longest} " s"),
    Unmatched => (
        "where torques lag, a servo renders only environments behind the matched coupling: give the scene that"),
    Nonlinear => (
        "no proof is known for a limited torque behind this coupling and a nonlinear encoder: leave the \
         coupling out, or correct the angle"),
    Coupled => (
        "the scene has no coupling, and its program is that of a coupled scene: give the scene a coupling"),
    Jitter { jitter: f64 } => (
        "a board reads a count up to " {READ_WITHIN}
        " s after the beginning of its period, which is jitter where torques lag: the scene's count jitter, \
         or the output jitter if it states no other, has to be that at least, and is " {jitter} " s"),
    ReadLate { period: f64, bound: f64, limit: f64 } => (
        "a board reads a count up to " {READ_WITHIN} " s after the beginning of its period of " {period}
        " s, and needs alpha = " {bound} " N m s/rad below " {limit}
        " N m s/rad for that: make the environment a little softer"),
    }
}

/// The numbers of [`TimingError::Limited`], as the end of its sentence.
struct WhereLimited {
    bound: Option<f64>,
    limit: Option<f64>,
}

impl Piece<WhereLimited> {
    const fn push_to(self, t: &mut Sentence) {
        match (self.0.bound, self.0.limit) {
            (None, _) => t.push(
                "; no bound is known then for a rational environment, or without a coupling for torques and \
                 counts that both jitter beside a lag",
            ),
            (_, None) => t.push(
                "; behind a coupling stiffer than the standard one, 2 delta/T, or a rigid one, it is not \
                 known to be passive then: soften the coupling",
            ),
            (Some(bound), Some(limit)) => push!(*t,
                ": then the environment needs up to " {bound} " N m s/rad of damping, not below the " {limit}
                " N m s/rad that device and coupling allow; a softer environment, or a coupling nearer to \
                 the standard one, passes"),
        }
    }
}

impl Assessment {
    /// [`TimingChecked::margin`] of the assessed and certified scene; `None` also if its numbers do not allow
    /// a board to render it.
    pub const fn margin_on_board(&self, scene: &Scene) -> Option<f64> {
        self.margin_injecting(scene, 0.0)
    }

    /// [`TimingChecked::margin_with`] of that scene.
    pub const fn margin_injecting(&self, scene: &Scene, injected: f64) -> Option<f64> {
        let Ok(limited) = agree(OutputTiming::Simultaneous, scene, self.format) else {
            return None;
        };
        limited.margin(injected)
    }

    /// Checks that a board with the output mode `M` can render the assessed and certified scene, by its
    /// numbers: the result of [`Certified::time`](Certified).
    ///
    /// # Errors
    /// The reason why it cannot.
    pub const fn renders_in<M: OutputMode>(&self, scene: &Scene) -> Result<(), TimingError> {
        self.renders_at(scene, M::TIMING)
    }

    /// The same for a mode as data.
    ///
    /// # Errors
    /// The reason why it cannot.
    pub const fn renders_at(&self, scene: &Scene, timing: OutputTiming) -> Result<(), TimingError> {
        ok!(agree(timing, scene, self.format));
        Ok(())
    }
}

/// The scene with its torque limited, if a board may render it.
///
/// A board limits every torque, so the nonlinear bound must pass the paper's rule, independently of the rule
/// of the scene's verdict. This is a complete proof: the bound is a bound on the index (equation 31), and
/// every environment with a known bound has an index, because no wall pulls away and all filters decay. The
/// loop is also solvable in each tick: a feedthrough that prevented this would exceed the bound. So a board
/// needs no search, and no code for the polynomials with which a host computes the index.
///
/// If the type of an environment does not cancel damping, the program omits the code for cancelled damping,
/// and rejects a scene that cancels some. Not inlined, so that its frame is not on a small board's stack when
/// the servo is built.
#[inline(never)]
pub(super) const fn judged<E: EnvironmentModel, M: OutputMode>(
    scene: &Scene,
    is_late: bool,
    format: Format,
) -> Result<Limited, Step> {
    let is_covered = E::MAY_MISREAD || scene.latency.encoder.is_ideal();
    if is_covered
        && check_numbers::<E>(scene).is_ok()
        && let Some(limited) = limited::<E>(M::TIMING, scene, is_late, format)
    {
        return Ok(limited);
    }
    Err(Step::Certificate)
}

/// The same of a scene whose numbers are valid, for a mode as data.
#[inline(always)]
const fn limited<E: EnvironmentModel>(
    timing: OutputTiming,
    scene: &Scene,
    is_late: bool,
    format: Format,
) -> Option<Limited> {
    let is_in_time = is_late || !matches!(timing, OutputTiming::Latched);
    if !is_in_time || !timing.fits(scene.timing.period) || !is_at_its_phase(timing, scene) {
        return None;
    }
    if E::PROFILE.exists && is_uneven::<E>(&scene.environment) {
        return None;
    }
    let repeats = E::PROFILE.exists && E::MAY_MISREAD || E::PARTS.anticogging;
    if repeats && is_turned_by_inl::<E>(scene, is_late, format) {
        return None;
    }
    if E::MEMORY.may_be_uncoupled() && matches!(scene.coupling, Coupling::Rigid) {
        return limited_at_port::<E>(timing, scene, is_late, format);
    }
    let is_matched = matches!(scene.coupling, Coupling::Matched);
    if has_latency(scene) && !(is_matched && E::MEMORY.is_stored()) {
        return None;
    }
    let n = &LoopIntervals::of_late::<E>(scene, is_late, format);
    let solved = match timing {
        // All of it is late.
        OutputTiming::Latched => Interval::ONE,
        OutputTiming::Simultaneous | OutputTiming::AtPhase(_) => {
            some!(largest_solved::<E>(&scene.environment, n))
        }
    };
    let bound = some!(nonlinear_bound::<E>(&scene.environment, solved, n));
    let limited = some!(Limited::of_solved::<E>(scene, n, bound, solved));
    if stands_counts_read_late(timing, &limited, scene, n) { Some(limited) } else { None }
}

#[inline(never)]
const fn is_turned_by_inl<E: EnvironmentModel>(
    scene: &Scene,
    is_late: bool,
    format: Format,
) -> bool {
    turns_by_inl::<E>(scene, &LoopIntervals::of_late::<E>(scene, is_late, format))
}

/// The same of a scene without a coupling (theory, section 16).
#[inline(never)]
const fn limited_at_port<E: EnvironmentModel>(
    timing: OutputTiming,
    scene: &Scene,
    is_late: bool,
    format: Format,
) -> Option<Limited> {
    let reading = reading_time(timing);
    if scene.timing.period <= reading {
        return None;
    }
    let n = &LoopIntervals::of_late::<E>(scene, is_late, format);
    Limited::at_port::<E>(scene, n, reading)
}

/// The scene with its torque limited, if a certified scene agrees with a mode, or the reason why it does not.
pub(super) const fn agree(
    timing: OutputTiming,
    scene: &Scene,
    format: Format,
) -> Result<Limited, TimingError> {
    let is_late = scene.environment.is_late();
    match limited::<Environment>(timing, scene, is_late, format) {
        Some(limited) => Ok(limited),
        None => Err(disagreement(timing, scene, format)),
    }
}

/// The reason why a certified scene does not agree with a mode.
const fn disagreement(timing: OutputTiming, scene: &Scene, format: Format) -> TimingError {
    if matches!(timing, OutputTiming::Latched) && !scene.environment.is_late() {
        return TimingError::NotLate;
    }
    if let (Some(phase), false) = (timing.phase(), timing.fits(scene.timing.period)) {
        let longest = longest_phase(scene.timing.period);
        return TimingError::PhaseRange { phase, shortest: SHORTEST_PHASE, longest };
    }
    if !is_at_its_phase(timing, scene) {
        let board = board_delay(timing, scene);
        let TimeRange { least, most } = scene.latency.output_delay;
        return if least == most {
            TimingError::Phase { scene: scene.latency.stated_delay(), board }
        } else {
            TimingError::DelayRange { least, most }
        };
    }
    let n = &LoopIntervals::of(scene, format);
    if scene.latency.encoder.linearity != 0.0 && !matches!(scene.coupling, Coupling::Rigid) {
        return TimingError::Nonlinear;
    }
    if matches!(scene.coupling, Coupling::Rigid) {
        let needed = needed_at_port::<Environment>(scene, n, reading_time(timing), End::Upper);
        return TimingError::Limited { bound: needed, limit: Some(n.delta.lo()) };
    }
    if has_latency(scene) && !matches!(scene.coupling, Coupling::Matched) {
        return TimingError::Unmatched;
    }
    let is_on_a_board = !matches!(timing, OutputTiming::Simultaneous);
    if is_on_a_board && !scene.latency.is_none() && !has_enough_jitter(scene) {
        return TimingError::Jitter { jitter: scene.latency.deviation_of_counts() };
    }
    let bound = limited_bound(scene, n);
    if let Some(bound) = bound
        && let Some(limited) = Limited::of(scene, n, bound)
    {
        return TimingError::ReadLate {
            period: scene.timing.period,
            bound: bound.hi(),
            limit: read_late(&limited, n).lo(),
        };
    }
    TimingError::Limited {
        bound: match bound {
            Some(bound) => Some(bound.hi()),
            None => None,
        },
        limit: match paper_limit(n) {
            Some(limit) => Some(limit.lo()),
            None => None,
        },
    }
}

/// The time in s by which a count may be read late. Without a coupling a torque depends on it by its damper
/// alone, because a position is no older for it.
const fn reading_time(timing: OutputTiming) -> f64 {
    match timing {
        OutputTiming::Simultaneous => 0.0,
        OutputTiming::Latched | OutputTiming::AtPhase(_) => READ_WITHIN,
    }
}

/// Whether the board's torques come at the scene's time, to a part in a billion, far below the required
/// jitter. A simulation always uses the scene's time.
const fn is_at_its_phase(timing: OutputTiming, scene: &Scene) -> bool {
    let delay = scene.latency.output_delay;
    let age = &scene.latency.encoder.age;
    let board = match age.is_zero() {
        true => board_delay(timing, scene),
        false => board_delay(timing, scene) + age.middle(),
    };
    match timing {
        OutputTiming::Simultaneous => true,
        OutputTiming::Latched | OutputTiming::AtPhase(_) => {
            delay.is_exact() && (delay.least - board).abs() <= 1e-9 * board
        }
    }
}

/// Time in s from a count to its torque, in addition to an environment's whole samples: until the code is put
/// out, and one more update with a current loop.
const fn board_delay(timing: OutputTiming, scene: &Scene) -> f64 {
    let phase = or!(timing.phase(), 0.0);
    match scene.latency.actuator_updates {
        0 => phase,
        updates => phase + scene.timing.period / updates as f64,
    }
}

/// Whether a scene certifies with counts that are read up to [`READ_WITHIN`] after the beginning of a period,
/// as with latched torques.
const fn stands_counts_read_late(
    timing: OutputTiming,
    limited: &Limited,
    scene: &Scene,
    n: &LoopIntervals,
) -> bool {
    if !matches!(timing, OutputTiming::Simultaneous) && n.latency.is_some() {
        return has_enough_jitter(scene);
    }
    match timing {
        // Only behind the coupling that is designed for it.
        OutputTiming::AtPhase(_) => false,
        OutputTiming::Latched => {
            scene.timing.period > READ_WITHIN && limited.bound.is_below(read_late(limited, n))
        }
        OutputTiming::Simultaneous => true,
    }
}

/// Whether a scene with a latency includes the time in which a board reads a count. With an updated current
/// loop, its timer captures the count exactly at the update that begins the period.
const fn has_enough_jitter(scene: &Scene) -> bool {
    /// The age of a reading is added to the stated jitter, and taken out again, each with a rounding.
    const ROUNDED: f64 = READ_WITHIN * (1.0 - 1e-9);
    scene.latency.actuator_updates > 0 || scene.latency.deviation_of_counts() >= ROUNDED
}

/// Upper limit of the bound for counts read late.
const fn read_late(limited: &Limited, n: &LoopIntervals) -> Interval {
    let late = Interval::exact(READ_WITHIN).div(n.period);
    Missed::read_late(n, late).limit(limited.coupling)
}

/// Whether a torque limit may make it a motor.
pub(super) const fn is_uneven<E: EnvironmentModel>(environment: &Environment) -> bool {
    match environment.profile() {
        Some(profile) => is_motor_where_limited::<E>(profile),
        None => false,
    }
}

/// The bound on the index of a certified scene whose torque is limited.
///
/// It also holds for a changing limit: a monotone law clipped at any level is monotone and no steeper, and a
/// clipped damper or canceller is a fraction of it that may change from tick to tick (theory, section 5). A
/// falling level removes energy; a rising level adds, once, the energy that the environment stores at its
/// depth.
pub(super) const fn limited_bound(scene: &Scene, n: &LoopIntervals) -> Option<Interval> {
    if is_uneven::<Environment>(&scene.environment) {
        return None;
    }
    solved_bound(&scene.environment, n)
}

#[cfg(test)]
mod tests;
