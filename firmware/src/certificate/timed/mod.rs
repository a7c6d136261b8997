//! From a [`Certified`] scene to a [`TimingChecked`] one: the scene's delay and the board's are the same, and
//! the scene stands the limits that a board puts on its torque.

use core::fmt;
use core::marker::PhantomData;

#[cfg(doc)]
use super::Certified;
use super::assessment::Assessment;
use super::loop_intervals::{LoopIntervals, Missed, has_latency};
use super::margin::Limited;
use super::model::{largest_solved, nonlinear_bound};
use super::profile::is_motor_where_limited;
use super::rules::{Rule, paper_limit};
use super::validity::first_invalid_number;
use crate::coupling::Coupling;
use crate::environment::{Environment, EnvironmentModel, Memory};
use crate::latency::TimeRange;
use crate::number::Format;
use crate::output_timing::{OutputMode, OutputTiming, READ_WITHIN, SHORTEST_PHASE, longest_phase};
use crate::passivity::interval::Interval;
use crate::scene::Scene;
use crate::step::Step;
use crate::text::Sentence;

/// A certified scene that agrees with the mode `M` in which a board puts its torques out.
///
/// There is no way to make one but [`Certified::time`](Certified), and a cycle is built from
/// nothing else.
///
/// ```
/// use haptic_servo::certificate::{Certified, TimingChecked};
/// use haptic_servo::environment::DelayedSpring;
/// use haptic_servo::scene::{Coupling, Device, Latency, Scene, Timing};
/// use haptic_servo::servo::Latched;
///
/// type SpringScene = Scene<DelayedSpring<1>>;
/// const SPRING: SpringScene = Scene {
///     device: Device { inertia: 2.2e-5, damping: 0.022, passivity: None },
///     timing: Timing { period: 0.001, worst_period: None },
///     coupling: Coupling::Spring { stiffness: 44.0 },
///     environment: DelayedSpring { stiffness: 22.0 },
///     latency: Latency::NONE, torque_limit: None,
/// };
/// const CERTIFIED: Certified<SpringScene> = SPRING.certified();
/// // Late by one sample, which is what the latch takes: this compiles.
/// const TIMED: TimingChecked<SpringScene, Latched> = CERTIFIED.timing_checked::<Latched>();
/// # let _ = TIMED;
/// ```
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

    /// Damping in N m s/rad that may be switched on and off at will, one sample late, beside the
    /// environment: any less keeps the certificate.
    ///
    /// An arbitrarily switched damper `B` adds at most `B` to the index (theory, section 5, the
    /// nonlinear bound), and index and damper together have to meet conditions 17 and 18, the rule
    /// that does not ask for linearity.
    pub const fn injectable_damping(&self) -> f64 {
        self.limited.injectable_damping()
    }

    /// Damping in N m s/rad that the device may lose with everything else as it runs on a board, where
    /// the torque is limited; see [`Assessment::margin`], which for a linear scene leaves that out.
    pub const fn margin(&self) -> f64 {
        self.limited.margin(0.0)
    }

    /// The same while so much damping (N m s/rad) is switched on and off: below [`TimingChecked::injectable_damping`].
    pub const fn margin_with(&self, injected: f64) -> f64 {
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

/// Why a certified scene cannot be rendered by a board.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum TimingError {
    /// The torque takes a sample to the motor, and the environment allows none.
    NotLate,
    /// The scene is linear and would not pass with a torque limit, which every board has: the DAC range,
    /// and a lower limit while the torque is faded in and out.
    Limited {
        /// Bound on the index with a torque limit in N m s/rad; `None` where none is known.
        bound: Option<f64>,
        /// Its upper bound; `None`: unknown behind a coupling that is stiffer than the standard one, or
        /// rigid.
        limit: Option<f64>,
    },
    /// The board puts torques out at another time than the scene says.
    Phase {
        /// The scene's output delay in s; the middle of its range.
        scene: f64,
        /// That of the board in s.
        board: f64,
    },
    /// The scene's output delay is known in part only, and a board puts torques out at one time.
    DelayRange {
        /// The shortest delay in s.
        least: f64,
        /// The longest in s.
        most: f64,
    },
    /// No board puts torques out so soon after the beginning of a period, or so late.
    PhaseRange {
        /// The mode's time from there in s.
        phase: f64,
        /// The shortest in s.
        shortest: f64,
        /// The longest in s, of the scene's period.
        longest: f64,
    },
    /// The torque lags, and the coupling does not absorb that.
    Unmatched,
    /// A board reads counts later than the scene allows for.
    Jitter {
        /// The scene's output jitter in s.
        jitter: f64,
    },
    /// The scene would pass if each count were read at the very beginning of its period.
    ReadLate {
        /// Its period in s.
        period: f64,
        /// Bound on the index in N m s/rad.
        bound: f64,
        /// Its upper bound.
        limit: f64,
    },
}

