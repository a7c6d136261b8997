//! From a [`Certified`] scene to a [`Timed`] one: the scene's delay and the board's are the same.

use core::fmt;
use core::marker::PhantomData;

use super::model::Numbers;
use super::rejection::Rejection;
use super::rules::paper_limit;
use super::{Assessment, Certified, Rule, Sentence, assess_in};
use crate::environment::{Environment, Wall};
use crate::scene::Scene;
use crate::servo::{OutputMode, OutputTiming};

/// A certified scene that agrees with the mode `M` in which a board puts its torques out.
///
/// There is no way to make one but [`Certified::time`](Certified), and a cycle is built from
/// nothing else.
///
/// ```
/// use firmware::certificate::{Certified, Timed};
/// use firmware::environment::DelayedSpring;
/// use firmware::scene::{Coupling, Device, Scene, Timing};
/// use firmware::servo::Latched;
///
/// type SpringScene = Scene<DelayedSpring<1>>;
/// const SPRING: SpringScene = Scene {
///     device: Device { inertia: 2.2e-5, damping: 0.022, passivity: None },
///     timing: Timing { period: 0.001, worst_period: None },
///     coupling: Coupling::Spring { stiffness: 44.0 },
///     environment: DelayedSpring { stiffness: 22.0 },
///     torque_limit: None,
/// };
/// const CERTIFIED: Certified<SpringScene> = SPRING.certified();
/// // Late by one sample, which is what the latch takes: this compiles.
/// const TIMED: Timed<SpringScene, Latched> = CERTIFIED.timed::<Latched>();
/// # let _ = TIMED;
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Timed<S, M> {
    certified: Certified<S>,
    room: Option<f64>,
    mode: PhantomData<M>,
}

impl<S, M> Timed<S, M> {
    pub(super) const fn new(certified: Certified<S>, room: Option<f64>) -> Self {
        Self { certified, room, mode: PhantomData }
    }

    /// Damping in N m s/rad that may be switched on and off at will, one sample late, beside the
    /// environment: any less keeps the certificate. `None`: there is no room for any.
    ///
    /// An arbitrarily switched damper `B` adds at most `B` to the index (theory, section 5, the
    /// nonlinear bound), and index and damper together have to meet conditions 17 and 18, the rule
    /// that does not ask for linearity.
    pub const fn room(&self) -> Option<f64> {
        self.room
    }

    /// The scene.
    pub const fn scene(&self) -> &S {
        self.certified.scene()
    }

    /// The numbers that the certificate rests on.
    pub const fn assessment(&self) -> &Assessment {
        self.certified.assessment()
    }
}

/// Why a certified scene cannot be rendered by a board.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum TimingError {
    /// The torque takes a sample to the motor, and the environment allows none.
    NotLate,
    /// The torque takes longer to the motor than a sample.
    Latency {
        /// The board's latency in s.
        latency: f64,
        /// The scene's period in s.
        period: f64,
    },
    /// The torque comes up to a sample early, and so it would not pass.
    Early(Rejection),
}

impl TimingError {
    /// The error as a sentence, the same at compile time, on the host and on the board.
    pub const fn sentence(&self) -> Sentence {
        let mut t = Sentence::new();
        match self {
            Self::NotLate => t.push(
                "the environment is not late by a whole sample, but on this board a torque takes \
                 one: give all of it a delay of at least 1",
            ),
            Self::Latency { latency, period } => {
                t.push("a torque takes up to ");
                t.push_number(*latency);
                t.push(" s to the motor, more than the period of ");
                t.push_number(*period);
                t.push(" s: lengthen the period, or latch the torque by the timer");
            }
            Self::Early(rejection) => {
                t.push("this board writes a torque at once, up to a sample early, and then: ");
                t.push(rejection.sentence().as_str());
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

/// Whether a scene with this assessment agrees with a mode; if so, its [`Timed::room`].
pub(super) const fn agree<M: OutputMode>(
    scene: &Scene,
    assessment: &Assessment,
) -> Result<Option<f64>, TimingError> {
    let room = room(scene, assessment);
    let latency = match M::TIMING {
        OutputTiming::Simultaneous => return Ok(room),
        OutputTiming::Latched => None,
        OutputTiming::Immediate { latency } => Some(latency as f64 * 1e-9),
    };
    let Some(environment) = one_sample_earlier(&scene.environment) else {
        return Err(TimingError::NotLate);
    };
    let Some(latency) = latency else { return Ok(room) };
    let period = scene.timing.period;
    if latency > period {
        return Err(TimingError::Latency { latency, period });
    }
    let earlier = Scene { environment, ..*scene };
    let assessment = assess_in(&earlier, assessment.format);
    if let Err(rejection) = assessment.outcome {
        return Err(TimingError::Early(rejection));
    }
    Ok(match (room, self::room(&earlier, &assessment)) {
        (Some(late), Some(early)) => Some(late.min(early)),
        _ => None,
    })
}

/// What conditions 17 and 18 leave over the index that does not ask for linearity.
const fn room(scene: &Scene, assessment: &Assessment) -> Option<f64> {
    let index = match assessment.rule {
        Rule::Exact => assessment.alpha,
        Rule::Nonlinear => assessment.bound,
    };
    let (Some(index), Some(limit)) = (index, paper_limit(&Numbers::of(scene, assessment.format)))
    else {
        return None;
    };
    let room = limit.sub(index).lo();
    if room > 0.0 { Some(room) } else { None }
}

/// The environment one sample less late; `None` where some of it is not late at all.
const fn one_sample_earlier(environment: &Environment) -> Option<Environment> {
    match environment {
        Environment::DelayedSpring(wall) => match wall_earlier(wall) {
            Some(wall) => Some(Environment::DelayedSpring(wall)),
            None => None,
        },
        Environment::DamperWall(wall) => match wall_earlier(wall) {
            Some(wall) => Some(Environment::DamperWall(wall)),
            None => None,
        },
        Environment::FreeMode { residual, delay: delay @ 1.. } => {
            Some(Environment::FreeMode { residual: *residual, delay: *delay - 1 })
        }
        Environment::Rational(rational) if rational.delay > 0 => {
            let mut earlier = *rational;
            earlier.delay -= 1;
            Some(Environment::Rational(earlier))
        }
        // The canceller in front of a wall is undelayed.
        Environment::FreeMode { .. }
        | Environment::FreeModeWall { .. }
        | Environment::Rational(_) => None,
    }
}

const fn wall_earlier(wall: &Wall) -> Option<Wall> {
    if wall.delay == 0 { None } else { Some(Wall { delay: wall.delay - 1, ..*wall }) }
}

#[cfg(test)]
mod tests;
