//! Least squares with coefficients that are not negative, by the active-set method of Lawson and Hanson.

use nalgebra::{DMatrix, DVector};

/// Gradients below this part of the largest are rounding.
const TOLERANCE: f64 = 1e-12;

/// The `x >= 0` with the least `|a x - b|`. Columns of `a` should have about the same size.
///
/// Ends after three exchanges for each column: the best so far, should a degenerate problem go round in
/// circles.
pub(super) fn nnls(a: &DMatrix<f64>, b: &DVector<f64>) -> DVector<f64> {
    let mut x = DVector::zeros(a.ncols());
    let mut passive: Vec<usize> = Vec::new();
    let enough = TOLERANCE * a.tr_mul(b).amax();
    let mut exchanges = 3 * a.ncols();
    loop {
        let gradient = a.tr_mul(&(b - a * &x));
        let steepest = (0..a.ncols())
            .filter(|column| !passive.contains(column))
            .max_by(|&i, &j| gradient[i].total_cmp(&gradient[j]));
        let Some(entering) = steepest.filter(|&column| gradient[column] > enough) else { return x };
        if passive.len() >= a.nrows() {
            return x;
        }
        passive.push(entering);
        loop {
            let Some(solved) = restricted(a, b, &passive) else { return x };
            if exchanges == 0 {
                return x;
            }
            exchanges -= 1;
            let blocked = |(&column, &value): (&usize, &f64)| {
                (value <= 0.0).then(|| x[column] / (x[column] - value))
            };
            let step = passive.iter().zip(&solved).filter_map(blocked).reduce(f64::min);
            let share = step.filter(|step| step.is_finite()).unwrap_or(f64::from(step.is_none()));
            for (&column, &value) in passive.iter().zip(&solved) {
                x[column] += share * (value - x[column]);
            }
            if step.is_none() {
                break;
            }
            let before = passive.len();
            let kept = |&column: &usize, x: &DVector<f64>| x[column] > f64::EPSILON * x.amax();
            passive.retain(|column| kept(column, &x));
            for column in 0..x.len() {
                if !passive.contains(&column) {
                    x[column] = 0.0;
                }
            }
            if passive.is_empty() || passive.len() == before {
                return x;
            }
        }
    }
}

/// Least squares in some of the columns, of any sign.
fn restricted(a: &DMatrix<f64>, b: &DVector<f64>, columns: &[usize]) -> Option<Vec<f64>> {
    let qr = a.select_columns(columns).qr();
    let solved = qr.r().solve_upper_triangular(&qr.q().tr_mul(b))?;
    solved.iter().all(|value| value.is_finite()).then(|| solved.iter().copied().collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Necessary and sufficient: no coefficient that could still fall or rise makes it better.
    #[test]
    fn the_conditions_of_karush_kuhn_and_tucker_hold() {
        let mut state = 1_u64;
        let mut next = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            (state >> 33) as f64 / f64::from(1_u32 << 30) - 1.0
        };
        for (rows, columns) in [(3, 2), (5, 5), (6, 20), (12, 60)] {
            for _ in 0..20 {
                let a = DMatrix::from_fn(rows, columns, |_, _| next());
                let b = DVector::from_fn(rows, |_, _| next());
                let x = nnls(&a, &b);
                let gradient = a.tr_mul(&(&b - &a * &x));
                for (value, slope) in x.iter().zip(&gradient) {
                    assert!(*value >= 0.0 && *slope <= 1e-9, "{value} {slope}");
                    assert!(*value == 0.0 || slope.abs() < 1e-9, "{value} {slope}");
                }
            }
        }
    }
}
