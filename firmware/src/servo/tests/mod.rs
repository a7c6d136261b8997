//! The servo as a whole: against another computation of the same loops, between its formats, at
//! its limits.

mod ahead;
mod as_it_runs;
mod reference;
mod robustness;

use fixed::FixedI32;
use fixed::types::extra::{U16, U20};
use proptest::prelude::*;
use reference::{Reference, impulse_response};

use super::*;
use crate::encoder::CounterWidth;
use crate::environment::*;
use crate::scene::{Coupling, Device, Latency};

const TRANSDUCERS: Transducers = Transducers::of(61_440.0, 1.0);
const TICKS: usize = 150;

/// The paper's device behind the standard coupling.
const fn scene<E>(environment: E) -> Scene<E> {
    crate::test_scene::scene(environment)
}

/// A hand that pushes in, holds, trembles and comes back: counts, at most about 0.2 rad.
fn hand() -> impl Iterator<Item = i32> {
    (0..3000_i32).map(|k| {
        let t = f64::from(k) * 1e-3;
        (1200.0 * (3.0 * t).sin() + 700.0 * (11.0 * t).sin() + 40.0 * (150.0 * t).sin()) as i32
    })
}

fn wall() -> impl Strategy<Value = Wall> {
    let parameters = (0.1..1.0_f64, 0.0..0.9_f64, 0..=8_usize, proptest::option::of(0.1..0.9_f64));
    (parameters, -0.1..0.1_f64, any::<bool>()).prop_map(
        |((size, share, delay, filter), face, one_sided)| {
            // The bound K T (n - 1/2) + B of the certificate, below delta = 0.022.
            let index = 0.022 * size;
            let stiffness = index * (1.0 - share) / (1e-3 * (delay as f64 - 0.5).abs());
            let damper = Some(Damper { damping: index * share, filter });
            let side = if one_sided { Side::Face(face) } else { Side::Displaced(face) };
            Wall { stiffness, damper, side, delay }
        },
    )
}

/// A wall with an undelayed canceller.
fn free_mode_wall(residual: f64, wall: Wall) -> Environment {
    Parts { canceller: Some(Canceller::to(residual)), wall: Some(wall), ..Parts::NONE }.sum()
}

fn rational() -> impl Strategy<Value = Rational> {
    let degree = 1..=MAX_DEGREE;
    degree.prop_flat_map(|degree| {
        let poles = proptest::collection::vec(-0.5..0.8_f64, degree);
        let numerator = proptest::collection::vec(-0.5..0.5_f64, 1..=degree);
        (poles, numerator, 0..=2_usize).prop_map(|(poles, numerator, delay)| {
            let mut denominator = vec![2.0];
            for pole in poles {
                let shifted = denominator.clone();
                denominator.push(0.0);
                for (d, s) in denominator.iter_mut().skip(1).zip(shifted) {
                    *d -= pole * s;
                }
            }
            Rational {
                numerator: Coefficients::new(&numerator).unwrap(),
                denominator: Coefficients::new(&denominator).unwrap(),
                delay,
                unit_zeros: 1,
            }
        })
    })
}

fn environment() -> impl Strategy<Value = Environment> {
    let residual = 0.002..0.022_f64;
    prop_oneof![
        wall().prop_map(|wall| Wall { damper: None, ..wall }.alone()),
        wall().prop_map(Wall::alone),
        (residual.clone(), 0..=4_usize)
            .prop_map(|(residual, delay)| Canceller { residual, delay }.alone()),
        (residual, wall()).prop_map(|(residual, wall)| free_mode_wall(residual, wall)),
        (wall(), -0.01..0.01_f64, 0..=4_usize).prop_map(|(wall, damping, delay)| {
            let drag = Some(Drag::of(damping, delay));
            Parts { wall: Some(wall), drag, ..Parts::NONE }.sum()
        }),
        rational().prop_map(Environment::Rational),
    ]
}

fn coupling() -> impl Strategy<Value = Coupling> {
    let spring = (20.0..60.0_f64).prop_map(|stiffness| Coupling::Spring { stiffness });
    prop_oneof![Just(Coupling::Spring { stiffness: 44.0 }), spring, Just(Coupling::Rigid)]
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 400, ..ProptestConfig::default() })]
    #[test]
    fn torques_are_those_of_the_whole_past(
        environment in environment(),
        coupling in coupling(),
        torque_limit in proptest::option::of(0.05..1.0_f64),
        steps in proptest::collection::vec(-150..150_i32, TICKS),
    ) {
        let scene = Scene { coupling, torque_limit, ..scene(environment) };
        let limit = torque_limit.unwrap_or(TRANSDUCERS.full_scale_torque);
        // Some cannot be certified, or have no coefficients; every scene that can be built must
        // be right, except that an unbounded loop loses its digits.
        let Ok(mut servo) = Servo::<_, f64>::build(&scene, &TRANSDUCERS) else { return Ok(()) };
        let mut reference = Reference::new(&scene, limit, TICKS);
        let mut count = 0;
        for step in steps {
            count += step - count / 16;
            servo.tick(RawCount::from(count));
            let expected = reference.tick(servo.angle_rad());
            let error = (servo.torque_nm() - expected).abs();
            prop_assert!(error <= 1e-8, "{} for {expected}", servo.torque_nm());
        }
    }
}

#[test]
fn free_mode_is_equation_23() {
    let (b, residual, period) = (0.022, 0.001, 1e-3);
    let be = b - residual;
    let numerator = [-2.0 * b * be, 2.0 * b * be];
    let denominator = [period * (3.0 * b - residual), -period * (b - residual)];
    let response = impulse_response(&numerator, &denominator, 3000);
    let scene = scene(Canceller { residual, delay: 0 }.alone());
    let certified = scene.certify().unwrap();
    let mut servo: Servo<_, f64> = Servo::new(&certified, &TRANSDUCERS).unwrap();
    let mut positions = Vec::new();
    for count in hand() {
        servo.tick(RawCount::from(count));
        positions.push(servo.angle_rad() - servo.torque_nm() / 44.0);
        let torque: f64 = positions.iter().rev().zip(&response).map(|(x, e)| x * e).sum();
        assert!((torque - servo.torque_nm()).abs() < 1e-12);
    }
}
