//! The curves and lines of the plane on which the verdict of a scene rests.
//!
//! - A linear scene is judged by its environment with the coupling taken in, `E'` (theory, section
//!   4.1): at the standard coupling that is the environment. Where updates may be missed and torques
//!   are latched, a second such curve counts as well.
//! - A one-sided or limited scene is judged by a bound on its index, an upright line: its linear
//!   environment only has to have an index at all.
//! - Where torques lag, and behind a matched coupling, a linear scene is judged at the device's port
//!   (theory, section 13): by the controller with delay and lags, less the ripple between samples.
//!
//! The verdict rests on the distance to the critical line, which is at minus the largest index that passes.

mod window;
pub mod words;

use std::f64::consts::PI;

use haptic_servo::certificate::{Assessment, LoopTransfers, PassivityProblem, Rule, assess};
use haptic_servo::environment::Environment;
use haptic_servo::number::Format;
use haptic_servo::passivity::interval::Interval;
use haptic_servo::passivity::lagged::{LagIntervals, SampledResponse};
use haptic_servo::passivity::transfer::{Transfer, Unbuildable};
use haptic_servo::rendering::context_beside_anticogging;
use haptic_servo::scene::{Coupling, Latency, Scene};
use haptic_servo::words;
use nalgebra::Complex;
use thiserror::Error;

use crate::line_search::minimizing_angle;
use crate::response::Response;
use crate::simulation::unbuildable;
use crate::unit_circle_poles::{UnitCirclePole, outside, poles};

pub use window::{critical_lines, is_drawable, span, usual_window};

/// Points between two poles on half the unit circle. They are denser towards the poles, where the
/// curve is longest.
const POINTS: usize = 1600;

/// Smallest distance in rad from a pole at which the curve is drawn.
const NEAREST: f64 = 1e-3;

/// Points beside the angle at which the real part is least, on each side: a resonance may be
/// narrower than the distance between the others.
const AROUND_LEAST: i32 = 60;

/// Why a scene has no curve.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error("{scene}: the environment has no transfer function to draw: {}", reason(*.why))]
pub struct NoTransfer {
    /// Name of the scene.
    pub scene: String,
    /// The cause.
    pub why: Unbuildable,
}

fn reason(why: Unbuildable) -> &'static str {
    match why {
        Unbuildable::Improper => "it needs future samples",
        other => unbuildable(other),
    }
}

words! {
    /// The role of a curve in the verdict.
    Role {
    /// It is compared with the critical line.
    Judged "judged",
    /// It is compared with the critical line, too: torques are latched, and updates may be missed.
    JudgedLatched "judged-latched",
    /// It is compared with the critical line, and has delay, amplifier and sensor in it.
    JudgedAtPort "judged-at-port",
    /// Its poles are judged, and a bound in place of its real part.
    Linear "linear",
    /// The environment without its coupling, which is not judged.
    Alone "alone",
    }
}

impl Role {
    /// Whether the curve itself must keep clear of the critical line.
    pub fn is_judged(self) -> bool {
        matches!(self, Self::Judged | Self::JudgedLatched | Self::JudgedAtPort)
    }
}

/// A curve for velocity, `(T z / (z - 1)) G`.
#[derive(Debug)]
pub struct Curve {
    /// Its role in the verdict.
    pub role: Role,
    /// For angles from nearly 0 to pi, cut where there are poles.
    pub branches: Vec<Branch>,
    /// Poles on the upper half of the unit circle.
    pub poles: Vec<UnitCirclePole>,
    /// Number of poles outside of it.
    pub outside: usize,
    /// Real part of the curve near its pole at rest.
    pub asymptote: Option<f64>,
    /// Where the real part is least; `None` where it is the same all around.
    pub minimum: Option<(f64, f64)>,
    /// Minus the least real part; `None` where poles rule out an index.
    pub alpha: Option<f64>,
}

/// The part of a curve between two poles, or from or to the real axis.
#[derive(Debug)]
pub struct Branch {
    /// Rising angles in rad.
    pub angles: Vec<f64>,
    /// Real and imaginary part at each.
    pub values: Vec<(f64, f64)>,
}

impl Curve {
    fn new(
        role: Role,
        transfer: Transfer,
        scene: &Scene,
        deciding: Option<Interval>,
        alpha: Option<f64>,
    ) -> Self {
        let velocity = Response::new(transfer).from_velocity(scene.timing.period);
        Self::through(role, &velocity, &|theta| velocity.at_angle(theta), deciding, alpha)
    }

