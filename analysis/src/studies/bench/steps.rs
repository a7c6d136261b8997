//! The cost of a step of the exact method, compared with a loop written by hand for its scene.

use std::hint::black_box;
use std::time::Instant;

use haptic_servo::environment::{Environment, Wall};
use haptic_servo::scene::{Coupling, Device, Latency, Scene, Timing};

use super::{ROUNDS, median};
use crate::device::Motion;
use crate::simulation::{Experiment, Integration, Simulator, Trajectory};

/// Steps of a run.
pub const STEPS: usize = 10_000;
/// Near the standard coupling's limit, so that the motion lasts for all steps.
const STIFFNESS: f64 = 43.999;

/// A wall of the paper's device, released from a millirad.
pub fn experiment(damping: f64, delay: usize, torque_limit: Option<f64>) -> Experiment {
    let stiffness = STIFFNESS - 2.0 * damping / 1e-3;
    let wall = Wall { stiffness, damping, filter: None, delay, face: 0.0, one_sided: false };
    let scene = Scene {
        device: Device { inertia: 2.2e-5, damping: 0.022, passivity: None },
        timing: Timing { period: 1e-3, worst_period: None },
        coupling: Coupling::Spring { stiffness: 44.0 },
        environment: Environment::DamperWall(wall),
        latency: Latency::NONE,
        torque_limit,
    };
    let start = Motion { position: 1e-3, velocity: 0.0 };
    Experiment { samples: STEPS, start, ..Experiment::still(&scene) }
}

/// Mass-damper and delayed spring, states in variables, samples recorded.
pub fn by_hand(out: &mut Trajectory) {
    let (m, b, t, k, coupling) = (2.2e-5, 0.022, 1e-3, STIFFNESS, 44.0);
    let decay = f64::exp(-b * t / m);
    let slide = (1.0 - decay) * m / b;
    let (to_position, to_velocity) = ((t - slide) / b, (1.0 - decay) / b);
    let (mut x, mut v, mut due) = (1e-3, 0.0, 0.0);
    let samples = out.position.iter_mut().zip(&mut out.velocity).zip(&mut out.torque);
    for ((position, velocity), torque) in samples {
        (*position, *velocity, *torque) = (x, v, due);
        let next = k * (x - due / coupling);
        (x, v) = (x + slide * v - to_position * due, decay * v - to_velocity * due);
        due = next;
    }
}

/// Median times in nanoseconds of one step on one core: of the exact method on a wall of degree
/// 1, and of the loop by hand, in turns.
pub fn step_times() -> (f64, f64) {
    let mut simulator = Simulator::new(&experiment(0.0, 1, None), Integration::default())
        .expect("a wall has a difference equation");
    let mut out = Trajectory::of_length(STEPS);
    let time = |run: &mut dyn FnMut(&mut Trajectory), out: &mut Trajectory| {
        let start = Instant::now();
        run(black_box(out));
        start.elapsed().as_secs_f64() * 1e9 / STEPS as f64
    };
    let (mut exact, mut hand) = (Vec::new(), Vec::new());
    for _ in 0..ROUNDS {
        exact.push(time(&mut |out| simulator.fill(out), &mut out));
        hand.push(time(&mut |out| by_hand(out), &mut out));
    }
    (median(exact), median(hand))
}
