use haptic_servo::certificate::Certified;
use haptic_servo::environment::{Coefficients, Environment, Rational};
use haptic_servo::scene::{Coupling, Device, Latency, Scene, Timing};

/// The scene.
pub const SCENE: Scene = Scene {
    device: Device { inertia: 2.2e-5, damping: 0.022, passivity: None },
    timing: Timing { period: 0.001, worst_period: None },
    coupling: Coupling::Spring { stiffness: 40.0 },
    environment: Environment::Rational(Rational {
        numerator: Coefficients::new(&[5.0, -2.0]).unwrap(),
        denominator: Coefficients::new(&[1.0, -0.3, 0.1, 0.0]).unwrap(),
        delay: 1,
        unit_zeros: 0,
    }),
    latency: Latency::NONE,
    torque_limit: None,
};

/// Its certificate: a scene that could oscillate in a hand is a compile error here.
pub const CERTIFIED: Certified<Scene> = SCENE.certified();
