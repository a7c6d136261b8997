//! How much an error can become: norms of impulse responses.

use firmware::certificate::Loop;
use firmware::environment::{Environment, Rational};
use firmware::number::Format;
use firmware::passivity::polynomial::Polynomial;
use firmware::scene::Scene;

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

/// How much positions that are off by 1 rad each, and errors of the numbers of a rational
/// environment, move the torque of the whole controller in N m.
#[derive(Clone, Copy, Debug)]
pub struct Errors {
    /// Of positions.
    pub position: f64,
    /// Of numbers, within a turn of zero.
    pub numbers: f64,
}

impl Errors {
    /// Of a rational environment that may be unstable by itself, where that is behind a coupling
    /// that makes a stable controller of it: what rounds in its sums then comes out through that.
    pub fn of(scene: &Scene, format: Format, bound: f64) -> Option<Self> {
        let Environment::Rational(Rational { numerator, .. }) = &scene.environment else {
            return None;
        };
        let controller = Loop::in_format(scene, format).ok()?.controller;
        let over = ascending(&controller.numerator, controller.ones, controller.minus_ones)?;
        let under = ascending(&controller.denominator, 0, 0)?;
        let position = l1(&over, &under)? * controller.scale.midpoint().abs();
        let leading = *under.last()?;
        let alone = l1(&[leading], &under)?;
        let gains: f64 = numerator.as_slice().iter().map(|c| c.abs()).sum();
        let largest = bound + gains * std::f64::consts::TAU;
        let step = match format {
            Format::F64 => largest * f64::EPSILON,
            Format::F32 => largest * f64::from(f32::EPSILON),
            Format::Fixed { fraction_bits } | Format::Truncated { fraction_bits } => {
                0.5_f64.powi(i32::try_from(fraction_bits).ok()?)
            }
        };
        // Four roundings a degree and a tick, none more than a step.
        let sections = 4.0 * f64::from(u32::try_from(under.len()).ok()?);
        Some(Self { position, numbers: step * (sections * alone + position) })
    }
}
