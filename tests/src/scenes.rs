//! Random linear scenes, each twice: as the firmware's data and as exact numbers.
//!
//! Every number is a short binary fraction. Its `f64`, its decimal text and its rational are then
//! the same number, and a disagreement with the reference is never one of input rounding.

use crate::exact::{Q, q};
use crate::poly::Poly;
use crate::rules::Exact;
use haptic_servo::environment::{Canceller, Damper, Drag, Environment, Parts, Rational, Wall};
use haptic_servo::scene::{Coupling, Device, Scene};
use num_traits::{One, Zero};
use rand::Rng;
use std::f64::consts::PI;

/// A scene in both forms.
#[derive(Clone, Debug)]
pub struct ExactScene {
    /// What the firmware judges.
    pub scene: Scene,
    /// What the reference judges.
    pub exact: Exact,
}

/// `x` to the nearest multiple of `2^-bits`.
pub fn short(x: f64, bits: i32) -> f64 {
    let scale = 2.0_f64.powi(bits);
    (x * scale).round() / scale
}

/// A number whose logarithm is uniform between two ends.
pub fn log_uniform(rng: &mut impl Rng, lo: f64, hi: f64) -> f64 {
    (rng.random_range(lo.ln()..hi.ln())).exp()
}

/// Device, period and coupling, before there is an environment.
#[derive(Clone, Copy, Debug)]
pub struct Frame {
    /// Device passivity in N m s/rad.
    pub delta: f64,
    /// Period in s.
    pub period: f64,
    /// Coupling.
    pub coupling: Coupling,
}

impl Frame {
    /// A period near a millisecond; a coupling that is rigid, standard, softer or stiffer.
    pub fn draw(rng: &mut impl Rng) -> Self {
        let period = 2.0_f64.powi(-rng.random_range(8..=13));
        let delta = short(log_uniform(rng, 0.01, 2.0), 16);
        let standard = 2.0 * delta / period;
        let stiffness = match rng.random_range(0..4) {
            0 => return Self { delta, period, coupling: Coupling::Rigid },
            1 => standard,
            2 => short(standard * log_uniform(rng, 0.05, 1.0), 20),
            _ => short(standard * log_uniform(rng, 1.0, 20.0), 20),
        };
        Self { delta, period, coupling: Coupling::Spring { stiffness } }
    }

    /// The spring `delta / T`, natural unit of stiffness.
    pub fn unit(&self) -> f64 {
        self.delta / self.period
    }

    /// The scene with a sum of these.
    pub fn with_parts(&self, parts: Parts) -> ExactScene {
        let Parts { canceller, wall, drag, .. } = parts;
        let fractions = [
            canceller.map(|canceller| free_fraction(&canceller, self)),
            wall.map(|wall| wall_fraction(&wall, self.period)),
            drag.map(|drag| drag_fraction(&drag, self.period)),
        ];
        let sum = fractions.into_iter().flatten().reduce(|a, b| sum_of(&a, &b));
        self.with(parts.sum(), sum.expect("at least one part"))
    }

    /// The scene with an environment, and its exact transfer function.
    pub fn with(&self, environment: Environment, fraction: (Poly, Poly)) -> ExactScene {
        let Self { delta, period, coupling } = *self;
        ExactScene {
            scene: Scene {
                coupling,
                ..Scene::of(Device::damped(1e-4, delta), period, environment)
            },
            exact: Exact {
                numerator: fraction.0,
                denominator: fraction.1,
                period: q(period),
                delta: q(delta),
                coupling: match coupling {
                    Coupling::Matched => unreachable!("not drawn"),
                    Coupling::Rigid => None,
                    Coupling::Spring { stiffness } => Some(q(stiffness)),
                },
            },
        }
    }
}

/// A pole radius is `1 - gap`; how small the gap may be.
#[derive(Clone, Copy, Debug)]
pub struct Poles {
    /// Largest number of poles.
    pub count: usize,
    /// Smallest distance from the circle.
    pub nearest: f64,
    /// Longest delay on top.
    pub delay: usize,
}

