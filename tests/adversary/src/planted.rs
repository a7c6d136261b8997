//! Wrong rules, planted to see that the search finds what they let pass.
//!
//! The product is untouched. A wrong rule takes a scene for another one, and accepts it if that is certified; the
//! servo is that of the certified scene, and the simulated scene is the stated one. Nothing else in the search
//! differs.

use std::f64::consts::PI;

use haptic_servo::certificate::{LoopTransfers, PassivityProblem};
use haptic_servo::environment::{Environment, Parts};
use haptic_servo::latency::{Latency, TimeRange};
use haptic_servo::number::Format;
use haptic_servo::output_timing::READ_WITHIN;
use haptic_servo::scene::{Coupling, Device, EncoderReading, Scene};
use nalgebra::Complex;

use crate::mode::{Actual, kept};
use crate::periodic_motion::at;

/// A wrong rule.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Planted {
    /// Jitter behind a matched coupling is ignored.
    MatchedJitter,
    /// Jitter behind a coupling spring leaves `delta (1 - sqrt(h))` and takes a compliance from the spring, as if
    /// both were not in the coupling at once.
    SpringJitter,
    /// Jitter of a linear loop changes the torque once in a tick, also where it crosses a count.
    LinearJitter,
    /// Jitters of torques and counts at once are a jitter of one of them, of the same sum.
    TwoJitters,
    /// Without a coupling the mean age of a torque counts, and not the largest.
    MeanAge,
    /// The lag of the amplifier is ignored.
    LagIgnored,
    /// The delay of the output is ignored.
    DelayIgnored,
    /// Torques that are certified for the next count come soon after their own.
    EarlyTorques,
    /// A late code is left out, and the servo goes on.
    StaleCode,
    /// Codes are put out in any order.
    Unordered,
    /// A static law without a coupling has a tenth more than its limit, such as `K T / 2 + abs(B) < b`.
    RigidBeyondLimit,
    /// Missed updates cost nothing.
    MissedUpdates,
    /// An encoder is as linear as a ruler.
    Linear,
    /// An encoder's readings are of now.
    Ageless,
    /// All readings come.
    NoneDropped,
}

impl Planted {
    /// All of them.
    pub const ALL: [Self; 15] = [
        Self::MatchedJitter,
        Self::SpringJitter,
        Self::LinearJitter,
        Self::TwoJitters,
        Self::MeanAge,
        Self::LagIgnored,
        Self::DelayIgnored,
        Self::EarlyTorques,
        Self::StaleCode,
        Self::Unordered,
        Self::RigidBeyondLimit,
        Self::MissedUpdates,
        Self::Linear,
        Self::Ageless,
        Self::NoneDropped,
    ];

    /// What the rule takes a scene for.
    pub fn taken_for(self, scene: &Scene, format: Format) -> Scene {
        let Scene { coupling, latency, timing, .. } = *scene;
        let is_rigid = coupling == Coupling::Rigid;
        let with = |latency| Scene { latency, ..*scene };
        match self {
            Self::MatchedJitter if coupling == Coupling::Matched => with(without_jitter(latency)),
            Self::MeanAge if is_rigid => with(without_jitter(latency)),
            Self::SpringJitter if former_spring(scene, format) == Some(true) => certain(scene),
            Self::LinearJitter if former_linear(scene, format) == Some(true) => certain(scene),
            Self::TwoJitters => {
                let output_jitter = latency.total_jitter();
                with(Latency { output_jitter, count_jitter: 0.0, ..latency })
            }
            Self::LagIgnored => with(Latency { actuator_lag: TimeRange::ZERO, ..latency }),
            Self::DelayIgnored => with(Latency { output_delay: TimeRange::ZERO, ..latency }),
            Self::RigidBeyondLimit if is_rigid => with_passivity(scene, 1.1),
            Self::MissedUpdates => with_passivity(
                scene,
                timing.worst_period.map_or(1.0, |worst| worst / timing.period),
            ),
            Self::Linear => {
                with(read_by(latency, EncoderReading { linearity: 0.0, ..*latency.encoder }))
            }
            Self::NoneDropped => {
                with(read_by(latency, EncoderReading { dropped: 0, ..*latency.encoder }))
            }
            Self::Ageless => {
                let age = latency.encoder.age.middle();
                let TimeRange { least, most } = latency.output_delay;
                let output_delay = TimeRange::between(least - age, most - age);
                let deviation = latency.encoder.deviation_of_age();
                let count_jitter = (latency.count_jitter - deviation).max(0.0);
                let ideal = EncoderReading { age: TimeRange::ZERO, ..*latency.encoder };
                with(read_by(Latency { output_delay, count_jitter, ..latency }, ideal))
            }
            _ => *scene,
        }
    }

