//! Scenes that oscillated although they had been certified once: each was accepted by a rule that was
//! wrong, and shows the rule's error.

use haptic_servo::environment::{Coefficients, Environment, Rational, Wall};
use haptic_servo::scene::{Coupling, Device, Latency, Scene, Timing};

/// A name; the scene; and the same for a certificate that cancels the common factors of numerator and
/// denominator.
pub type RefutedScene = (&'static str, Scene, Option<Scene>);

/// The device of the paper in a scene.
fn scene(coupling: f64, environment: Environment) -> Scene {
    Scene {
        device: Device { inertia: 2.2e-5, damping: 0.022, passivity: None },
        timing: Timing { period: 0.001, worst_period: None },
        coupling: Coupling::Spring { stiffness: coupling },
        environment,
        latency: Latency::NONE,
        torque_limit: None,
    }
}

fn rational(numerator: &[f64], denominator: &[f64]) -> Environment {
    let coefficients = |c| Coefficients::new(c).expect("at most eight poles");
    Environment::Rational(Rational {
        numerator: coefficients(numerator),
        denominator: coefficients(denominator),
        delay: 1,
        unit_zeros: 0,
    })
}

/// A rational environment without its delay, times `z - 1`.
fn at_rest(environment: Environment) -> Environment {
    let Environment::Rational(rational) = environment else { return environment };
    Environment::Rational(Rational { delay: 0, unit_zeros: 1, ..rational })
}

/// All values.
pub fn all() -> Vec<RefutedScene> {
    let damper = |k, b, n| Wall::damped(k, b, n).alone();
    let refuted = |name, scene| (name, scene, None);
    let hidden = |name, numerator: &[f64], denominator: &[f64]| {
        let scene_of = |numerator, denominator| scene(44.0, rational(numerator, denominator));
        (name, scene_of(numerator, denominator), Some(scene_of(&[3.0], &[1.0])))
    };
    let jitters = |name, delay, jitter, lag, coupling, environment| {
        let latency = Latency { output_jitter: jitter, ..Latency::delayed(delay) };
        let latency = latency.with_actuator_lag(lag);
        let torque_limit = (coupling != Coupling::Rigid).then_some(1.0);
        let scene = scene(44.0, environment);
        refuted(name, Scene { latency, coupling, torque_limit, ..scene })
    };
    // A controller with poles at 0.7 and -0.98, the first of which falls, in units of `delta / T`.
    let crossing = [-0.258, -0.3234].map(|c| c * 0.867553 * 22.0);
    let crossing = at_rest(rational(&crossing, &[1.0, 0.28, -0.686]));
    let spring = |stiffness| Coupling::Spring { stiffness };
    let eight = [1.0, 8.0, 28.0, 56.0, 70.0, 56.0, 28.0, 8.0, 1.0];
    let four = [1.0, 4.0, 6.0, 4.0, 1.0];
    let twice = Timing { period: 0.001, worst_period: Some(0.002) };
    let stiff = scene(440.0, damper(220.0, 0.1, 1));
    vec![
        hidden("hidden (z + 1)^8", &eight.map(|c| 3.0 * c), &eight),
        hidden("hidden (z + 1)^4", &four.map(|c| 3.0 * c), &four),
        refuted(
            "missed updates on a latched board",
            Scene { timing: twice, torque_limit: Some(10.0), ..scene(22.0, damper(17.6, 0.0, 1)) },
        ),
        refuted(
            "a fade that locks a stable environment",
            scene(
                15.18928491811924,
                rational(
                    &[23.357999126350556, -20.47686704234059, 4.600034751214648],
                    &[1.0, -1.713866599225222, 0.7990916544878318],
                ),
            ),
        ),
        refuted(
            "a fade that locks an unstable environment",
            scene(4.4, rational(&[2.42, 0.0], &[1.0, -1.05])),
        ),
        jitters(
            "jitter and lag behind the matched coupling",
            1e-4,
            1e-4,
            2e-5,
            Coupling::Matched,
            damper(29.5, 0.0, 1),
        ),
        jitters(
            "little jitter behind the matched coupling",
            1e-5,
            1e-6,
            0.0,
            Coupling::Matched,
            damper(42.5, 0.0, 1),
        ),
        jitters("jitter across counts", 1e-3, 3e-4, 0.0, Coupling::Rigid, crossing),
        jitters(
            "jitter behind a coupling spring",
            1e-4,
            1e-4,
            0.0,
            spring(6.0),
            damper(5.6, 0.0, 1),
        ),
        refuted("half of the damping to spare", scene(44.0, damper(22.0, 0.0, 1))),
        refuted("more than all of the damping to spare", scene(44.0, damper(1000.0, 0.0, 0))),
        refuted(
            "more passivity than a rigid device has damping",
            Scene {
                device: Device { inertia: 2.2e-5, damping: 0.022, passivity: Some(0.22) },
                ..stiff
            },
        ),
    ]
}
