//! Environments whose poles crowd at `z = 1`, as those of low-pass filters far below the Nyquist frequency
//! do, in coefficients that are doubles: the exact reference agrees, and almost all of them are decided.

use std::f64::consts::PI;

use haptic_servo::certificate::{Rejection, assess};
use haptic_servo::environment::{Environment, Rational};
use haptic_servo::passivity::poles::strictly_schur;
use haptic_servo::passivity::polynomial::Polynomial;
use haptic_servo::scene::Coupling;
use nalgebra::Complex;
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use tests::agreement;
use tests::poly::Poly;
use tests::scenes::{ExactScene, Frame, log_uniform, multiply};

const SCENES: u64 = 60;

/// Descending coefficients of a real polynomial with these roots and their conjugates, in doubles.
fn with_roots(roots: &[Complex<f64>]) -> Vec<f64> {
    roots.iter().fold(vec![1.0], |product, root| {
        let factor = match root.im == 0.0 {
            true => vec![1.0, -root.re],
            false => vec![1.0, -2.0 * root.re, root.norm_sqr()],
        };
        multiply(&product, &factor)
    })
}

/// Poles of a Butterworth filter whose cutoff is this part of the Nyquist frequency.
fn butterworth(order: usize, cutoff: f64) -> Vec<Complex<f64>> {
    let tangent = (0.5 * PI * cutoff).tan();
    (0..order.div_ceil(2))
        .map(|k| {
            let angle = 0.5 * PI * (1.0 + (2 * k + 1) as f64 / order as f64);
            let is_real = 2 * k + 1 == order;
            let s = if is_real {
                Complex::new(-tangent, 0.0)
            } else {
                Complex::from_polar(tangent, angle)
            };
            (1.0 + s) / (1.0 - s)
        })
        .collect()
}

fn scene(frame: &Frame, numerator: &[f64], denominator: &[f64]) -> ExactScene {
    let rational = Rational::of(numerator, denominator).expect("at most eight poles are drawn");
    frame.with(Environment::Rational(rational), (Poly::of(numerator), Poly::of(denominator)))
}

#[test]
fn low_pass_filters_far_below_the_nyquist_frequency_are_decided() {
    let (mut passed, mut failed) = (0, 0);
    for seed in 0..SCENES {
        let rng = &mut ChaCha8Rng::seed_from_u64(seed);
        let mut frame = Frame::draw(rng);
        if rng.random_bool(0.5) {
            frame.coupling = Coupling::Rigid;
        }
        let order = rng.random_range(4..=8);
        let cutoff = log_uniform(rng, 0.02, 0.1);
        let denominator = with_roots(&butterworth(order, cutoff));
        // Gain at rest, and zeros at -1.
        let gain = frame.unit() * cutoff * log_uniform(rng, 0.1, 3.0);
        let zeros = with_roots(&vec![Complex::new(-1.0, 0.0); order]);
        let size = gain * denominator.iter().sum::<f64>() / zeros.iter().sum::<f64>();
        let numerator: Vec<f64> = zeros.iter().map(|zero| size * zero).collect();
        let drawn = scene(&frame, &numerator, &denominator);
        let assessment = assess(&drawn.scene);
        agreement::check(&assessment, &drawn.exact)
            .unwrap_or_else(|why| panic!("seed {seed}: {why} {:?}", drawn.scene));
        let found =
            assessment.alpha.unwrap_or_else(|| panic!("seed {seed}: order {order} at {cutoff}"));
        // Decimals leave this much, of eight poles at a fiftieth of the Nyquist frequency.
        let width = agreement::relative_width(found);
        assert!(width < 2e-3, "seed {seed}: order {order} at {cutoff}, {width}");
        *(if assessment.outcome.is_ok() { &mut passed } else { &mut failed }) += 1;
        assert!(!matches!(assessment.outcome, Err(Rejection::Undecided { .. })));
    }
    println!("passed={passed} failed={failed}");
    assert!(passed > SCENES / 6 && failed > SCENES / 6, "{passed} {failed}");
}

/// Poles crowd inside of the circle or across it; proofs agree with rationals.
#[test]
fn crowded_roots_are_inside_where_that_is_proved() {
    let (mut inside, mut outside, mut open) = (0, 0, 0);
    for seed in 0..400 {
        let rng = &mut ChaCha8Rng::seed_from_u64(seed);
        let count = rng.random_range(2..=4);
        let size = log_uniform(rng, 0.01, 0.3);
        let roots: Vec<_> = (0..count)
            .map(|_| {
                let s = Complex::from_polar(
                    size * rng.random_range(0.3..1.0),
                    PI * rng.random_range(0.48..1.0),
                );
                (1.0 + s) / (1.0 - s)
            })
            .collect();
        let coefficients = with_roots(&roots);
        let truly = tests::remainders::is_schur(&Poly::of(&coefficients));
        match strictly_schur(&Polynomial::descending(&coefficients, false)) {
            Ok(()) => assert!(truly, "seed {seed}: {coefficients:?}"),
            Err(error) if truly => {
                open += 1;
                assert!(!format!("{error:?}").contains("Unstable"), "seed {seed}: {error:?}");
            }
            Err(_) => {}
        }
        *(if truly { &mut inside } else { &mut outside }) += 1;
    }
    println!("inside={inside} outside={outside} open={open}");
    assert!(inside > 200 && outside > 20 && open < inside / 20, "{inside} {outside} {open}");
}
