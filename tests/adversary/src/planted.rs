//! Wrong rules, planted to see that the search finds what they let pass.
//!
//! The product is untouched: it certifies the scene that a wrong rule would take the present one for, and
//! the simulated board is the present one. The limits are computed here, from the formulas.

use haptic_servo::environment::Environment;
use haptic_servo::latency::{Latency, TimeRange};
use haptic_servo::number::Format;
use haptic_servo::scene::{Coupling, Scene};
use rand::Rng;
use tests::scenes::log_uniform;

use crate::mode::Actual;
use crate::scenes::{Choice, Kind, least_damping};
use crate::search::{Effort, Search};

/// A wrong rule.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Planted {
    /// The jitter of torques and counts behind a matched coupling is ignored.
    JitterIgnored,
    /// The jitter of a loop behind a coupling spring is taken for what `delta (1 - sqrt(h))` and a
    /// compliance leave of equation 41, as if both were not in the coupling at once.
    JitterOfSprings,
    /// The lag of the amplifier is ignored.
    LagIgnored,
    /// The delay of the output is ignored.
    DelayIgnored,
    /// Torques that are certified for the next count come soon after their own.
    EarlyTorques,
    /// A late code at a phase is left out, and the servo goes on.
    StaleCode,
    /// A wall without a coupling has a tenth more than its limit, `K T / 2 + abs(B) < b`.
    RigidBeyondLimit,
    /// Missed updates cost the square root of what they cost.
    MissedUpdates,
}

impl Planted {
    /// All of them.
    pub const ALL: [Self; 8] = [
        Self::JitterIgnored,
        Self::JitterOfSprings,
        Self::LagIgnored,
        Self::DelayIgnored,
        Self::EarlyTorques,
        Self::StaleCode,
        Self::RigidBeyondLimit,
        Self::MissedUpdates,
    ];

    /// The search for what it lets pass.
    pub const fn search(self, scenes: u64) -> Search {
        Search {
            seed: 1,
            scenes,
            time: None,
            choice: self.choice(),
            enough: 3,
            effort: Effort::USUAL,
        }
    }

    /// The scenes that the rule judges.
    pub const fn choice(self) -> Choice {
        let any = Choice { planted: Some(self), ..Choice::ANY };
        let bare = Choice { latency: Some(true), bare: Some(true), limited: Some(false), ..any };
        match self {
            Self::JitterIgnored | Self::LagIgnored | Self::DelayIgnored => bare,
            Self::JitterOfSprings => Choice { kind: Some(Kind::Wall), ..bare },
            Self::StaleCode => {
                Choice { latency: Some(true), bare: Some(false), latched: Some(false), ..any }
            }
            Self::EarlyTorques => Choice {
                kind: Some(Kind::Wall),
                latency: Some(false),
                bare: Some(false),
                latched: Some(true),
                worst_period: Some(false),
                taken: 0.0,
                ..any
            },
            Self::RigidBeyondLimit => {
                Choice { latency: Some(false), kind: Some(Kind::Wall), ..bare }
            }
            Self::MissedUpdates => Choice {
                latency: Some(false),
                bare: Some(false),
                worst_period: Some(true),
                saturates: false,
                ..any
            },
        }
    }

