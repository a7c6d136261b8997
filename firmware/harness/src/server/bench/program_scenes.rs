//! The types of the scenes that have a program.

use haptic_servo::environment::{
    DamperWall, DelayedSpring, Environment, FreeMode, Matched, OneSided, Wall,
};
use haptic_servo::number::Number;
use haptic_servo::scene::Coupling;

use super::{BenchJob, HostClosed, SceneSet};

/// The types of the scenes that have a program, a wall that also pulls, and a one-sided wall without delay behind
/// the matched coupling, with one lag and without.
#[derive(Debug)]
pub struct ProgramScenes;

impl SceneSet for ProgramScenes {
    fn ticks<N: Number>(job: BenchJob<'_>) -> Result<(), HostClosed> {
        let plain = |wall: &Wall| wall.delay == 1 && wall.filter.is_none();
        let centred = |wall: &Wall| plain(wall) && !wall.one_sided && wall.face == 0.0;
        if matches!(job.scene.coupling, Coupling::Matched) {
            return behind_matched::<N>(job);
        }
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

fn behind_matched<N: Number>(job: BenchJob<'_>) -> Result<(), HostClosed> {
    let Environment::DamperWall(Wall {
        stiffness,
        damping,
        face,
        one_sided: true,
        delay: 0,
        filter: None,
    }) = job.scene.environment
    else {
        return job.refuse();
    };
    let environment = OneSided { face, wall: DamperWall::<0> { stiffness, damping } };
    if job.scene.latency.actuator_lag.is_zero() {
        job.run::<_, N>(Matched::<_, 0, 0> { environment })
    } else {
        job.run::<_, N>(Matched::<_, 0, 1> { environment })
    }
}
