//! The types of all scenes that a file can name.

use haptic_servo::environment::{
    AnyProfile, DamperWall, DelayedSpring, Discretize, Environment, FilteredWall, FreeMode,
    FreeModeWall, MAX_DELAY, OneSided, Placed, Profile, Spring, Wall,
};
use haptic_servo::number::Number;

use crate::tables::{DETENTS, STOPPED};

use super::{BenchJob, HostClosed, SceneSet};

/// All scenes: those with no delay, with one sample and with the longest delay in their own types, others as
/// data.
#[derive(Debug)]
pub struct AllScenes;

impl SceneSet for AllScenes {
    fn ticks<N: Number>(job: BenchJob<'_>) -> Result<(), HostClosed> {
        match job.scene.environment.delay() {
            0 => with_delay_type::<0, N>(job),
            1 => with_delay_type::<1, N>(job),
            MAX_DELAY => with_delay_type::<MAX_DELAY, N>(job),
            _ => as_data::<N>(job),
        }
    }
}

fn with_delay_type<const DELAY: usize, N: Number>(job: BenchJob<'_>) -> Result<(), HostClosed> {
    match job.scene.environment {
        Environment::DelayedSpring(Wall { stiffness, face: 0.0, one_sided: false, .. }) => {
            job.run::<_, N>(DelayedSpring::<DELAY> { stiffness })
        }
        Environment::DamperWall(wall) => match Damped::<DELAY>::of(&wall) {
            Some(Damped::Plain(spring)) => with_face::<_, N>(job, &wall, spring),
            Some(Damped::Filtered(spring)) => with_face::<_, N>(job, &wall, spring),
            None => as_data::<N>(job),
        },
        Environment::FreeMode { residual, .. } => job.run::<_, N>(FreeMode::<DELAY> { residual }),
        Environment::FreeModeWall { residual, wall } => match Damped::<DELAY>::of(&wall) {
            Some(Damped::Plain(spring)) => with_free_mode::<_, N>(job, residual, &wall, spring),
            Some(Damped::Filtered(spring)) => with_free_mode::<_, N>(job, residual, &wall, spring),
            None => as_data::<N>(job),
        },
        Environment::Rational(rational) => job.run::<_, N>(rational),
        Environment::Profile(profile) => with_table::<N>(job, &profile),
        Environment::DelayedSpring(_) | Environment::Stated(_) | Environment::Composed(_) => {
            as_data::<N>(job)
        }
    }
}

/// A servo of any environment as data.
fn as_data<N: Number>(job: BenchJob<'_>) -> Result<(), HostClosed> {
    let environment = job.scene.environment;
    job.run::<_, N>(environment)
}

/// A latched profile of detents, as programs have it, in its own type: other tables take a tick the same
/// instructions, and more types do not fit the flash.
fn with_table<N: Number>(job: BenchJob<'_>, profile: &AnyProfile) -> Result<(), HostClosed> {
    let knots = [&DETENTS, &STOPPED].into_iter().find(|knots| knots.units() == profile.units());
    let (Some(knots), 1, 0.0) = (knots, profile.delay, profile.damping) else {
        return as_data::<N>(job);
    };
    let AnyProfile { torque, count, centre, ends, .. } = *profile;
    job.run::<_, N>(Profile::<16, 1> { knots, torque, count, centre, ends })
}

/// A wall at zero.
enum Damped<const DELAY: usize> {
    Plain(DamperWall<DELAY>),
    Filtered(FilteredWall<DELAY>),
}

impl<const DELAY: usize> Damped<DELAY> {
    /// `None` for a wall without damping, which is a spring as data.
    fn of(wall: &Wall) -> Option<Self> {
        let Wall { stiffness, damping, .. } = *wall;
        match wall.filter {
            Some(filter) => Some(Self::Filtered(FilteredWall { stiffness, damping, filter })),
            None if damping == 0.0 => None,
            None => Some(Self::Plain(DamperWall { stiffness, damping })),
        }
    }
}

/// A wall where it is.
fn with_face<W: Spring<N> + Discretize<N>, N: Number>(
    job: BenchJob<'_>,
    place: &Wall,
    wall: W,
) -> Result<(), HostClosed> {
    match *place {
        Wall { face, one_sided: true, .. } => job.run::<_, N>(OneSided { face, wall }),
        Wall { face: 0.0, .. } => job.run::<_, N>(wall),
        Wall { face, .. } => job.run::<_, N>(Placed { face, wall }),
    }
}

/// A wall that ends free motion. No type has its rest position other than zero.
fn with_free_mode<W: Spring<N> + Discretize<N>, N: Number>(
    job: BenchJob<'_>,
    residual: f64,
    place: &Wall,
    wall: W,
) -> Result<(), HostClosed> {
    match *place {
        Wall { face, one_sided: true, .. } => {
            job.run::<_, N>(FreeModeWall { residual, wall: OneSided { face, wall } })
        }
        Wall { face: 0.0, .. } => job.run::<_, N>(FreeModeWall { residual, wall }),
        _ => as_data::<N>(job),
    }
}
