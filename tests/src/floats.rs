//! Floating-point numbers that break things: random bits, and the edges of the format.

use rand::Rng;

/// Edges: zeros, subnormals, the largest, and NaN.
const EDGES: [f64; 14] = [
    0.0,
    -0.0,
    1.0,
    -1.0,
    f64::MIN_POSITIVE,
    -f64::MIN_POSITIVE,
    5e-324,
    -5e-324,
    f64::MAX,
    f64::MIN,
    f64::EPSILON,
    f64::NAN,
    f64::INFINITY,
    f64::NEG_INFINITY,
];

/// Any `f64` at all.
pub fn any(rng: &mut impl Rng) -> f64 {
    match rng.random_range(0..4) {
        0 => EDGES[rng.random_range(0..EDGES.len())],
        1 => f64::from_bits(rng.random()),
        2 => f64::from(rng.random_range(-1000..=1000)) / 8.0,
        _ => {
            let exponent = rng.random_range(-12..12);
            rng.random_range(-10.0..10.0) * 10.0_f64.powi(exponent)
        }
    }
}

/// Any finite `f64`.
pub fn any_finite(rng: &mut impl Rng) -> f64 {
    loop {
        let x = any(rng);
        if x.is_finite() {
            return x;
        }
    }
}
