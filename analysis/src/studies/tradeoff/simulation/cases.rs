//! The motions of the measurements.

use haptic_servo::environment::Wall;

use crate::chain::{Link, Mass};
use crate::device::{Hand, Motion};
use crate::simulation::Experiment;
use crate::simulation::plant::Plant;
use crate::studies::failures::setting::{KNOB, rigid};

/// Samples of a motion.
pub(super) const SAMPLES: usize = 1000;
/// Stiffness of the spring in N m/rad: stable for every method on one mass.
pub(super) const STIFFNESS: f64 = 300.0;

/// A motion to be computed: a spring without delay and coupling, on a device released at a millirad.
#[derive(Clone, Debug)]
pub struct Case {
    /// The name.
    pub name: &'static str,
    /// The motion.
    pub experiment: Experiment,
}

/// The device of theory, section 9; and as two masses whose resonance is at 1183 rad/s, in a hand.
pub fn cases() -> [Case; 2] {
    let masses = [Mass { inertia: 0.05, damping: 0.5 }, Mass { inertia: 0.02, damping: 0.0 }];
    let links = [Link { stiffness: 20e3, damping: 0.27 }];
    let hand = Hand { inertia: 0.1, damping: 1.0, stiffness: 1000.0 };
    let case = |name, plant| Case { name, experiment: released(plant) };
    [
        case("mass and damper", Plant::rigid(KNOB)),
        case("two masses in a hand", Plant::chain(&masses, &links).with_hand(hand)),
    ]
}

fn released(plant: Plant) -> Experiment {
    let scene = rigid(KNOB, Wall::spring(STIFFNESS, 0).alone());
    let start = Motion { position: 1e-3, velocity: 0.0 };
    Experiment { plant, start, samples: SAMPLES, ..Experiment::still(&scene) }
}