impl TimingError {
    /// The error as a sentence, the same at compile time, on the host and on the board.
    pub const fn sentence(&self) -> Sentence {
        let mut t = Sentence::new();
        match self {
            Self::ReadLate { period, bound, limit } => {
                t.push("a board reads a count up to ");
                t.push_number(READ_WITHIN);
                t.push(" s after the beginning of its period of ");
                t.push_number(*period);
                t.push(" s, and needs alpha = ");
                t.push_number(*bound);
                t.push(" N m s/rad below ");
                t.push_number(*limit);
                t.push(" N m s/rad for that: make the environment a little softer");
            }
            Self::Phase { scene, board } => {
                t.push("the scene has an output delay of ");
                t.push_number(*scene);
                t.push(" s, and this board puts its torques out ");
                t.push_number(*board);
                t.push(" s after the beginning of a period");
            }
            Self::DelayRange { least, most } => {
                t.push("a board puts its torques out at one time in the period, and the scene's output \
                        delay is between ");
                t.push_number(*least);
                t.push(" s and ");
                t.push_number(*most);
                t.push(" s: give it the period of the board");
            }
            Self::PhaseRange { phase, shortest, longest } => {
                t.push("this board would put its torques out ");
                t.push_number(*phase);
                t.push(
                    " s after the beginning of a period, but a code takes time to compute and has to be \
                     out before the next one is there: the phase must be between ",
                );
                t.push_number(*shortest);
                t.push(" s and ");
                t.push_number(*longest);
                t.push(" s");
            }
            Self::Unmatched => t.push(
                "where torques lag, a servo renders only environments behind the matched coupling: give the \
                 scene that, and its environment's type `Matched`",
            ),
            Self::Jitter { jitter } => {
                t.push("a board reads a count up to ");
                t.push_number(READ_WITHIN);
                t.push(
                    " s after the beginning of its period, which is jitter where torques lag: the ",
                );
                t.push("scene's output jitter has to be that at least, and is ");
                t.push_number(*jitter);
                t.push(" s");
            }
            Self::NotLate => t.push(
                "the environment is not late by a whole sample, but on this board a torque takes \
                 one: give all of it a delay of at least 1",
            ),
            Self::Limited { bound, limit } => {
                t.push(
                    "the scene passes only as long as its torque is never limited, and a board \
                     limits it while it fades in and out and at the DAC's full scale",
                );
                match (bound, limit) {
                    (None, _) => t.push("; for a rational environment no bound is known then"),
                    (_, None) => t.push(
                        "; behind a coupling stiffer than the standard one, 2 delta/T, or a rigid \
                         one, it is not known to be passive then: soften the coupling",
                    ),
                    (Some(bound), Some(limit)) => {
                        t.push(": then the environment needs up to ");
                        t.push_number(*bound);
                        t.push(" N m s/rad of damping, not below the ");
                        t.push_number(*limit);
                        t.push(
                            " N m s/rad that device and coupling allow; a softer environment, or \
                             a coupling nearer to the standard one, passes",
                        );
                    }
                }
            }
        }
        t
    }
}

impl fmt::Display for TimingError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.sentence().as_str())
    }
}

impl core::error::Error for TimingError {}

impl Assessment {
    /// [`TimingChecked::margin`] of the scene that was assessed and certified; `None` where no board renders it
    /// for its numbers.
    pub const fn margin_on_board(&self, scene: &Scene) -> Option<f64> {
        self.margin_injecting(scene, 0.0)
    }

    /// [`TimingChecked::margin_with`] of that scene.
    pub const fn margin_injecting(&self, scene: &Scene, injected: f64) -> Option<f64> {
        match agree(OutputTiming::Simultaneous, scene, self) {
            Ok(limited) => Some(limited.margin(injected)),
            Err(_) => None,
        }
    }

