//! How much an error can become: norms of impulse responses.

use haptic_servo::certificate::LoopTransfers;
use haptic_servo::environment::{
    Canceller, Environment, FULL_SCALE, Parts, Profile, Rational, Wall,
};
use haptic_servo::number::Format;
use haptic_servo::passivity::polynomial::Polynomial;
use haptic_servo::scene::{Coupling, Scene};

/// Samples after which a response is said not to end.
const LONGEST: usize = 1 << 16;

/// Powers that a controller has at most.
const TAPS: usize = 40;

/// Sum of the magnitudes of the impulse response of `numerator / denominator`, in ascending powers;
/// `None` where it does not end.
fn l1(numerator: &[f64], denominator: &[f64]) -> Option<f64> {
    let degree = denominator.len().max(numerator.len());
    if degree > TAPS {
        return None;
    }
    let leading = *denominator.last()?;
    // In powers of 1/z, from the first that is there: a delay changes nothing.
    let tap = |p: &[f64], i: usize| {
        p.len().checked_sub(1 + i).and_then(|at| p.get(at)).copied().unwrap_or(0.0) / leading
    };
    let mut past = [0.0; TAPS];
    let mut sum = 0.0;
    for k in 0..LONGEST {
        let mut output = tap(numerator, k);
        for i in 1..degree {
            output -= tap(denominator, i) * past[(k + TAPS - i) % TAPS];
        }
        past[k % TAPS] = output;
        sum += output.abs();
        if k > degree && past.iter().take(TAPS.min(k)).all(|y| y.abs() <= 1e-15 * sum) {
            return sum.is_finite().then_some(sum);
        }
    }
    None
}

fn ascending(p: &Polynomial, ones: i32, minus_ones: i32) -> Option<Vec<f64>> {
    let mut product: Vec<f64> = (0..p.len()).map(|i| p.coefficient(i).midpoint()).collect();
    for (root, count) in [(1.0, ones), (-1.0, minus_ones)] {
        for _ in 0..u32::try_from(count).ok()? {
            let mut next = vec![0.0; product.len() + 1];
            for (i, c) in product.iter().enumerate() {
                next[i + 1] += c;
                next[i] -= root * c;
            }
            product = next;
        }
    }
    Some(product)
}

/// A number of this size, rounded, is off by at most so much.
fn rounding(format: Format, size: f64) -> f64 {
    match format {
        Format::F64 => size * 0.5 * f64::EPSILON,
        Format::F32 => size * 0.5 * f64::from(f32::EPSILON),
        Format::Fixed { fraction_bits } | Format::Truncated { fraction_bits } => {
            0.5_f64.powi(i32::try_from(fraction_bits).unwrap_or(0))
        }
    }
}

/// Compliances of a scene's coupling in rad/(N m), all together, or more: the matched coupling has one for
/// each period and part of a period that a torque takes.
pub fn compliance(scene: &Scene) -> f64 {
    let (period, latency) = (scene.timing.period, &scene.latency);
    match scene.coupling {
        Coupling::Rigid => 0.0,
        Coupling::Spring { stiffness } => 1.0 / stiffness,
        Coupling::Matched => {
            let delay = latency.torque_delay().most / period;
            let lags = (latency.actuator_lag.most + latency.sensor_lag.most) / period;
            let jitter = (4.0 + 2.0 * delay) * latency.output_jitter / period;
            0.75 * period / scene.device.passivity() * (2.0 + delay + lags + jitter)
        }
    }
}

/// The steepest slope of a profile in N m/rad, or more.
pub fn slope(profile: &Profile) -> f64 {
    let outline = profile.outline();
    let step = f64::from(outline.rise.max(outline.fall)) / f64::from(FULL_SCALE);
    let table = profile.torque.abs() * step * profile.knots_per_rad();
    let layout = profile.layout();
    // A line to a snap point half a pitch or more away.
    let line = profile.snap.map_or(0.0, |snap| 4.0 * profile.torque.abs() / snap.pitch(&layout));
    let ends = profile.ends.map_or(0.0, |ends| ends.stiffness);
    (table + line).max(ends)
}

/// Parts of a profile's cell: its positions are whole parts.
const PARTS: f64 = 16384.0;

/// Bounds on the errors of any environment behind any coupling.
#[derive(Clone, Copy, Debug)]
pub struct General {
    /// Of its torques, in N m, within a turn of zero.
    pub numbers: f64,
    /// Of its positions, in rad.
    pub off: f64,
}

