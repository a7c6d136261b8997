//! Ten thousand environments with known verdicts, drawn from a seed.
//!
//! They are drawn with exact sums, products and halvings only, so that every machine draws the same. Their
//! indices were found in rational arithmetic by the package `tests`, which checks them and can find them
//! again (`tests/tests/all/reference.rs`); this takes minutes, so the file `indices.f64` contains them. The
//! passivity of the device is set close to the index, so that the right verdict is known.

use std::ops::Range;

use fastrand::Rng;
use haptic_servo::words;

/// Period in s of all environments: a power of two, so that divisions are exact.
pub const PERIOD: f64 = 1.0 / 1024.0;
/// Environments of each kind.
pub const EACH: usize = 2500;
/// Passivity in N m s/rad of a device whose environment has no index, or a negative one.
const SPARE: f64 = 16.0;
/// One of this many environments has no index: its spring is negative, or a pole is outside the circle.
const ODD: usize = 32;
/// Binary places of the coefficients.
const PLACES: i32 = 44;

words! {
    /// The kinds of environments.
    Kind {
    /// Springs and walls, one to three samples late, with an index by formula.
    Walls "walls that have a formula",
    /// One to six poles at least a hundredth inside of the circle.
    Inside "poles well inside of the circle",
    /// A pair of poles a millionth to a thousandth from the circle, so that the minimum is narrow.
    Narrow "poles 1e-3 to 1e-6 from the circle",
    /// As `Inside`, on a device whose passivity differs from the index by a fraction of `1e-3` to `1e-12`.
    Border "devices 1e-3 to 1e-12 beside the border",
    }
}

/// `E(z) = z^-delay numerator(z) / denominator(z)`, position to torque, descending powers.
#[derive(Clone, Debug, PartialEq)]
pub struct Environment {
    /// Numerator.
    pub numerator: Vec<f64>,
    /// Denominator, of the same degree or a greater one.
    pub denominator: Vec<f64>,
    /// Additional samples of delay.
    pub delay: usize,
    /// Stiffness in N m/rad and damping in N m s/rad, if it is a wall.
    pub wall: Option<(f64, f64)>,
    /// Passivity of the device over the index.
    ratio: f64,
}

impl Environment {
    /// The passivity of its device in N m s/rad, given its index.
    pub fn delta(&self, alpha: Option<f64>) -> f64 {
        alpha.filter(|alpha| *alpha > 0.0).map_or(SPARE, |alpha| self.ratio * alpha)
    }

    /// Whether that device is passive with it, given its index.
    pub fn is_passive(&self, alpha: Option<f64>) -> bool {
        alpha.is_some_and(|alpha| alpha < self.delta(Some(alpha)))
    }
}

/// The indices `alpha` in N m s/rad of all environments, kind by kind, as little-endian doubles, each within
/// one place of the exact index, NaN if there is none.
const INDICES: &[[u8; 8]; Kind::ALL.len() * EACH] =
    include_bytes!("indices.f64").as_chunks().0.as_array().expect("an index for each environment");

/// The index of an environment.
pub fn reference_index(kind: Kind, number: usize) -> Option<f64> {
    let alpha = f64::from_le_bytes(INDICES[kind as usize * EACH + number]);
    (!alpha.is_nan()).then_some(alpha)
}

/// An environment by its kind and its number below [`EACH`].
pub fn environment(kind: Kind, number: usize) -> Environment {
    let rng = &mut Rng::with_seed((kind as usize * EACH + number) as u64);
    let beside = match kind {
        Kind::Border => 10..40,
        _ => 1..9,
    };
    let ratio = 1.0 + part(rng, beside);
    let ratio = if rng.bool() { ratio } else { 1.0 / ratio };
    let drawn = match kind {
        Kind::Walls => wall(rng),
        Kind::Inside => rational(rng, 0.0),
        Kind::Narrow => narrow(rng),
        Kind::Border => rational(rng, 1.0 / ODD as f64),
    };
    Environment { ratio, ..drawn }
}

/// `2^-k (1 + u)`: all magnitudes equally likely.
fn part(rng: &mut Rng, halvings: Range<u32>) -> f64 {
    (1.0 + rng.f64()) * 0.5_f64.powi(rng.u32(halvings) as i32)
}

