//! The scenes of the tests.

use haptic_servo::environment::Environment;
use haptic_servo::scene::{Coupling, Device, Scene};

use crate::file::{Format, SceneFile, parse};

/// The paddle of the paper's examples.
pub const PADDLE: Device = Device { inertia: 2.2e-5, damping: 0.022, passivity: None };

/// The standard coupling of the paddle at 1 kHz, `2 delta / T`.
pub const STANDARD: Coupling = Coupling::Spring { stiffness: 44.0 };

/// An environment on the paddle at 1 kHz.
pub fn on_paddle(environment: Environment, coupling: Coupling) -> Scene {
    Scene { coupling, ..Scene::of(PADDLE, 0.001, environment) }
}

/// A scene file of the paddle at 1 kHz with these other tables.
pub fn file_on_paddle(tables: &str) -> SceneFile {
    let text = format!(
        "name = \"a wall\"\n[device]\ninertia = 2.2e-5\ndamping = 0.022\n[servo]\nperiod = 0.001\n{tables}"
    );
    parse("wall.toml", Format::Toml, &text).unwrap_or_else(|error| panic!("{error}\n{text}"))
}