/// A random rational environment, scaled so that its index lies within a factor of about three of
/// the device's passivity.
pub fn rational(rng: &mut impl Rng, poles: Poles) -> ExactScene {
    let frame = Frame::draw(rng);
    let count = rng.random_range(1..=poles.count);
    let denominator = rounded(
        &polynomial(rng, count, 0.5, |rng, _| 1.0 - log_uniform(rng, poles.nearest, 1.0)),
        44,
    );
    let zeros = rng.random_range(0..=count);
    let mut numerator: Vec<f64> = (0..=zeros).map(|_| rng.random_range(-1.0..1.0)).collect();
    let delay = if rng.random_bool(0.5) { 0 } else { rng.random_range(0..=poles.delay) };
    if sum(&numerator) * sum(&denominator) < 0.0 && rng.random_bool(0.95) {
        numerator.iter_mut().for_each(|c| *c = -*c);
    }
    let size = least_real(&numerator, &denominator, delay).abs().max(0.05);
    let wanted = frame.unit() * log_uniform(rng, 0.3, 3.0) / size;
    numerator.iter_mut().for_each(|c| *c *= wanted);
    let numerator = rounded(&numerator, 24);
    data(&frame, &numerator, &denominator, delay)
}

fn data(frame: &Frame, numerator: &[f64], denominator: &[f64], delay: usize) -> ExactScene {
    let rational = Rational::of(numerator, denominator).expect("at most eight poles are drawn");
    let environment = Environment::Rational(Rational { delay, ..rational });
    frame.with(environment, (Poly::of(numerator), Poly::of(denominator).raised(delay)))
}

fn rounded(coefficients: &[f64], bits: i32) -> Vec<f64> {
    coefficients.iter().map(|&c| short(c, bits)).collect()
}

fn sum(coefficients: &[f64]) -> f64 {
    coefficients.iter().sum()
}

/// Descending coefficients of a monic polynomial with `count` roots, whose radius may depend on how many there
/// are already. This share of the real ones is negative.
pub fn polynomial<R: Rng>(
    rng: &mut R,
    count: usize,
    negative: f64,
    radius: impl Fn(&mut R, usize) -> f64,
) -> Vec<f64> {
    let mut product = vec![1.0];
    while product.len() <= count {
        let radius = radius(rng, product.len() - 1);
        let pair = product.len() < count && rng.random_bool(0.6);
        let factor = if pair {
            vec![1.0, -2.0 * radius * rng.random_range(0.0..PI).cos(), radius * radius]
        } else {
            vec![1.0, if rng.random_bool(negative) { radius } else { -radius }]
        };
        product = multiply(&product, &factor);
    }
    product
}

/// The product of two polynomials.
pub fn multiply(a: &[f64], b: &[f64]) -> Vec<f64> {
    let mut product = vec![0.0; a.len() + b.len() - 1];
    for (i, x) in a.iter().enumerate() {
        for (j, y) in b.iter().enumerate() {
            product[i + j] += x * y;
        }
    }
    product
}

/// A rough `min Re (z / (z - 1)) E` on a grid, to scale by; never to judge by.
fn least_real(numerator: &[f64], denominator: &[f64], delay: usize) -> f64 {
    use nalgebra::Complex;
    let horner = |c: &[f64], z: Complex<f64>| c.iter().fold(Complex::ZERO, |s, &c| s * z + c);
    let grid = (1..400).map(|i| f64::from(i) * PI / 400.0);
    let real = grid.map(|theta| {
        let z = Complex::from_polar(1.0, theta);
        let shift = Complex::from_polar(1.0, -theta * f64::from(u32::try_from(delay).unwrap_or(0)));
        (z / (z - 1.0) * shift * horner(numerator, z) / horner(denominator, z)).re
    });
    real.fold(f64::INFINITY, f64::min)
}

/// Transfer function of a wall: `z^-n (K + B q / T)`, the velocity through `(1 - a) / (1 - a / z)`.
fn wall_fraction(wall: &Wall, period: f64) -> (Poly, Poly) {
    let a = wall.filter().map_or_else(Q::zero, q);
    let (k, b, t) = (q(wall.stiffness), q(wall.damping()) * (Q::one() - &a), q(period));
    let pole = Poly::ascending(vec![-a, Q::one()]);
    let spring = pole.scaled(&(k * &t));
    let damper = Poly::integers(&[-1, 1]).scaled(&b);
    (spring.plus(&damper), pole.scaled(&t).raised(wall.delay))
}