    /// How a scene differs from what the rule takes it for.
    pub fn actual(self, scene: &Scene, taken_for: &Scene) -> Actual {
        let is_on_time = self == Self::EarlyTorques && scene.latency.is_none();
        let overtake = scene.latency.total_jitter() > 0.5 * scene.timing.period;
        let passivity = scene.device.passivity();
        Actual {
            latency: (scene.latency != taken_for.latency).then_some(scene.latency),
            passivity: (passivity != taken_for.device.passivity()).then_some(passivity),
            delay: is_on_time.then_some(0.005),
            unreported: self == Self::StaleCode,
            unordered: self == Self::Unordered && overtake,
        }
    }
}

/// With other readings of the same age.
fn read_by(latency: Latency, reading: EncoderReading) -> Latency {
    Latency {
        encoder: if reading == *latency.encoder { latency.encoder } else { kept(reading) },
        ..latency
    }
}

/// A board's counts jitter in any case.
fn without_jitter(latency: Latency) -> Latency {
    let output_jitter = latency.total_jitter().min(READ_WITHIN);
    Latency { output_jitter, count_jitter: 0.0, ..latency }
}

/// The same servo on a device with this times the passivity.
fn with_passivity(scene: &Scene, factor: f64) -> Scene {
    let Device { damping, .. } = scene.device;
    let passivity = Some(factor * scene.device.passivity());
    let mut with = *scene;
    with.device = Device { damping: factor * damping, passivity, ..scene.device };
    // A canceller cancels as much as it did.
    if let Environment::Parts(Parts { canceller: Some(canceller), .. }) = &mut with.environment {
        canceller.residual += with.device.damping - damping;
    }
    with
}

/// A scene with the same servo that the certificate passes.
fn certain(scene: &Scene) -> Scene {
    Scene { latency: Latency::NONE, ..with_passivity(scene, 1e3) }
}

/// The constant delay in periods, as whole ones and a part of one, and the jitter, where nothing lags.
fn delay_and_jitter(scene: &Scene) -> Option<(f64, f64, f64)> {
    let (latency, period) = (&scene.latency, scene.timing.period);
    let delay = latency.output_delay;
    let only = Latency { output_jitter: latency.output_jitter, ..Latency::delayed(delay.most) };
    let (delay, jitter) = (delay.most / period, latency.output_jitter / period);
    let whole = (delay * (1.0 + 1e-12)).floor();
    (*latency == only && jitter > 0.0).then_some((whole, (delay - whole).max(0.0), jitter))
}

/// Equation 41 with jitter as it once was: from `delta` the share `sqrt(h)` is taken, and from the compliance what
/// absorbs the rest. `None` where it is not asked.
fn former_spring(scene: &Scene, format: Format) -> Option<bool> {
    let Coupling::Spring { stiffness } = scene.coupling else { return None };
    let (whole, part, jitter) = delay_and_jitter(scene)?;
    let index = PassivityProblem::in_format(scene, format).ok()?.bound()?.hi();
    let (period, delta) = (scene.timing.period, scene.device.passivity());
    let share = jitter.sqrt();
    let remaining = delta * (1.0 - share);
    let given_up = jitter * period / (2.0 * delta * share);
    let standard = period / (2.0 * remaining);
    // Sum of `(2 m + 1)` times each compliance but the first.
    let moment = whole * (whole + 2.0) + part * (2.0 * whole + 3.0);
    let (excess, others) = (1.0 / stiffness - standard - given_up, standard * moment);
    let (margin, most) = (excess - others, excess + others / 3.0);
    let limit = remaining / (1.0 + 2.0 * remaining * most * most / (period * margin));
    Some(remaining > 0.0 && margin > 0.0 && index < limit)
}

/// Equation 38 with jitter as it once was, without a lag: `delta (1 - h/2) + Re(H g)` is above
/// `(D + 3 h T^2) abs(H)^2 / (4 delta)`. `None` where it is not asked.
fn former_linear(scene: &Scene, format: Format) -> Option<bool> {
    const ANGLES: u32 = 2000;
    let (whole, part, jitter) = delay_and_jitter(scene)?;
    let is_linear = PassivityProblem::in_format(scene, format).ok()?.bound().is_none();
    if !is_linear || scene.coupling == Coupling::Matched {
        return None;
    }
    let (period, delta) = (scene.timing.period, scene.device.passivity());
    let controller = LoopTransfers::in_format(scene, format).ok()?.controller;
    let ripple = part * (1.0 - part) + 3.0 * jitter;
    Some((1..=ANGLES).all(|i| {
        let z = Complex::from_polar(1.0, PI * f64::from(i) / f64::from(ANGLES));
        let h = at(&controller, z) * period;
        let g = z.powf(-whole) * (1.0 / (z - 1.0) - part / z);
        delta * (1.0 - 0.5 * jitter) + (h * g).re >= ripple * h.norm_sqr() / (4.0 * delta)
    }))
}
