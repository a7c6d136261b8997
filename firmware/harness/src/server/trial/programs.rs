//! The types of the scenes that have a program.

use firmware::environment::{DamperWall, DelayedSpring, Environment, FreeMode, OneSided, Wall};
use firmware::number::Number;

use super::{Gone, Job, Kinds};

/// The types of the scenes that have a program, and a wall that also pulls.
#[derive(Debug)]
pub struct OfPrograms;

impl Kinds for OfPrograms {
    fn ticks<N: Number>(job: Job<'_>) -> Result<(), Gone> {
        let plain = |wall: &Wall| wall.delay == 1 && wall.filter.is_none();
        let centred = |wall: &Wall| plain(wall) && !wall.one_sided && wall.face == 0.0;
        match job.scene.environment {
            Environment::DelayedSpring(wall) if centred(&wall) => {
                job.of::<_, N>(DelayedSpring::<1> { stiffness: wall.stiffness })
            }
            Environment::DamperWall(wall) if plain(&wall) && wall.one_sided => {
                let Wall { stiffness, damping, face, .. } = wall;
                let wall = DamperWall::<1> { stiffness, damping };
                job.of::<_, N>(OneSided { face, wall })
            }
            Environment::DamperWall(wall) if centred(&wall) => {
                let Wall { stiffness, damping, .. } = wall;
                job.of::<_, N>(DamperWall::<1> { stiffness, damping })
            }
            Environment::FreeMode { residual, delay: 1 } => {
                job.of::<_, N>(FreeMode::<1> { residual })
            }
            _ => job.refuse(),
        }
    }
}