/// Transfer function of the free mode, `E = C / (1 - C V)` for `C = -be q / T`.
fn free_fraction(canceller: &Canceller, frame: &Frame) -> (Poly, Poly) {
    let (be, t) = (q(frame.delta - canceller.residual), q(frame.period));
    let compliance = match frame.coupling {
        Coupling::Rigid => Q::zero(),
        Coupling::Matched => unreachable!("not drawn"),
        Coupling::Spring { stiffness } => Q::one() / q(stiffness),
    };
    let step = Poly::integers(&[-1, 1]).scaled(&be);
    let numerator = step.scaled(&-Q::one());
    let denominator = Poly::ascending(vec![Q::zero(), t]).plus(&step.scaled(&compliance));
    (numerator, denominator.raised(canceller.delay))
}

/// Transfer function of a drag, `z^-n B q / T`.
fn drag_fraction(drag: &Drag, period: f64) -> (Poly, Poly) {
    let step = Poly::integers(&[-1, 1]).scaled(&q(drag.damping));
    (step, Poly::ascending(vec![Q::zero(), q(period)]).raised(drag.delay))
}

/// Sum of two fractions.
pub fn sum_of(a: &(Poly, Poly), b: &(Poly, Poly)) -> (Poly, Poly) {
    (a.0.times(&b.1).plus(&b.0.times(&a.1)), a.1.times(&b.1))
}

/// A wall with a random stiffness, damping, filter and delay, near what the device allows.
pub fn wall(rng: &mut impl Rng) -> ExactScene {
    let frame = Frame::draw(rng);
    let delay = rng.random_range(0..=8);
    let stiffness = short(frame.unit() * log_uniform(rng, 0.02, 4.0), 16);
    let mut wall = Wall::spring(stiffness, delay);
    if !rng.random_bool(0.3) {
        let sign = if rng.random_bool(0.8) { 1.0 } else { -1.0 };
        let damping = short(sign * frame.delta * log_uniform(rng, 0.01, 2.0), 24);
        let filter = rng.random_bool(0.4).then(|| short(rng.random_range(0.0..0.98), 20));
        wall.damper = Some(Damper { damping, filter });
    }
    frame.with_parts(Parts { wall: Some(wall), ..Parts::NONE })
}

/// A free mode, with or without a wall behind it.
pub fn free(rng: &mut impl Rng) -> ExactScene {
    let frame = Frame::draw(rng);
    let residual = short(frame.delta * rng.random_range(-0.2..1.0), 24);
    if rng.random_bool(0.5) {
        let delay = rng.random_range(0..=2);
        let canceller = Some(Canceller { residual, delay });
        return frame.with_parts(Parts { canceller, ..Parts::NONE });
    }
    let stiffness = short(frame.unit() * log_uniform(rng, 0.02, 2.0), 16);
    let damping = short(frame.delta * log_uniform(rng, 0.01, 1.0), 24);
    let wall = Wall::damped(stiffness, damping, rng.random_range(0..=2));
    let canceller = Some(Canceller::to(residual));
    frame.with_parts(Parts { canceller, wall: Some(wall), ..Parts::NONE })
}

/// A drag with a wall, a free mode, both or nothing beside it.
pub fn dragging(rng: &mut impl Rng) -> ExactScene {
    let frame = Frame::draw(rng);
    let sign = if rng.random_bool(0.7) { 1.0 } else { -1.0 };
    let damping = short(sign * frame.delta * log_uniform(rng, 0.01, 1.0), 24);
    let drag = Some(Drag::of(damping, rng.random_range(0..=4)));
    let canceller = rng
        .random_bool(0.3)
        .then(|| Canceller::to(short(frame.delta * rng.random_range(0.3..1.0), 24)));
    let wall = rng.random_bool(0.7).then(|| {
        let stiffness = short(frame.unit() * log_uniform(rng, 0.02, 2.0), 16);
        let damping = short(frame.delta * log_uniform(rng, 0.01, 0.5), 24);
        let wall = Wall::damped(stiffness, damping, rng.random_range(0..=4));
        if rng.random_bool(0.3) {
            wall.filtered(short(rng.random_range(0.0..0.9), 20))
        } else {
            wall
        }
    });
    frame.with_parts(Parts { canceller, wall, drag, ..Parts::NONE })
}

/// Any of the above; rational environments have up to three poles, none nearer the circle than
/// 0.02, so that the closed loop's eigenvalues are well conditioned.
pub fn any(rng: &mut impl Rng) -> ExactScene {
    match rng.random_range(0..5) {
        0 => wall(rng),
        1 => free(rng),
        2 => dragging(rng),
        _ => rational(rng, Poles { count: 3, nearest: 0.02, delay: 2 }),
    }
}
