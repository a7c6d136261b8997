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
use haptic_servo::passivity::interval::Interval;
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

fn bits(interval: Option<Interval>) -> Option<(u64, u64)> {
    interval.map(|i| (i.lo().to_bits(), i.hi().to_bits()))
}

#[test]
fn constants_are_the_bits_of_the_host() {
    assert_eq!(CASES.len(), tests::vectors::all().len());
    let mut indices = 0;
    for (name, scene, constant) in CASES {
        let here = assess(black_box(scene));
        assert_eq!(bits(constant.alpha), bits(here.alpha), "{name}: alpha");
        assert_eq!(bits(constant.alpha_coupled), bits(here.alpha_coupled), "{name}: coupled");
        assert_eq!(bits(constant.cos_theta), bits(here.cos_theta), "{name}: angle");
        assert_eq!(bits(Some(constant.delta)), bits(Some(here.delta)), "{name}: delta");
        assert_eq!(*constant, here, "{name}");
        indices += u32::from(here.alpha.is_some());
    }
    assert!(indices > 50, "only {indices} cases have an index");
}

/// The constants of the build script are the cases of the file, and not something else.
#[test]
fn constants_are_the_cases_of_the_file() {
    for (case, (name, scene, _)) in tests::vectors::all().iter().zip(CASES) {
        assert_eq!(case.name, *name);
        assert_eq!(case.scene(), *scene);
    }
}
