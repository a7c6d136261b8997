//! The energy of periodic motions, beside known limits.

use adversary::periodic_motion::least_energy;
use haptic_servo::environment::{Coefficients, Environment, Rational, Wall};
use haptic_servo::number::Format;
use haptic_servo::scene::{Coupling, Device, Latency, Scene, Timing};

fn scene(environment: Environment) -> Scene {
    Scene {
        device: Device { inertia: 1.0, damping: 1.0, passivity: None },
        timing: Timing { period: 1.0, worst_period: None },
        coupling: Coupling::Rigid,
        environment,
        latency: Latency::NONE,
        torque_limit: None,
    }
}

fn energy(scene: &Scene, delay: f64, jitter: f64) -> f64 {
    let latency = Latency { output_jitter: jitter, ..Latency::delayed(delay) };
    least_energy(scene, Format::F64, &latency, 1.0).unwrap()
}

/// Without jitter to speak of a spring gives energy away above `delta/(T/2 + d)`, at a whole delay.
#[test]
fn a_spring_gives_energy_away_beyond_its_limit() {
    for delay in [1.0, 2.0] {
        let limit = 1.0 / (0.5 + delay);
        let of = |stiffness| energy(&scene(Wall::spring(stiffness, 0).alone()), delay, 1e-9);
        assert!(of(0.98 * limit) > 0.0 && of(1.02 * limit) < 0.0, "{delay}");
    }
}

/// Filters whose torques cross a count (period and passivity 1), with energies that were computed independently.
#[test]
fn filters_give_energy_away_where_torques_cross_a_count() {
    for (h, r, c, a, p, known) in
        [(0.3, 0.867553, 4.2, 0.7, 0.98, -0.032), (0.2, 1.038474, 5.1, 0.5, 0.9, -0.019)]
    {
        let (low, high) = (-(1.0 - a), 0.5 * c * (1.0 - p));
        let numerator = [low + high, low * p - high * a].map(|n| r * n);
        let of = |list: &[f64]| Coefficients::new(list).unwrap();
        let filter = Environment::Rational(Rational {
            numerator: of(&numerator),
            denominator: of(&[1.0, p - a, -a * p]),
            delay: 0,
            unit_zeros: 1,
        });
        let found = energy(&scene(filter), 1.0, h);
        assert!((found - known).abs() < 0.01, "{found} {known}");
        assert!(energy(&scene(filter), 1.0, 1e-9) > 0.0);
    }
}