    /// Whether a board that puts its torques out in the mode `M` renders the scene that was assessed
    /// and certified, as far as its numbers tell: what [`Certified::time`](Certified) answers.
    ///
    /// # Errors
    /// Why it does not.
    pub const fn renders_in<M: OutputMode>(&self, scene: &Scene) -> Result<(), TimingError> {
        self.renders_at(scene, M::TIMING)
    }

    /// The same of a mode as data.
    ///
    /// # Errors
    /// Why it does not.
    pub const fn renders_at(&self, scene: &Scene, timing: OutputTiming) -> Result<(), TimingError> {
        match agree(timing, scene, self) {
            Ok(_) => Ok(()),
            Err(error) => Err(error),
        }
    }
}

/// Whether a board may render a scene; if so, the scene with its torque limited.
///
/// A board limits every torque, so that the nonlinear bound has to pass the paper's rule, whatever
/// rule the scene's verdict follows. That proves the scene on its own: the bound is one on the index
/// (equation 31), and what it is known for has an index, since no wall pulls away and all that is
/// filtered decays. The loop is solvable each tick, too: a feedthrough that took it away would be
/// larger than the bound allows. So nothing is searched for, and a board has nothing of the
/// polynomials by which a host finds the index itself.
///
/// Where the type of an environment does not cancel damping, the program omits the code for
/// cancelled damping, and rejects a scene that cancels some.
// Not inlined: its frame is off a small board's stack when the servo is built.
#[inline(never)]
pub(super) const fn judged<E: EnvironmentModel, M: OutputMode>(
    scene: &Scene,
    is_late: bool,
    format: Format,
) -> Result<Limited, Step> {
    if first_invalid_number(scene, E::PROFILE).is_some() {
        return Err(Step::Certificate);
    }
    if !M::TIMING.fits(scene.timing.period) || !is_at_its_phase(M::TIMING, scene) {
        return Err(Step::Certificate);
    }
    let is_matched = matches!(scene.coupling, Coupling::Matched);
    if has_latency(scene) && (!is_matched || matches!(E::MEMORY, Memory::None)) {
        return Err(Step::Certificate);
    }
    let n = &LoopIntervals::of_late::<E>(scene, is_late, format);
    let solved = match M::TIMING {
        OutputTiming::Latched if is_late => Some(Interval::ONE),
        OutputTiming::Latched => None,
        OutputTiming::Simultaneous | OutputTiming::AtPhase(_) => {
            largest_solved::<E>(&scene.environment, n)
        }
    };
    let Some(solved) = solved else { return Err(Step::Certificate) };
    if E::PROFILE.exists && is_uneven::<E>(&scene.environment) {
        return Err(Step::Certificate);
    }
    let Some(bound) = nonlinear_bound::<E>(&scene.environment, solved, n) else {
        return Err(Step::Certificate);
    };
    match Limited::of_solved::<E>(scene, n, bound, solved) {
        Some(limited) if stands_counts_read_late(M::TIMING, &limited, scene, n) => Ok(limited),
        _ => Err(Step::Certificate),
    }
}

/// Whether a scene with this assessment agrees with a mode; if so, the scene with its torque limited.
pub(super) const fn agree(
    timing: OutputTiming,
    scene: &Scene,
    assessment: &Assessment,
) -> Result<Limited, TimingError> {
    if matches!(timing, OutputTiming::Latched) && !scene.environment.is_late() {
        return Err(TimingError::NotLate);
    }
    if let (Some(phase), false) = (timing.phase(), timing.fits(scene.timing.period)) {
        let longest = longest_phase(scene.timing.period);
        return Err(TimingError::PhaseRange { phase, shortest: SHORTEST_PHASE, longest });
    }
    if !is_at_its_phase(timing, scene) {
        let board = board_delay(timing, scene);
        if let TimeRange { least, most } = scene.latency.output_delay
            && least != most
        {
            return Err(TimingError::DelayRange { least, most });
        }
        return Err(TimingError::Phase { scene: scene.latency.output_delay.middle(), board });
    }
    if has_latency(scene) && !matches!(scene.coupling, Coupling::Matched) {
        return Err(TimingError::Unmatched);
    }
    let is_on_a_board = !matches!(timing, OutputTiming::Simultaneous);
    if is_on_a_board && !scene.latency.is_none() && !has_enough_jitter(scene) {
        let jitter = scene.latency.output_jitter;
        return Err(TimingError::Jitter { jitter });
    }
    let n = &LoopIntervals::of(scene, assessment.format);
    let bound = limited_bound(scene, assessment.rule, assessment.bound, n);
    let limited = match bound {
        Some(bound) => Limited::of(scene, n, bound),
        None => None,
    };
    let Some(limited) = limited else {
        return Err(TimingError::Limited {
            bound: match bound {
                Some(bound) => Some(bound.hi()),
                None => None,
            },
            limit: match paper_limit(n) {
                Some(limit) => Some(limit.lo()),
                None => None,
            },
        });
    };
    if stands_counts_read_late(timing, &limited, scene, n) {
        return Ok(limited);
    }
    Err(TimingError::ReadLate {
        period: scene.timing.period,
        bound: limited.bound.hi(),
        limit: read_late(&limited, n).lo(),
    })
}

