//! Roots in floating point: a pole at a distance of a millionth from the circle, with other poles near it.

use haptic_servo::environment::Environment;
use nalgebra::Complex;

use super::setting::*;
use crate::stability::{eigenvalues, radius};
use crate::studies::tradeoff::certificate::environments::multiply;
use crate::studies::tradeoff::certificate::polynomials::companion;

/// Distance of the pole from the circle: 2^-20, so that every coefficient is a double.
pub const BESIDE: f64 = 1.0 / (1 << 20) as f64;
/// Distance of the four other poles from the circle, inside.
pub const OTHERS: f64 = 1.0 / (1 << 8) as f64;

/// A pole outside the circle that computed roots show inside.
pub fn outside() -> Result<CaseResult, StudyError> {
    evaluate(1.0 + BESIDE)
}

/// The same pole inside, shown outside.
pub fn inside() -> Result<CaseResult, StudyError> {
    evaluate(1.0 - BESIDE)
}

/// A smooth filter of the fifth order before a spring, with these poles.
pub fn scene(pole: f64) -> Scene {
    rigid(PADDLE, Environment::Rational(rational(&[1e-12], &denominator(pole))))
}

/// `(z - pole) (z - (1 - OTHERS))^4` in descending powers, without rounding.
pub fn denominator(pole: f64) -> Vec<f64> {
    let roots = [pole, 1.0 - OTHERS, 1.0 - OTHERS, 1.0 - OTHERS, 1.0 - OTHERS];
    roots.into_iter().fold(vec![1.0], |product, root| multiply(&product, &[1.0, -root]))
}

fn evaluate(pole: f64) -> Result<CaseResult, StudyError> {
    let scene = scene(pole);
    let companion = companion(&denominator(pole));
    let plain: Vec<Complex<f64>> = companion.complex_eigenvalues().iter().copied().collect();
    let root = "outermost root of the denominator";
    let balanced = eigenvalues(&companion)?;
    let methods = vec![
        MethodResult::modulus("companion matrix", root, radius(&plain)),
        MethodResult::modulus("companion matrix, balanced", root, radius(&balanced)),
    ];
    let growth = growth(pole);
    let reason = "factor by factor its output is {} of what it was, 2^20 samples later";
    let truth = MethodResult::new("its response", MethodVerdict::of(growth < 1.0), growth, reason);
    Ok(CaseResult::of(&scene, methods, truth, []))
}

/// The change of the filter's impulse response over 2^20 samples, after its four fast poles have decayed;
/// computed factor by factor, each exact to one rounding per sample.
fn growth(pole: f64) -> f64 {
    const LATER: usize = 1 << 20;
    let mut states = [0.0; 5];
    let mut run = |samples: usize, mut input: f64| {
        for _ in 0..samples {
            for (state, root) in states.iter_mut().zip([1.0 - OTHERS; 4].into_iter().chain([pole]))
            {
                *state = root * *state + std::mem::replace(&mut input, 0.0);
                input = *state;
            }
            input = 0.0;
        }
        states[4]
    };
    let early = run(1 << 16, 1.0);
    run(LATER, 0.0) / early
}