fn wall(rng: &mut Rng) -> Environment {
    let stiffness = f64::from(rng.u32(1..4096)) * 0.25;
    let damping = if rng.usize(..5) == 0 { 0.0 } else { f64::from(rng.u32(1..1024)) / 1024.0 };
    let slope = damping / PERIOD;
    Environment {
        numerator: vec![stiffness + slope, -slope],
        denominator: vec![1.0, 0.0],
        delay: rng.usize(1..4),
        wall: Some((stiffness, damping)),
        ratio: 1.0,
    }
}

/// One to six poles, and in a fraction `outside` of them another pole outside the circle.
fn rational(rng: &mut Rng, outside: f64) -> Environment {
    let count = rng.usize(1..7);
    let mut denominator = polynomial(rng, count);
    if rng.f64() < outside {
        let pole = 1.0 + part(rng, 4..20);
        denominator = multiply(&denominator, &[1.0, if rng.bool() { pole } else { -pole }]);
    }
    let zeros = rng.usize(0..denominator.len());
    let numerator = (0..=zeros).map(|_| 2.0 * rng.f64() - 1.0).collect();
    finished(rng, numerator, denominator)
}

/// Poles and, in every second environment, zeros at the same distance from the circle beside them: a notch.
fn narrow(rng: &mut Rng) -> Environment {
    let (cosine, gap) = (2.0 * rng.f64() - 1.0, part(rng, 10..20));
    let side = if rng.usize(..ODD) == 0 { 1.0 } else { -1.0 };
    let others = rng.usize(0..4);
    let rest = polynomial(rng, others);
    let denominator = multiply(&rest, &pair(1.0 + side * gap, cosine));
    let zeros = rng.usize(0..=others);
    let random: Vec<f64> = (0..=zeros).map(|_| 2.0 * rng.f64() - 1.0).collect();
    let numerator = match rng.bool() {
        true => random,
        false => multiply(&random, &pair(1.0 - 8.0 * gap * part(rng, 1..7), cosine)),
    };
    finished(rng, numerator, denominator)
}

/// Adds a positive spring, except in a few, and rounds the coefficients.
fn finished(rng: &mut Rng, mut numerator: Vec<f64>, denominator: Vec<f64>) -> Environment {
    let pushes = numerator.iter().sum::<f64>() * denominator.iter().sum::<f64>() < 0.0;
    if pushes && rng.usize(..ODD) != 0 {
        numerator.iter_mut().for_each(|value| *value = -*value);
    }
    let round = |values: Vec<f64>| values.into_iter().map(short).collect();
    let numerator: Vec<f64> = round(numerator);
    Environment {
        numerator: numerator.into_iter().map(|value| value / PERIOD).collect(),
        denominator: round(denominator),
        delay: if rng.bool() { 0 } else { rng.usize(0..5) },
        wall: None,
        ratio: 1.0,
    }
}

/// Descending coefficients of a polynomial with `count` roots, at least a hundredth inside the circle.
fn polynomial(rng: &mut Rng, count: usize) -> Vec<f64> {
    let mut product = vec![1.0];
    while product.len() <= count {
        let radius = 1.0 - 0.5 * part(rng, 1..7);
        let factor = match product.len() < count && rng.bool() {
            true => pair(radius, 2.0 * rng.f64() - 1.0).to_vec(),
            false => vec![1.0, if rng.bool() { radius } else { -radius }],
        };
        product = multiply(&product, &factor);
    }
    product
}

fn pair(radius: f64, cosine: f64) -> [f64; 3] {
    [1.0, -2.0 * radius * cosine, radius * radius]
}

/// The product of two polynomials, of which each is ascending or each is descending.
pub fn multiply(a: &[f64], b: &[f64]) -> Vec<f64> {
    let mut product = vec![0.0; a.len() + b.len() - 1];
    for (i, x) in a.iter().enumerate() {
        for (j, y) in b.iter().enumerate() {
            product[i + j] += x * y;
        }
    }
    product
}

fn short(value: f64) -> f64 {
    let scale = 2_f64.powi(PLACES);
    (value * scale).round() / scale
}
