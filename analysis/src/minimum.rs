//! Where a function of an angle is least.

use std::f64::consts::PI;

/// Points at which the function is looked at before the search closes in.
const GRID: usize = 64;

/// Halvings of the bracket that are more than `f64` can tell apart.
const REFINEMENTS: usize = 60;

/// Differences of the function below this part of its size are rounding.
const FLAT: f64 = 1e-9;

/// Nearest to 0 that the function is looked at: near enough to stand for the limit, far enough for
/// `z - 1`, where a pole or a zero may sit, to have digits.
const NEAR_ZERO: f64 = 1e-3;

/// The angle between `from` and `to` (rad, from 0 to pi) at which `function` is least; `None`
/// where the function is the same on the whole circle.
pub fn least(function: impl Fn(f64) -> f64, from: f64, to: f64) -> Option<f64> {
    if is_flat(&function) {
        return None;
    }
    let start = from.max(NEAR_ZERO).min(to);
    let at = |index: usize| start + (to - start) * index as f64 / GRID as f64;
    let lower = |&a: &f64, &b: &f64| function(a).total_cmp(&function(b));
    let best = (0..=GRID).min_by(|&a, &b| lower(&at(a), &at(b)))?;
    let (mut low, mut high) = (at(best.saturating_sub(1)), at((best + 1).min(GRID)));
    for _ in 0..REFINEMENTS {
        let (a, b) = (low + 0.382 * (high - low), low + 0.618 * (high - low));
        if function(a) < function(b) { high = b } else { low = a }
    }
    let found = [start, to, 0.5 * (low + high)].into_iter().min_by(lower)?;
    // The search stops short of the end by its own resolution.
    Some(if found < start + 1e-2 * NEAR_ZERO { from } else { found })
}

fn is_flat(function: impl Fn(f64) -> f64) -> bool {
    let at = |index: usize| NEAR_ZERO + (PI - NEAR_ZERO) * index as f64 / GRID as f64;
    let (mut lowest, mut highest) = (f64::INFINITY, f64::NEG_INFINITY);
    for value in (0..=GRID).map(|index| function(at(index))) {
        (lowest, highest) = (lowest.min(value), highest.max(value));
    }
    highest - lowest <= FLAT * lowest.abs().max(highest.abs())
}

#[cfg(test)]
mod tests {
    use super::least;
    use std::f64::consts::PI;

    #[test]
    fn inside_at_the_ends_and_nowhere() {
        let inside = least(|theta| (theta - 1.0).powi(2), 0.0, PI).unwrap();
        assert!((inside - 1.0).abs() < 1e-7);
        assert_eq!(least(f64::cos, 0.0, PI), Some(PI));
        assert_eq!(least(|theta| -theta.cos(), 0.0, PI), Some(0.0));
        assert_eq!(least(|_| 3.0, 0.0, PI), None);
    }
}
