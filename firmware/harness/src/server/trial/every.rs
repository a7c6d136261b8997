//! The types of all scenes that a file can name.

use firmware::environment::{
    DamperWall, DelayedSpring, Discretize, Environment, FilteredWall, FreeMode, FreeModeWall,
    MAX_DELAY, OneSided, Placed, Spring, Wall,
};
use firmware::number::Number;

use super::{Gone, Job, Kinds};

/// All scenes: those without a delay, with one sample of it and with the most in types of their own,
/// others as data.
#[derive(Debug)]
pub struct Every;

impl Kinds for Every {
    fn ticks<N: Number>(job: Job<'_>) -> Result<(), Gone> {
        match job.scene.environment.delay() {
            0 => typed::<0, N>(job),
            1 => typed::<1, N>(job),
            MAX_DELAY => typed::<MAX_DELAY, N>(job),
            _ => as_data::<N>(job),
        }
    }
}

fn typed<const DELAY: usize, N: Number>(job: Job<'_>) -> Result<(), Gone> {
    match job.scene.environment {
        Environment::DelayedSpring(Wall { stiffness, face: 0.0, one_sided: false, .. }) => {
            job.of::<_, N>(DelayedSpring::<DELAY> { stiffness })
        }
        Environment::DamperWall(wall) => match Damped::<DELAY>::of(&wall) {
            Some(Damped::Plain(spring)) => sided::<_, N>(job, &wall, spring),
            Some(Damped::Filtered(spring)) => sided::<_, N>(job, &wall, spring),
            None => as_data::<N>(job),
        },
        Environment::FreeMode { residual, .. } => job.of::<_, N>(FreeMode::<DELAY> { residual }),
        Environment::FreeModeWall { residual, wall } => match Damped::<DELAY>::of(&wall) {
            Some(Damped::Plain(spring)) => ended::<_, N>(job, residual, &wall, spring),
            Some(Damped::Filtered(spring)) => ended::<_, N>(job, residual, &wall, spring),
            None => as_data::<N>(job),
        },
        Environment::Rational(rational) => job.of::<_, N>(rational),
        Environment::DelayedSpring(_) | Environment::Stated(_) => as_data::<N>(job),
    }
}

/// As a servo of any environment.
fn as_data<N: Number>(job: Job<'_>) -> Result<(), Gone> {
    let environment = job.scene.environment;
    job.of::<_, N>(environment)
}

/// A wall at zero.
enum Damped<const DELAY: usize> {
    Plain(DamperWall<DELAY>),
    Filtered(FilteredWall<DELAY>),
}

impl<const DELAY: usize> Damped<DELAY> {
    /// `None` for a wall that does not damp, which as data is a spring.
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
fn sided<W: Spring<N> + Discretize<N>, N: Number>(
    job: Job<'_>,
    place: &Wall,
    wall: W,
) -> Result<(), Gone> {
    match *place {
        Wall { face, one_sided: true, .. } => job.of::<_, N>(OneSided { face, wall }),
        Wall { face: 0.0, .. } => job.of::<_, N>(wall),
        Wall { face, .. } => job.of::<_, N>(Placed { face, wall }),
    }
}

/// A wall that ends free motion. There is no type of one that has its rest elsewhere than at zero.
fn ended<W: Spring<N> + Discretize<N>, N: Number>(
    job: Job<'_>,
    residual: f64,
    place: &Wall,
    wall: W,
) -> Result<(), Gone> {
    match *place {
        Wall { face, one_sided: true, .. } => {
            job.of::<_, N>(FreeModeWall { residual, wall: OneSided { face, wall } })
        }
        Wall { face: 0.0, .. } => job.of::<_, N>(FreeModeWall { residual, wall }),
        _ => as_data::<N>(job),
    }
}
