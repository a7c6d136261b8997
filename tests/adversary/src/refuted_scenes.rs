//! Scenes that oscillated although they had been certified once: each was accepted by a rule that was
//! wrong, and shows the rule's error.

use haptic_servo::environment::{Coefficients, Environment, Rational, Wall};
use haptic_servo::scene::{Coupling, Device, Latency, Scene, Timing};

/// One of them.
#[derive(Clone, Copy, Debug)]
pub struct RefutedScene {
    /// What it was accepted in spite of.
    pub name: &'static str,
    /// The scene.
    pub scene: Scene,
    /// What it is to a certificate that cancels what its numerator and denominator have in common.
    pub judged_as: Option<Scene>,
}

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

/// A wall that pulls, too.
pub const fn wall(stiffness: f64, damping: f64, delay: usize) -> Wall {
    Wall { stiffness, damping, filter: None, delay, face: 0.0, one_sided: false }
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

/// All values.
pub fn all() -> Vec<RefutedScene> {
    let damper = |k, b, n| Environment::DamperWall(wall(k, b, n));
    let refuted = |name, scene| RefutedScene { name, scene, judged_as: None };
    let hidden = |name, numerator: &[f64], denominator: &[f64]| RefutedScene {
        name,
        scene: scene(44.0, rational(numerator, denominator)),
        judged_as: Some(scene(44.0, rational(&[3.0], &[1.0]))),
    };
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
