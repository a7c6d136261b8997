//! Line search for the angle that minimises a function: a grid, then golden sections.

/// Grid points at which the function is evaluated before the search closes in.
const GRID: usize = 32;

/// Steps of the search: a minimum's angle is known to the square root of `f64`'s resolution.
const REFINEMENTS: usize = 40;

/// Ranges so narrow, in rad, need no search.
const NARROW: f64 = 1e-9;

/// Only over ranges wider than this, in rad, can a function count as constant.
const WIDE: f64 = 1.0;

/// Differences of the function below this part of its size are rounding.
const FLAT: f64 = 1e-9;

/// Smallest angle at which the function is evaluated: near enough to 0 to stand for the limit, far enough for
/// `z - 1`, where a pole or a zero may sit, to have digits.
const NEAR_ZERO: f64 = 1e-3;

/// The angle between `from` and `to` (rad, from 0 to pi) at which `function` is least; `None`
/// where the function is the same on the whole circle.
pub fn minimizing_angle(function: impl Fn(f64) -> f64, from: f64, to: f64) -> Option<f64> {
    if to - from < NARROW {
        return Some(0.5 * (from + to));
    }
    let start = from.max(NEAR_ZERO).min(to);
    let at = |index: usize| start + (to - start) * index as f64 / GRID as f64;
    let values: Vec<f64> = (0..=GRID).map(|index| function(at(index))).collect();
    let lower = |a: &(f64, f64), b: &(f64, f64)| a.1.total_cmp(&b.1);
    let highest = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let (best, lowest) = values.iter().copied().enumerate().min_by(|a, b| a.1.total_cmp(&b.1))?;
    if to - from > WIDE && highest - lowest <= FLAT * highest.abs().max(lowest.abs()) {
        return None;
    }
    let inner = golden_section(&function, at(best.saturating_sub(1)), at((best + 1).min(GRID)));
    let ends = [(start, values[0]), (to, values[GRID]), (inner, function(inner))];
    let found = ends.into_iter().min_by(lower)?.0;
    // The search stops short of the end by its own resolution.
    Some(if found < start + 1e-2 * NEAR_ZERO { from } else { found })
}

/// The middle of the last of the brackets that close in on a minimum.
fn golden_section(function: impl Fn(f64) -> f64, mut low: f64, mut high: f64) -> f64 {
    const PART: f64 = 0.618_033_988_749_894_9;
    let inner = |low: f64, high: f64| (high - PART * (high - low), low + PART * (high - low));
    let (mut a, mut b) = inner(low, high);
    let (mut at_a, mut at_b) = (function(a), function(b));
    for _ in 0..REFINEMENTS {
        if at_a < at_b {
            (high, b, at_b) = (b, a, at_a);
            a = inner(low, high).0;
            at_a = function(a);
        } else {
            (low, a, at_a) = (a, b, at_b);
            b = inner(low, high).1;
            at_b = function(b);
        }
    }
    0.5 * (low + high)
}

#[cfg(test)]
mod tests {
    use super::minimizing_angle;
    use std::f64::consts::PI;

    #[test]
    fn inside_at_the_ends_and_nowhere() {
        let inside = minimizing_angle(|theta| (theta - 1.0).powi(2), 0.0, PI).unwrap();
        assert!((inside - 1.0).abs() < 1e-7);
        assert_eq!(minimizing_angle(f64::cos, 0.0, PI), Some(PI));
        assert_eq!(minimizing_angle(|theta| -theta.cos(), 0.0, PI), Some(0.0));
        assert_eq!(minimizing_angle(|_| 3.0, 0.0, PI), None);
    }
}