    /// Makes the scene what the rule takes it for.
    pub fn plant(self, rng: &mut impl Rng, scene: &mut Scene, actual: &mut Actual) {
        let period = scene.timing.period;
        let stated = scene.latency;
        match self {
            Self::JitterIgnored => {
                scene.coupling = Coupling::Matched;
                let jitter = log_uniform(rng, 0.01, 0.3) * period;
                let least = stated.output_delay.least.max(jitter);
                let latency =
                    Latency { output_delay: TimeRange::exactly(least), ..no_updates(stated) };
                scene.latency = Latency { output_jitter: 0.0, ..latency };
                actual.latency = Some(Latency { output_jitter: jitter, ..latency });
            }
            Self::JitterOfSprings => {
                let jitter = log_uniform(rng, 0.01, 0.3) * period;
                let delay = jitter * log_uniform(rng, 1.0, 2.0);
                let stiffness = 2.0 * scene.device.passivity() / period;
                let spring = stiffness / (1.0 + log_uniform(rng, 0.3, 10.0));
                scene.coupling = Coupling::Spring { stiffness: spring };
                scene.latency = Latency::NONE;
                actual.latency = Some(Latency { output_jitter: jitter, ..Latency::delayed(delay) });
            }
            Self::LagIgnored => {
                let lag = TimeRange::exactly(log_uniform(rng, 0.2, 1.5) * period);
                let latency = Latency { actuator_lag: lag, ..no_updates(stated) };
                scene.latency = Latency { actuator_lag: TimeRange::ZERO, ..latency };
                actual.latency = Some(latency);
            }
            Self::DelayIgnored => {
                let delay = TimeRange::exactly(log_uniform(rng, 0.2, 1.5) * period);
                let latency = Latency { output_jitter: 0.0, ..no_updates(stated) };
                scene.latency = Latency { output_delay: TimeRange::ZERO, ..latency };
                actual.latency = Some(Latency { output_delay: delay, ..latency });
            }
            Self::StaleCode => actual.unreported = true,
            Self::EarlyTorques => actual.delay = Some(0.005),
            Self::RigidBeyondLimit => scene.coupling = Coupling::Rigid,
            Self::MissedUpdates => {}
        }
    }

    /// Whether the rule accepts a scene that the certificate has passed.
    pub fn accepts(self, scene: &Scene, actual: &Actual) -> bool {
        match (self, actual.latency) {
            (Self::JitterOfSprings, Some(latency)) => {
                let index = delayed_index(scene);
                index.zip(former_limit(scene, &latency)).is_some_and(|(index, limit)| index < limit)
            }
            _ => true,
        }
    }

    /// The damping of the simulated device in N m s/rad, where the rule asks for another.
    pub fn damping(self, scene: &Scene, format: Format) -> Option<f64> {
        let timing = scene.timing;
        let least = || least_damping(scene, format);
        match self {
            Self::RigidBeyondLimit => least().map(|least| least / 1.1),
            Self::MissedUpdates => {
                let stretch = timing.worst_period.unwrap_or(timing.period) / timing.period;
                least().map(|least| least / stretch.sqrt())
            }
            _ => None,
        }
    }
}

fn no_updates(latency: Latency) -> Latency {
    Latency { actuator_updates: 0, ..latency }
}

/// The index of a delayed wall in N m s/rad: `K T (n - 1/2)` and the damper's.
fn delayed_index(scene: &Scene) -> Option<f64> {
    let (Environment::DelayedSpring(wall) | Environment::DamperWall(wall)) = &scene.environment
    else {
        return None;
    };
    let half = 0.5 * wall.stiffness.abs() * scene.timing.period;
    let samples = f64::from(u32::try_from(wall.delay).ok()?);
    Some(half * (2.0 * samples - 1.0).max(0.0) + wall.damping.abs() * (2.0 * samples + 1.0))
}

/// Equation 41 with jitter as it once was: from `delta` the share `sqrt(h)` is taken, and from the
/// compliance what absorbs the rest.
fn former_limit(scene: &Scene, latency: &Latency) -> Option<f64> {
    let Coupling::Spring { stiffness } = scene.coupling else { return None };
    let (period, delta) = (scene.timing.period, scene.device.passivity());
    let jitter = latency.output_jitter / period;
    let share = jitter.sqrt();
    let remaining = delta * (1.0 - share);
    let given_up = jitter * period / (2.0 * delta * share);
    let standard = period / (2.0 * remaining);
    let delay = latency.output_delay.most / period;
    let whole = delay.floor();
    // Sum of `(2 m + 1)` times each compliance but the first.
    let moment = whole * (whole + 2.0) + (delay - whole) * (2.0 * whole + 3.0);
    let (excess, others) = (1.0 / stiffness - standard - given_up, standard * moment);
    let margin = excess - others;
    if margin <= 0.0 {
        return None;
    }
    let most = excess + others / 3.0;
    Some(remaining / (1.0 + 2.0 * remaining * most * most / (period * margin)))
}
