//! The types of all scenes that a file can name.

use haptic_servo::environment::{Canceller, Environment, MAX_DELAY, Parts, Profile, Wall};
use haptic_servo::number::Number;

use super::scene_types::{placed, scene_types, unlimited};
use super::{BenchJob, HostClosed, SceneSet};
use crate::tables::{DETENTS, STOPPED};

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
    Parts { canceller: Some(Canceller::to(0.021)), wall: Some(wall), profile: None }.sum()
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
