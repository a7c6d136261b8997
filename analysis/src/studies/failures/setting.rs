//! All that a case needs: two devices, walls, a board's sensors and motors, and the parts of a result.

use std::f64::consts::TAU;

use haptic_servo::dac::DacCode;
use haptic_servo::environment::{Environment, Rational, Wall};
pub use haptic_servo::scene::Scene;
use haptic_servo::scene::{Coupling, Device};
use haptic_servo::servo::Transducers;

pub use super::loop_run::LoopRun;
pub use super::method_result::{MethodResult, MethodVerdict};
pub use super::motion::{Motion, Outcome};
pub use super::report::CaseReport;
use crate::device;
use crate::limits::{Limit, largest_stiffness, standard_coupling};
use crate::response::Response;
use crate::simulation::closed_loop::transfers;
use crate::simulation::{Experiment, SimulationError};
pub use crate::studies::error::StudyError;

/// Period of all cases in s.
pub const PERIOD: f64 = 1e-3;

/// A heavy knob (theory, end of section 8): undelayed and rigid, its largest spring is 1000 N m/rad.
pub const KNOB: Device = Device { inertia: 0.05, damping: 0.5, passivity: None };

/// The paper's paddle: undelayed and rigid, its largest spring is 44 N m/rad.
pub const PADDLE: Device = Device { inertia: 2.2e-5, damping: 0.022, passivity: None };

/// Encoder and motor of the knob.
pub const KNOBS: Transducers = Transducers::of(65_536.0, 40.0);

/// Encoder and motor of the paddle, its amplifier scaled to these walls: with smaller steps, walls nearer to
/// the limit can be distinguished.
pub const PADDLES: Transducers = Transducers::of(61_440.0, 0.5);

/// A wall that acts on both sides: stiffness in N m/rad, damping in N m s/rad, delay in samples.
pub fn wall_of(stiffness: f64, damping: f64, delay: usize) -> Environment {
    Wall::damped(stiffness, damping, delay).alone()
}

/// A quotient of polynomials with these descending coefficients, without a delay.
///
/// # Panics
/// If there are too many.
pub fn rational(numerator: &[f64], denominator: &[f64]) -> Rational {
    Rational::of(numerator, denominator).expect("few coefficients")
}

/// The largest certified stiffness of a wall in N m/rad.
pub fn limit_of(scene: &Scene) -> Result<f64, StudyError> {
    match largest_stiffness(scene) {
        Limit::AtMost(limit) => Ok(limit),
        _ => Err(StudyError::NoLimit),
    }
}

/// A scene without a coupling.
pub fn rigid(device: Device, environment: Environment) -> Scene {
    Scene::of(device, PERIOD, environment)
}

/// A scene behind the standard coupling `2 delta / T`.
pub fn coupled(device: Device, environment: Environment) -> Scene {
    let scene = rigid(device, environment);
    let stiffness = standard_coupling(&scene);
    Scene { coupling: Coupling::Spring { stiffness }, ..scene }
}

/// Friction in N m that ends the limit cycle of a wall (theory, section 8): for the encoder, plus half a step
/// of the DAC, which is a torque error.
pub fn friction_for_rest(scene: &Scene, transducers: &Transducers) -> f64 {
    let codes = f64::from(DacCode::CODES_TO_FULL_SCALE);
    encoder_friction(scene, transducers) + 0.5 * transducers.full_scale_torque / codes
}

/// `K Delta / 2 + B Delta / T` in N m for the encoder's step `Delta` in rad and a wall; 0 for other environments.
pub fn encoder_friction(scene: &Scene, transducers: &Transducers) -> f64 {
    let step = TAU / transducers.counts_per_turn;
    let Some(wall) = scene.environment.wall() else { return 0.0 };
    (0.5 * wall.stiffness + wall.damping() / scene.timing.period) * step
}

/// The controller of a scene, from the sampled position to the torque.
pub fn controller(scene: &Scene) -> Result<Response, StudyError> {
    Ok(Response::new(transfers(scene).map_err(SimulationError::from)?.controller))
}

/// A run of a scene on its rigid device, with the friction that its board needs for rest.
pub fn loop_run(
    what: &'static str,
    scene: &Scene,
    transducers: Transducers,
    expected: Outcome,
) -> LoopRun {
    let experiment =
        Experiment { friction: friction_for_rest(scene, &transducers), ..Experiment::still(scene) };
    LoopRun { what, experiment, transducers, claimed: None, expected }
}

impl LoopRun {
    /// The same with an initial `velocity` in rad/s, for a number of samples.
    pub fn pushed(mut self, velocity: f64, samples: usize) -> Self {
        self.experiment.start = device::Motion { position: 0.0, velocity };
        self.experiment.samples = samples;
        self
    }

    /// The same, with a board whose scene claims `times` the device's true damping and passivity, so that it
    /// runs a scene that it would refuse. The moving device is the true one, and the torque is unchanged:
    /// only a canceller's law depends on the device's damping, and there is none here.
    pub fn with_claimed_passivity(mut self, times: f64) -> Self {
        let device = self.experiment.scene.device;
        let passivity = device.passivity.map(|passivity| times * passivity);
        self.claimed = Some(Device { damping: times * device.damping, passivity, ..device });
        self
    }
}
