//! The enclosures are the same bits in the compiler and on the host, for every reference case.
//!
//! A transcendental function, a fused multiply-add or an extended register anywhere on the way would make
//! them differ, and a certificate checked at compile time would differ from the board's.

// One constant more or less: the cases are judged one by one.
#![allow(long_running_const_eval)]
// Their decimals have more digits than a double, as a person may well write them.
#![allow(clippy::excessive_precision)]

use haptic_servo::certificate::{Assessment, assess};
use haptic_servo::environment::{Coefficients, Environment, Rational};
use haptic_servo::scene::{Coupling, Device, Latency, Scene, Timing};
use std::hint::black_box;

include!(concat!(env!("OUT_DIR"), "/vectors.rs"));

const fn coefficients(descending: &[f64]) -> Coefficients {
    match Coefficients::new(descending) {
        Some(coefficients) => coefficients,
        None => panic!("more coefficients than a scene can hold"),
    }
}

const fn scene(
    period: f64,
    delta: f64,
    coupling: Option<f64>,
    numerator: &[f64],
    denominator: &[f64],
) -> Scene {
    Scene {
        device: Device { inertia: 2.2e-5, damping: delta, passivity: Some(delta) },
        timing: Timing { period, worst_period: None },
        coupling: match coupling {
            Some(stiffness) => Coupling::Spring { stiffness },
            None => Coupling::Rigid,
        },
        environment: Environment::Rational(Rational {
            numerator: coefficients(numerator),
            denominator: coefficients(denominator),
            delay: 0,
            unit_zeros: 0,
        }),
        latency: Latency::NONE,
        torque_limit: None,
    }
}

/// All numbers are equal to the bit, which their texts show. And the constants of the build script
/// are the cases of the file, and not something else.
#[test]
fn constants_are_the_bits_of_the_host() {
    let cases = tests::vectors::all();
    assert_eq!(CASES.len(), cases.len());
    for (case, (name, scene, constant)) in cases.iter().zip(CASES) {
        assert_eq!((&*case.name, case.scene()), (*name, *scene));
        let here = assess(black_box(scene));
        // Debug tells signed zeros apart.
        assert_eq!(format!("{constant:?}"), format!("{here:?}"), "{name}");
    }
    let indices = CASES.iter().filter(|(.., constant)| constant.alpha.is_some()).count();
    assert!(indices > 50, "only {indices} cases have an index");
}
