//! The types of the scenes that have a program.

use haptic_servo::environment::{Canceller, Wall};
use haptic_servo::number::Number;
use haptic_servo::scene::{Coupling, Latency, Scene};

use super::scene_types::{scene_types, unlimited};
use super::{BenchJob, HostClosed, SceneSet};

/// The types of the scenes that have a program, a wall that also pulls, and a one-sided wall without delay behind
/// the matched coupling, with one lag and without.
#[derive(Debug)]
pub struct ProgramScenes;

impl SceneSet for ProgramScenes {
    fn ticks<N: Number>(job: BenchJob<'_>) -> Result<(), HostClosed> {
        ticks::<N>(job).unwrap_or_else(BenchJob::refuse)
    }
}

const WALL: Wall = Wall::damped(22.0, 0.01, 1);

/// A one-sided wall without delay behind the matched coupling.
const fn matched(latency: Latency) -> Scene {
    let wall = Wall { delay: 0, ..WALL };
    Scene { coupling: Coupling::Matched, latency, ..unlimited(wall.behind(0.0).alone()) }
}

scene_types! {
    spring: unlimited(Wall::spring(22.0, 1).alone());
    wall: unlimited(WALL.alone());
    faced: unlimited(WALL.behind(0.0).alone());
    free: unlimited(Canceller { residual: 0.001, delay: 1 }.alone());
    prompt: matched(Latency::delayed(1e-5));
    lagging: matched(Latency::delayed(1e-5).with_actuator_lag(53e-6));
}