    /// A curve through these values, with the poles on the circle and outside of it of a transfer function.
    fn through(
        role: Role,
        velocity: &Response,
        value: &dyn Fn(f64) -> Complex<f64>,
        deciding: Option<Interval>,
        alpha: Option<f64>,
    ) -> Self {
        let poles = poles(velocity.transfer());
        let outside = outside(velocity.transfer());
        let real = |theta: f64| value(theta).re;
        let angle = |cosine: f64| cosine.clamp(-1.0, 1.0).acos();
        // The minimum that the certificate has found, and the minimum found here.
        let known =
            deciding.and_then(|cos| minimizing_angle(real, angle(cos.hi()), angle(cos.lo())));
        let found = minimizing_angle(real, 0.0, PI);
        let lowest = [known, found].into_iter().flatten().map(|theta| theta.max(NEAREST));
        let lowest =
            lowest.min_by(|a, b| real(*a).total_cmp(&real(*b))).filter(|_| found.is_some());
        let point = |theta: f64| {
            let value = value(theta);
            (value.re, value.im)
        };
        let has_index = outside == 0 && poles.iter().all(UnitCirclePole::is_passive);
        let least_real = || lowest.map_or_else(|| real(1.0), real);
        Self {
            role,
            branches: branches(&poles, lowest, point),
            asymptote: poles
                .first()
                .filter(|pole| pole.theta == 0.0 && pole.residue().is_some())
                .map(|_| real(NEAREST)),
            outside,
            minimum: lowest.map(point),
            alpha: has_index.then(|| alpha.unwrap_or_else(|| -least_real())),
            poles,
        }
    }

    /// Real and imaginary parts along the curve.
    pub fn values(&self) -> impl Iterator<Item = &(f64, f64)> {
        self.branches.iter().flat_map(|branch| &branch.values)
    }

    /// Angles in rad along the curve, with real and imaginary parts.
    pub fn points(&self) -> impl Iterator<Item = (f64, (f64, f64))> {
        let of = |branch: &Branch| {
            branch.angles.iter().copied().zip(branch.values.iter().copied()).collect::<Vec<_>>()
        };
        self.branches.iter().flat_map(of)
    }

    /// The least real part that is drawn; minus infinity without an index: the curve goes to infinity on the
    /// left or askew, or has poles outside of the circle.
    fn least_real(&self) -> f64 {
        if self.alpha.is_none() {
            return f64::NEG_INFINITY;
        }
        self.values().map(|value| value.0).fold(f64::INFINITY, f64::min)
    }
}

/// A scene as its Nyquist curves and the line that they must not cross.
#[derive(Debug)]
pub struct NyquistScene {
    /// Name of the scene.
    pub name: String,
    /// Period in s.
    pub period: f64,
    /// Its curves, the judged curves first.
    pub curves: Vec<Curve>,
    /// The limit that the index must stay below; `None` where the rule passes none.
    pub limit: Option<f64>,
    /// Name of the limit.
    pub limit_name: &'static str,
    /// The bound that is judged in place of the curve: of one-sided and limited scenes.
    pub bound: Option<f64>,
}

impl NyquistScene {
    /// The curves of a scene.
    ///
    /// # Errors
    /// Where the environment has no transfer function.
    pub fn of(name: &str, scene: &Scene) -> Result<Self, NoTransfer> {
        let no_transfer = |why| NoTransfer { scene: name.to_owned(), why };
        let transfers = LoopTransfers::of(scene).map_err(no_transfer)?;
        let latched = LoopTransfers::equivalent_where_latched(scene).map_err(no_transfer)?;
        let assessment = assess(scene);
        let posed = PassivityProblem::of(scene).ok();
        let limit = posed.as_ref().and_then(PassivityProblem::limit).map(Interval::midpoint);
        let alone = assessment.alpha.map(Interval::midpoint);
        let cos = assessment.cos_theta;
        let curve = |role, transfer, alpha| Curve::new(role, transfer, scene, cos, alpha);
        let curves = match (assessment.rule, latched) {
            (Rule::Exact, _) if is_judged_at_port(scene) => {
                let alone = curve(Role::Alone, transfers.environment, alone);
                let port = PortCurve::of(scene, transfers.controller);
                port.into_iter().map(|port| port.curve(cos)).chain([alone]).collect()
            }
            (Rule::Nonlinear, _) => vec![curve(Role::Linear, transfers.environment, alone)],
            (Rule::Exact, None) if transfers.equivalent == transfers.environment => {
                vec![curve(Role::Judged, transfers.environment, alone)]
            }
            (Rule::Exact, latched) => {
                // Of two indices the certificate states the larger one, without its curve.
                let alpha = assessment.alpha_coupled.filter(|_| latched.is_none());
                let judged =
                    curve(Role::Judged, transfers.equivalent, alpha.map(Interval::midpoint));
                let latched = latched.map(|transfer| curve(Role::JudgedLatched, transfer, None));
                let alone = (transfers.equivalent != transfers.environment)
                    .then(|| curve(Role::Alone, transfers.environment, alone));
                [Some(judged), latched, alone].into_iter().flatten().collect()
            }
        };
        Ok(Self {
            name: name.to_owned(),
            period: scene.timing.period,
            curves,
            limit,
            limit_name: limit_name(scene, &assessment, limit),
            bound: assessment.bound.map(Interval::midpoint),
        })
    }