/// Whether the board's torques come when the scene says, to a part in a billion, which the jitter that
/// a board needs is far above. A simulation puts them out as the scene says.
const fn is_at_its_phase(timing: OutputTiming, scene: &Scene) -> bool {
    let delay = scene.latency.output_delay;
    let board = board_delay(timing, scene);
    match timing {
        OutputTiming::Simultaneous => true,
        OutputTiming::Latched | OutputTiming::AtPhase(_) => {
            delay.is_exact() && (delay.least - board).abs() <= 1e-9 * board
        }
    }
}

/// Time in s from a count to the torque that the servo computes from it, beside an environment's whole
/// samples: until the code is put out, and an update more where a current loop takes it over.
const fn board_delay(timing: OutputTiming, scene: &Scene) -> f64 {
    let phase = match timing.phase() {
        Some(phase) => phase,
        None => 0.0,
    };
    match scene.latency.actuator_updates {
        0 => phase,
        updates => phase + scene.timing.period / updates as f64,
    }
}

/// Whether a scene stands counts that are read up to [`READ_WITHIN`] after the beginning of a period,
/// as they are where torques are latched.
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
        // Only behind the coupling that was made for it.
        OutputTiming::AtPhase(_) => false,
        OutputTiming::Latched => {
            scene.timing.period > READ_WITHIN && limited.bound.is_below(read_late(limited, n))
        }
        OutputTiming::Simultaneous => true,
    }
}

/// Whether a scene with a latency allows for the time in which a board reads a count. Where a current loop is
/// updated, its timer captures the count at the very update that begins the period.
const fn has_enough_jitter(scene: &Scene) -> bool {
    scene.latency.actuator_updates > 0 || scene.latency.output_jitter >= READ_WITHIN
}

/// Upper limit of the bound for that.
const fn read_late(limited: &Limited, n: &LoopIntervals) -> Interval {
    let late = Interval::exact(READ_WITHIN).div(n.period);
    Missed::read_late(n, late).limit(limited.coupling)
}

/// Whether a torque limit may make a motor of it.
const fn is_uneven<E: EnvironmentModel>(environment: &Environment) -> bool {
    match environment.profile() {
        Some(profile) => is_motor_where_limited::<E>(profile),
        None => false,
    }
}

/// The bound on the index of a certified scene whose torque is limited; `bound` is that which the
/// verdict compared, for one-sided and limited scenes.
///
/// It holds for a limit that moves, too: the clip of a monotone law at any level is monotone and no steeper,
/// and that of a damper or a canceller is a part of it that may change from tick to tick (theory, section 5).
/// A falling level takes energy away; a rising level adds, once, the energy that the environment stores at
/// its depth.
pub(super) const fn limited_bound(
    scene: &Scene,
    rule: Rule,
    bound: Option<Interval>,
    n: &LoopIntervals,
) -> Option<Interval> {
    if is_uneven::<Environment>(&scene.environment) {
        return None;
    }
    if matches!(rule, Rule::Nonlinear) {
        return bound;
    }
    match largest_solved::<Environment>(&scene.environment, n) {
        Some(solved) => nonlinear_bound::<Environment>(&scene.environment, solved, n),
        None => None,
    }
}

#[cfg(test)]
mod tests;
