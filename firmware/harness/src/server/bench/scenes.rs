//! Scene types for jobs whose numbers come from the host: of the scenes that have a program, and of all scenes that a
//! file can name.

use haptic_servo::environment::{Canceller, Environment, MAX_DELAY, Parts, Profile, Side, Wall};
use haptic_servo::number::Number;
use haptic_servo::scene::{Coupling, Device, Latency, Scene};

use super::{BenchJob, HostClosed, SceneSet};
use crate::tables::{DETENTS, STOPPED};

/// Makes `ticks`, which runs a job with the type of the first of these scenes that has the structure of the job's
/// scene; `Err` with the job if none has it.
macro_rules! scene_types {
    ($($name:ident: $scene:expr;)*) => {
        $(mod $name {
            use super::*;

            const CERTIFIED: haptic_servo::certificate::Certified<haptic_servo::scene::Scene> =
                $scene.certified();

            haptic_servo::scene_type!(pub Type: CERTIFIED);
        })*

        pub fn ticks<N: Number>(job: BenchJob<'_>) -> Result<Result<(), HostClosed>, BenchJob<'_>> {
            use haptic_servo::scene_type::Typed;

            $(if let Some(scene) = Typed::<$name::Type>::of(job.scene) {
                return Ok(job.run::<_, N>(scene));
            })*
            Err(job)
        }
    };
}

/// The scene of an environment on the paddle of the programs, with its torque not limited.
const fn unlimited(environment: Environment) -> Scene {
    Scene {
        coupling: Coupling::Spring { stiffness: 44.0 },
        ..Scene::of(Device::damped(2.2e-5, 0.022), 0.001, environment)
    }
}

/// A wall that also pulls, at rest elsewhere than at zero.
const fn placed(wall: Wall) -> Wall {
    Wall { side: Side::Displaced(0.01), ..wall }
}

/// The types of the scenes that have a program, a wall that also pulls, and a one-sided wall without delay behind
/// the matched coupling, with one lag and without.
#[derive(Debug)]
pub struct ProgramScenes;

impl SceneSet for ProgramScenes {
    fn ticks<N: Number>(job: BenchJob<'_>) -> Result<(), HostClosed> {
        programs::ticks::<N>(job).unwrap_or_else(BenchJob::refuse)
    }
}

const PROGRAM_WALL: Wall = Wall::damped(22.0, 0.01, 1);

/// A one-sided wall without delay behind the matched coupling.
const fn matched(latency: Latency) -> Scene {
    let wall = Wall { delay: 0, ..PROGRAM_WALL };
    Scene { coupling: Coupling::Matched, latency, ..unlimited(wall.behind(0.0).alone()) }
}

mod programs {
    use super::*;

    scene_types! {
        spring: unlimited(Wall::spring(22.0, 1).alone());
        wall: unlimited(PROGRAM_WALL.alone());
        faced: unlimited(PROGRAM_WALL.behind(0.0).alone());
        free: unlimited(Canceller { residual: 0.001, delay: 1 }.alone());
        prompt: matched(Latency::delayed(1e-5));
        lagging: matched(Latency::delayed(1e-5).with_actuator_lag(53e-6));
    }
}

/// All scenes: those with no delay, with one sample and with the longest delay in their own types, others as
/// data.
#[derive(Debug)]
pub struct AllScenes;

impl SceneSet for AllScenes {
    fn ticks<N: Number>(job: BenchJob<'_>) -> Result<(), HostClosed> {
        let run = undelayed::ticks::<N>(job)
            .or_else(late::ticks::<N>)
            .or_else(latest::ticks::<N>)
            .or_else(profiles::ticks::<N>);
        run.unwrap_or_else(|job| {
            let scene = *job.scene;
            job.run::<Environment, N>(scene)
        })
    }
}

/// An undelayed canceller and a wall.
const fn ended(wall: Wall) -> Environment {
    Parts { canceller: Some(Canceller::to(0.021)), wall: Some(wall), ..Parts::NONE }.sum()
}

macro_rules! of_delay {
    ($($module:ident: $delay:expr;)*) => {$(
        mod $module {
            use super::*;

            const WALL: Wall = Wall::damped(0.1, 0.001, $delay);
            const FILTERED: Wall = WALL.filtered(0.5);

            scene_types! {
                spring: unlimited(Wall::spring(0.1, $delay).alone());
                wall: unlimited(WALL.alone());
                placed_wall: unlimited(placed(WALL).alone());
                faced: unlimited(WALL.behind(0.0).alone());
                filtered: unlimited(FILTERED.alone());
                placed_filtered: unlimited(placed(FILTERED).alone());
                faced_filtered: unlimited(FILTERED.behind(0.0).alone());
                free: unlimited(Canceller { residual: 0.0215, delay: $delay }.alone());
                free_wall: unlimited(ended(WALL));
                free_faced: unlimited(ended(WALL.behind(0.0)));
                free_filtered: unlimited(ended(FILTERED));
                free_faced_filtered: unlimited(ended(FILTERED.behind(0.0)));
            }
        }
    )*};
}

of_delay! {
    undelayed: 0;
    late: 1;
    latest: MAX_DELAY;
}

/// Latched profiles of detents, as programs have them: other tables take a tick the same instructions, and more
/// types do not fit the flash.
mod profiles {
    use super::*;

    scene_types! {
        detents: unlimited(Profile::of(&DETENTS, 1).alone());
        stopped: unlimited(Profile::of(&STOPPED, 1).alone());
    }
}
