//! The types of the scenes that have a program.

use firmware::environment::{DamperWall, DelayedSpring, Environment, FreeMode, OneSided, Wall};
use firmware::number::Number;

use super::{BenchJob, HostClosed, SceneSet};

/// The types of the scenes that have a program, and a wall that also pulls.
#[derive(Debug)]
pub struct ProgramScenes;

impl SceneSet for ProgramScenes {
    fn ticks<N: Number>(job: BenchJob<'_>) -> Result<(), HostClosed> {
        let plain = |wall: &Wall| wall.delay == 1 && wall.filter.is_none();
        let centred = |wall: &Wall| plain(wall) && !wall.one_sided && wall.face == 0.0;
        match job.scene.environment {
            Environment::DelayedSpring(wall) if centred(&wall) => {
                job.run::<_, N>(DelayedSpring::<1> { stiffness: wall.stiffness })
            }
            Environment::DamperWall(wall) if plain(&wall) && wall.one_sided => {
                let Wall { stiffness, damping, face, .. } = wall;
                let wall = DamperWall::<1> { stiffness, damping };
                job.run::<_, N>(OneSided { face, wall })
            }
            Environment::DamperWall(wall) if centred(&wall) => {
                let Wall { stiffness, damping, .. } = wall;
                job.run::<_, N>(DamperWall::<1> { stiffness, damping })
            }
            Environment::FreeMode { residual, delay: 1 } => {
                job.run::<_, N>(FreeMode::<1> { residual })
            }
            _ => job.refuse(),
        }
    }
}