    /// The curves that must keep clear of the critical line.
    pub fn judged_curves(&self) -> impl Iterator<Item = &Curve> {
        self.curves.iter().filter(|curve| curve.role.is_judged())
    }

    /// Distance in N m s/rad of the judged curve, or of its bound, to the right of the critical line:
    /// negative where it crosses the line, minus infinity where poles or the coupling rule out a certificate,
    /// NaN where no bound is known.
    pub fn clearance(&self) -> f64 {
        let Some(limit) = self.limit else { return f64::NEG_INFINITY };
        let real = |curve: &Curve| match curve.role {
            role if role.is_judged() => curve.least_real() + limit,
            Role::Linear if curve.alpha.is_none() => f64::NEG_INFINITY,
            Role::Linear => self.bound.map_or(f64::NAN, |bound| limit - bound),
            _ => f64::INFINITY,
        };
        let all = self.curves.iter().map(real);
        all.fold(
            f64::INFINITY,
            |least, next| if next < least || next.is_nan() { next } else { least },
        )
    }

    /// The factor by which the judged curve, or its bound, may grow until it touches the critical line;
    /// `None` where it passes at no size or at any size, and for a curve at the port.
    pub fn gain_margin(&self) -> Option<f64> {
        let index = |curve: &Curve| match curve.role {
            Role::Judged | Role::JudgedLatched => curve.alpha,
            // The ripple between samples grows with the square.
            Role::JudgedAtPort => None,
            Role::Linear => curve.alpha.and(self.bound),
            Role::Alone => Some(f64::NEG_INFINITY),
        };
        let all: Option<Vec<_>> = self.curves.iter().map(index).collect();
        let largest = all?.into_iter().fold(f64::NEG_INFINITY, f64::max);
        self.limit.filter(|_| largest > 0.0).map(|limit| limit / largest)
    }

    /// The angle in rad by which a curve may turn clockwise until it touches the critical line, and the place
    /// where it would: the angle on the circle in rad, and the value. `None` where it never reaches as far as
    /// the line, and where it goes to infinity: there any lag is too much.
    pub fn phase_margin(&self, curve: &Curve) -> Option<(f64, f64, (f64, f64))> {
        let limit = self.limit.filter(|_| curve.role.is_judged() && curve.alpha.is_some())?;
        let is_at_port = curve.role == Role::JudgedAtPort;
        if is_at_port || !curve.poles.is_empty() || self.clearance() <= 0.0 {
            return None;
        }
        let margin = |(theta, value): (f64, (f64, f64))| {
            let (size, angle) = (value.0.hypot(value.1), value.1.atan2(value.0));
            // Clockwise from where it is to the lower end of the line's chord.
            let from = if angle > 0.0 { angle } else { angle + 2.0 * PI };
            let to = PI + (limit / size).acos();
            let turn = (from - to).rem_euclid(2.0 * PI);
            (size >= limit).then_some((turn, theta, value))
        };
        curve.points().filter_map(margin).min_by(|a, b| a.0.total_cmp(&b.0))
    }
}

fn limit_name(scene: &Scene, assessment: &Assessment, limit: Option<f64>) -> &'static str {
    let near = |value: f64| limit.is_some_and(|limit| (limit / value - 1.0).abs() < 1e-9);
    let anticogs = scene.environment.parts().anticogging.is_some();
    match scene.coupling {
        _ if near(assessment.delta.midpoint()) && anticogs => "-delta, less that of [anticogging]",
        _ if near(assessment.delta.midpoint()) => "-delta",
        Coupling::Spring { stiffness } if near(0.5 * stiffness * scene.timing.period) => {
            "-K T/2 of the coupling"
        }
        _ if scene.latency.total_jitter() > 0.0 => "-limit, output delay varies",
        _ => "-limit, updates missed",
    }
}

