//! The compiler judges a constant as the host does, bit for bit; `emulated.rs` compares the board with both.
//!
//! A transcendental function, a fused multiply-add or an extended register anywhere on the way would make
//! them differ, and a certificate checked at compile time would differ from the board's.

// A case takes the compiler seconds.
#![allow(long_running_const_eval)]

use std::hint::black_box;

use haptic_servo::certificate::{Assessment, assess};
use haptic_servo::environment::{Canceller, Environment, Rational, Wall};
use haptic_servo::scene::{Coupling, Device, Latency, Scene};

const PROMPT: Scene = Scene {
    coupling: Coupling::Spring { stiffness: 40.0 },
    ..Scene::of(
        Device::damped(2.2e-5, 0.022),
        0.001,
        Wall::damped(9.0, 0.004, 1).filtered(0.3).alone(),
    )
};

/// A pair of poles inside of the circle, and one at 1 that a zero cancels.
const FILTER: Environment = Environment::Rational(Rational {
    delay: 2,
    unit_zeros: 1,
    ..Rational::of(&[3.0, -1.7, 0.6], &[1.0, -1.1, 0.37]).expect("few coefficients")
});

/// Scenes with the compiler's judgement.
macro_rules! judged {
    ($($scene:expr),* $(,)?) => {
        [$(($scene, const { assess(&$scene) })),*]
    };
}

#[test]
fn constants_are_the_bits_of_the_host() {
    let cases: [(Scene, Assessment); 5] = judged![
        PROMPT,
        Scene { environment: FILTER, ..PROMPT },
        Scene { environment: Canceller::to(0.01).alone(), coupling: Coupling::Rigid, ..PROMPT },
        Scene { latency: Latency::delayed(1e-5).with_actuator_lag(53e-6), ..PROMPT },
        Scene {
            latency: Latency { output_jitter: 1e-5, ..Latency::delayed(1e-4) },
            coupling: Coupling::Matched,
            torque_limit: Some(1.0),
            ..PROMPT
        },
    ];
    for (scene, constant) in &cases {
        let here = assess(black_box(scene));
        // Debug tells signed zeros apart.
        assert_eq!(format!("{constant:?}"), format!("{here:?}"), "{scene:?}");
    }
    let [indices, at_port] = [
        cases.iter().filter(|(_, constant)| constant.alpha_coupled.is_some()).count(),
        cases.iter().filter(|(_, constant)| constant.alpha_port.is_some()).count(),
    ];
    assert!(indices > 2 && at_port > 0, "{indices} {at_port}");
}