/// How much positions that are off, and errors of the numbers, move a torque in N m.
#[derive(Clone, Copy, Debug)]
pub struct Errors {
    /// Of positions that are off by 1 rad each.
    pub position: f64,
    /// Of numbers, within a turn of zero.
    pub numbers: f64,
}

impl Errors {
    /// With positions that are off by so much, in rad.
    pub fn over(self, step: f64) -> Self {
        Self { position: self.position * step, ..self }
    }

    /// All of it.
    pub fn sum(&self) -> f64 {
        self.position + self.numbers
    }

    /// The errors of an environment that is passive wherever it is: positions that are off move it, and cost
    /// what it turns them into by its torques. `None` of a rational environment.
    pub fn general(scene: &Scene, format: Format, bound: f64) -> Option<General> {
        let profile = scene.environment.profile();
        let parts = profile.map_or(0.0, |profile| 1.0 / (PARTS * profile.knots_per_rad()));
        let off = parts + 4.0 * rounding(format, std::f64::consts::TAU + compliance(scene) * bound);
        let numbers = match Self::alone(scene, format, bound) {
            Some(alone) => alone.numbers,
            None => Self::through(scene, format, bound)?.numbers,
        };
        Some(General { numbers, off })
    }

    /// The torque of the environment, at the position where it is: a wall that switches or is
    /// clipped included. `None`: of another environment.
    pub fn alone(scene: &Scene, format: Format, bound: f64) -> Option<Self> {
        let Environment::Parts(Parts { canceller, wall, profile, drag, anticogging: None }) =
            &scene.environment
        else {
            return None;
        };
        let period = scene.timing.period;
        let compliance = compliance(scene);
        // A state follows by the share `rate` of the rest, and no closer than rounding allows.
        let washout = |damping: f64, rate: f64| {
            let gain = 2.0 * damping.abs() / period;
            (gain, gain / rate)
        };
        let of_wall = |w: &Wall| {
            let (gain, state) = washout(w.damping(), 1.0 - w.filter().unwrap_or(0.0));
            (w.stiffness.abs() + gain, w.stiffness.abs() + state)
        };
        let of_canceller = |canceller: &Canceller| {
            let cancelled = scene.device.damping - canceller.residual;
            let rate = 1.0 / (1.0 + (cancelled * compliance / period).max(0.0));
            washout(cancelled, rate)
        };
        let of_profile = |profile: &Profile| {
            let gain = slope(profile) + 2.0 * profile.damping().abs() / period;
            (gain, gain)
        };
        let parts = [
            canceller.as_ref().map(of_canceller),
            wall.as_ref().map(of_wall),
            profile.as_ref().map(of_profile),
            drag.as_ref().map(|drag| washout(drag.damping, 1.0)),
        ]
        .map(Option::unwrap_or_default);
        let position = parts.iter().map(|part| part.0).sum();
        let states: f64 = parts.iter().map(|part| part.1).sum();
        let angle = rounding(format, std::f64::consts::TAU + compliance * bound);
        let numbers = 4.0 * states * angle + 8.0 * rounding(format, bound);
        Some(Self { position, numbers })
    }

    /// The torque of the whole controller, of a rational environment that may be unstable by
    /// itself behind a coupling that makes a stable controller of it: what rounds in its sums comes
    /// out through that. `None`: of another environment, or without a bound.
    pub fn through(scene: &Scene, format: Format, bound: f64) -> Option<Self> {
        let Environment::Rational(Rational { numerator, .. }) = &scene.environment else {
            return None;
        };
        let controller = LoopTransfers::in_format(scene, format).ok()?.controller;
        let over = ascending(&controller.numerator, controller.ones, controller.minus_ones)?;
        let under = ascending(&controller.denominator, 0, 0)?;
        let position = l1(&over, &under)? * controller.scale.midpoint().abs();
        let leading = *under.last()?;
        let alone = l1(&[leading], &under)?;
        let gains: f64 = numerator.as_slice().iter().map(|c| c.abs()).sum();
        let step = rounding(format, bound + gains * std::f64::consts::TAU);
        // Four roundings a degree and a tick.
        let sections = 4.0 * f64::from(u32::try_from(under.len()).ok()?);
        let angle = rounding(format, std::f64::consts::TAU);
        Some(Self { position, numbers: 2.0 * step * sections * alone + 4.0 * angle * position })
    }
}