fn is_judged_at_port(scene: &Scene) -> bool {
    !scene.latency.is_none() || scene.coupling == Coupling::Matched
}

/// The controller with delay, amplifier and sensor: `H g - D abs(H)^2 / (4 delta)` of equation 38. Times that
/// lie in a range have their middle, and jitter is left out.
struct PortCurve {
    controller: Response,
    response: SampledResponse,
    path: Response,
    period: f64,
    delta: f64,
}

impl PortCurve {
    /// `None` where two lags are too similar for their difference.
    fn of(scene: &Scene, controller: Transfer) -> Option<Self> {
        let Latency { actuator_lag, sensor_lag, actuator_updates, .. } = scene.latency;
        let period = Interval::decimal(scene.timing.period);
        let [mut delay, actuator, sensor] =
            [scene.latency.torque_delay(), actuator_lag, sensor_lag]
                .map(|time| Interval::decimal(time.middle()).div(period));
        if actuator_updates > 0 {
            delay = scene.latency.delay_in_updates(scene.timing.period)?;
        }
        let (lags, between) = ([actuator, sensor], scene.latency.is_between_updates());
        // Beside a sensor filter the curve is that of the continuous lag.
        let updates = scene.latency.judged_updates();
        let response = LagIntervals { delay, lags, updates, between }.response(0)?;
        Some(Self {
            controller: Response::new(controller),
            path: Response::new(response.transfer(period)),
            response,
            period: scene.timing.period,
            delta: context_beside_anticogging::<Environment>(scene, Format::F64).passivity,
        })
    }

    fn at(&self, theta: f64) -> Complex<f64> {
        let controller = self.controller.at_angle(theta);
        let ripple = self.response.ripple_at(theta.cos()).midpoint() * self.period.powi(2);
        let unseen = ripple * controller.norm_sqr() / (4.0 * self.delta);
        controller * self.path.at_angle(theta) - unseen
    }

    fn curve(&self, deciding: Option<Interval>) -> Curve {
        // Delay and lags add no pole on the circle or outside of it.
        let velocity = self.controller.from_velocity(self.period);
        Curve::through(Role::JudgedAtPort, &velocity, &|theta| self.at(theta), deciding, None)
    }
}

/// The curve between the poles, with more points around its least real part.
fn branches(
    poles: &[UnitCirclePole],
    lowest: Option<f64>,
    point: impl Fn(f64) -> (f64, f64),
) -> Vec<Branch> {
    let inner = poles.iter().map(|pole| pole.theta).filter(|theta| *theta > 0.0 && *theta < PI);
    let cuts: Vec<_> = [0.0].into_iter().chain(inner).chain([PI]).collect();
    let between = |pair: &[f64]| {
        let mut angles: Vec<f64> = angles(pair[0], pair[1]).collect();
        let (first, last) = (angles[0], angles[angles.len() - 1]);
        angles.extend(around(lowest).filter(|theta| first < *theta && *theta < last));
        angles.sort_by(f64::total_cmp);
        angles.dedup();
        let values = angles.iter().copied().map(&point).collect();
        Branch { angles, values }
    };
    cuts.windows(2).map(between).collect()
}

/// Angles from one to another, logarithmic towards both.
fn angles(from: f64, to: f64) -> impl Iterator<Item = f64> {
    let length = to - from;
    let half = move |index: usize| {
        (NEAREST / PI).powf(1.0 - index as f64 / (POINTS / 2) as f64) * 0.5 * length
    };
    let up = (0..POINTS / 2).map(move |index| from + half(index));
    let down = (0..=POINTS / 2).rev().map(move |index| from + length - half(index));
    up.chain(down).chain((to == PI).then_some(PI))
}

/// An angle, and others on both sides of it, each 1.4 times as far away as the one before.
fn around(theta: Option<f64>) -> impl Iterator<Item = f64> {
    theta.into_iter().flat_map(|theta| {
        let step = |index: i32| 1e-9 * 1.4_f64.powi(index);
        let beside = (0..AROUND_LEAST).flat_map(move |i| [theta - step(i), theta + step(i)]);
        beside.chain([theta])
    })
}

#[cfg(test)]
mod tests;
