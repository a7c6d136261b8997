//! What motion takes through a current loop, against eigenvalues of the operator from velocity to torque.
//!
//! The firmware's bound comes from the winding's energy between two instants (theory, section 15.8). Here the
//! operator is a matrix between the aliases of a frequency, and its smallest eigenvalue is computed.

use std::f64::consts::TAU;

use haptic_servo::current::{B_G431B_ESC1, CurrentLoop, Drive, Motor, Supply, Winding};
use haptic_servo::encoder::CounterWidth;
use haptic_servo::servo::Transducers;
use nalgebra::{Complex, DMatrix};

const INSTANT: f64 = 25e-6;
const INDUCTANCE: f64 = 0.3e-3;
const TORQUE_CONSTANT: f64 = 0.05;

/// Aliases to either side: fewer of them leave an eigenvalue larger than it is.
const ALIASES: i32 = 30;

/// The loop of a winding with `R h/L` and a gain `K` of the feedback.
fn design(ratio: f64, feedback: f64, winding: Winding) -> CurrentLoop {
    let motor = Motor {
        winding,
        resistance: ratio * INDUCTANCE / INSTANT,
        inductance: INDUCTANCE,
        torque_constant: TORQUE_CONSTANT,
    };
    let drive = Drive {
        motor,
        supply: Supply::sinking(24.0, 25.0),
        bandwidth: -(-feedback).ln_1p() / (TAU * INSTANT),
        largest_temperature: 80.0,
    };
    let transducers = Transducers {
        counts_per_turn: 16_384.0,
        counter: CounterWidth::Bits16,
        full_scale_torque: 0.002,
        largest_speed: 10.0,
    };
    CurrentLoop::design(&drive, &B_G431B_ESC1, &transducers, 1e-3).unwrap()
}

/// Smallest eigenvalue, at an angle, of the Hermitian part of the operator from the voltage of the motion to the
/// current against it, in `h/L`.
fn smallest(ratio: f64, feedback: f64, theta: f64) -> f64 {
    let (one, j) = (Complex::new(1.0, 0.0), Complex::new(0.0, 1.0));
    let z = Complex::from_polar(1.0, theta);
    let a = (-ratio).exp();
    let b = (1.0 - a) / ratio;
    let sensitivity = z * (z - one) / (z * (z - one) + feedback);
    let control = (z - a) * (feedback / b) / (z - one);
    let angles: Vec<f64> = (-ALIASES..=ALIASES).map(|k| theta + TAU * f64::from(k)).collect();
    let row: Vec<Complex<f64>> = angles.iter().map(|&w| one / (ratio + j * w)).collect();
    let hold = |w: f64| (one - (-j * w).exp()) / (j * w);
    let column: Vec<Complex<f64>> =
        angles.iter().zip(&row).map(|(&w, &y)| hold(w) * y * control * sensitivity / z).collect();
    let entry = |m: usize, n: usize| {
        let diagonal = if m == n { row[m] } else { Complex::new(0.0, 0.0) };
        diagonal - column[m] * row[n]
    };
    let size = angles.len();
    // A Hermitian matrix as a symmetric one of twice the size.
    let symmetric = DMatrix::from_fn(2 * size, 2 * size, |m, n| {
        let (i, k) = (m % size, n % size);
        let part = 0.5 * (entry(i, k) + entry(k, i).conj());
        match (m < size, n < size) {
            (true, true) | (false, false) => part.re,
            (true, false) => -part.im,
            (false, true) => part.im,
        }
    });
    symmetric.symmetric_eigenvalues().min()
}

#[test]
fn no_eigenvalue_is_below_the_bound() {
    for ratio in [0.02, 0.1, 0.3, 1.0, 3.0] {
        for feedback in [0.02, 0.1, 0.25] {
            let loss = design(ratio, feedback, Winding::Brushed).motion_loss()
                / (TORQUE_CONSTANT * TORQUE_CONSTANT * INSTANT / INDUCTANCE);
            for theta in [1e-3, 0.03, 0.2, 0.5, 1.0, 1.5, 2.0, 2.6, 3.1] {
                let least = smallest(ratio, feedback, theta);
                assert!(least >= -loss, "{ratio}, {feedback}, {theta}: {least} of {loss}");
            }
        }
    }
}

#[test]
fn the_bound_is_reached_at_low_frequencies() {
    for (ratio, feedback) in [(0.1, 0.1), (0.1, 0.25), (0.3, 0.25)] {
        let least = smallest(ratio, feedback, 1e-3) * 4.0 * 3_f64.sqrt();
        assert!((-1.0..-0.95).contains(&least), "{ratio}, {feedback}: {least}");
    }
}

#[test]
fn the_loss_is_that_of_the_formula_and_two_thirds_of_it_with_three_phases() {
    let formula = TORQUE_CONSTANT * TORQUE_CONSTANT * INSTANT / (4.0 * 3_f64.sqrt() * INDUCTANCE);
    let loss = |winding| design(0.1, 0.2, winding).motion_loss();
    let brushed = loss(Winding::Brushed);
    assert!(brushed >= formula && brushed < formula * (1.0 + 1e-12), "{brushed}, {formula}");
    let brushless = loss(Winding::Brushless { pole_pairs: 7 }) / formula * 1.5;
    assert!((1.0..1.0 + 1e-12).contains(&brushless), "{brushless}");
}

/// The bound does not cover a winding that has settled long before the next instant.
#[test]
fn no_loss_is_known_of_a_winding_without_inductance() {
    assert_eq!(design(20.0, 0.2, Winding::Brushed).motion_loss(), f64::INFINITY);
}
