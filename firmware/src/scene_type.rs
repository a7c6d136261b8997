//! The static type of a program's scene, computed from its constant: [`scene_type!`](crate::scene_type!).
//!
//! A program only contains the parts of its scene, their delays, and the memory of its coupling. The structure
//! is that of the scene's options, variants, delays and lengths; a number never is, so that any number may be
//! changed while the servo runs.

use crate::build_error::BuildError;
use crate::certificate::{Certified, scene_data};
use crate::coupling::Coupling;
use crate::coupling_memory::CouplingMemory;
use crate::environment::{
    Anticogging, Canceller, Compensation, Delayed, Discretize, Environment, EnvironmentModel,
    LawContext, LawOf, Memory, PartSet, Parts, Profile, ProfileUse, Side, SupportsTiming, Wall,
    sealed,
};
use crate::host::{BesideServo, HostTorque};
use crate::number::Number;
use crate::output_timing::AtPhase;
use crate::parameter::{NamedParameters, Parameter};
use crate::rendering::{Rendering, context_beside_anticogging};
use crate::scene::Scene;

/// The structure of a scene. [`scene_type!`](crate::scene_type!) makes one.
pub trait SceneType: Copy + core::fmt::Debug + PartialEq + 'static {
    /// The certified scene whose structure it is.
    const CERTIFIED: Certified<Scene>;
    /// The numbers of its environment.
    const NUMBERS: Self::Numbers;
    /// As many numbers as may be changed while the servo runs.
    type Numbers: AsRef<[f64]> + AsMut<[f64]> + Copy + core::fmt::Debug + PartialEq;
    /// The law of the environment.
    type Law<N: Number>: LawOf<N, Parts>;
    /// The torques that the coupling stores.
    type Memory<N: Number>: CouplingMemory<N>;
    /// The anticogging, or none.
    type Anticogging<N: Number>: Compensation<N>;
    /// What a host beside the servo may do.
    const HOST: Option<HostTorque>;
    /// That host, or none.
    type Host: BesideServo<Budget = Self::Budget>;
    /// What it may do, as a type.
    type Budget: Copy + core::fmt::Debug + PartialEq;
    /// What it may do.
    const BUDGET: Self::Budget;
}

/// An environment whose parts are known statically: the numbers of a program's scene.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Typed<S: SceneType> {
    numbers: S::Numbers,
    budget: S::Budget,
}

impl<S: SceneType> Typed<S> {
    /// The structure's parts.
    const LIKE: Parts = *S::CERTIFIED.scene().environment.parts();
    /// With the structure's numbers.
    pub(crate) const ENVIRONMENT: Self = Self { numbers: S::NUMBERS, budget: S::BUDGET };
    /// Where each parameter is among the numbers.
    const PLACES: Places = places(S::CERTIFIED.scene().environment);

    /// The certified scene of the structure.
    pub const fn certified() -> Certified<Scene<Self>> {
        S::CERTIFIED.with_environment(Self::ENVIRONMENT)
    }

    /// A scene that only differs from the structure's by its numbers; `None` if another does.
    pub fn of(scene: &Scene) -> Option<Scene<Self>> {
        let Environment::Parts(parts) = scene.environment else { return None };
        let (mut environment, mut data) = (Self::ENVIRONMENT, scene.environment);
        for parameter in Parameter::ALL {
            if let (Some(place), Some(number)) =
                (environment.value(*parameter), data.value(*parameter))
            {
                *place = *number;
            }
        }
        let is_same = Structure::of(scene) == Structure::of(S::CERTIFIED.scene())
            && environment.parts() == parts;
        is_same.then(|| scene.in_environment(environment))
    }

    /// The present number of a parameter; `None` if the structure has none of its name.
    #[inline(always)]
    fn number(&self, parameter: Parameter) -> Option<f64> {
        let place = usize::from(Self::PLACES[parameter as usize]);
        self.numbers.as_ref().get(place).copied()
    }

    /// The parts with their present numbers. All but the numbers is that of the structure, so that the compiler
    /// leaves out what the scene does not have.
    fn parts(&self) -> Parts {
        let Parts { canceller, wall, profile, drag, anticogging } = Self::LIKE;
        // If both have them, these names are the wall's.
        let of_wall =
            |it| wall.is_some() && matches!(it, Parameter::Stiffness | Parameter::Damping);
        Parts {
            canceller: canceller.map(|like| like.with_numbers(|it| self.number(it))),
            wall: wall.map(|like| like.with_numbers(|it| self.number(it))),
            profile: profile.map(|like| {
                like.with_numbers(|it| if of_wall(it) { None } else { self.number(it) })
            }),
            drag: drag.map(|like| like.with_numbers(|it| self.number(it))),
            anticogging: anticogging.map(|like| like.with_numbers(|it| self.number(it))),
        }
    }
}

impl<S: SceneType> NamedParameters for Typed<S> {
    fn value(&mut self, parameter: Parameter) -> Option<&mut f64> {
        self.numbers.as_mut().get_mut(usize::from(Self::PLACES[parameter as usize]))
    }
}

impl<S: SceneType> sealed::Sealed for Typed<S> {}

impl<S: SceneType> EnvironmentModel for Typed<S> {
    const PARTS: PartSet = PartSet::of(&Self::LIKE);
    const IS_SUM: bool = true;
    const PROFILE: ProfileUse = ProfileUse::of(&Self::LIKE);
    const MEMORY: Memory = Memory::of(S::CERTIFIED.scene());
    const MAY_MISREAD: bool = {
        let encoder = S::CERTIFIED.scene().latency.encoder;
        !encoder.is_ideal() || encoder.steps() > 1.0
    };

    fn as_data(&self, _: &LawContext) -> Environment {
        Environment::Parts(self.parts())
    }
}

impl<N: Number, S: SceneType> Discretize<N> for Typed<S> {
    type Law = S::Law<N>;

    fn law(&self, context: &LawContext) -> Result<Self::Law, BuildError> {
        S::Law::law_of(&self.parts(), context)
    }
}

impl<N: Number, S: SceneType> Rendering<N> for Typed<S> {
    type Memory = S::Memory<N>;
    type Anticogging = S::Anticogging<N>;
    type Host = S::Host;
    const HOST: Option<HostTorque> = S::HOST;
    const AGAINST_COGGING: f64 = Self::LIKE.against_cogging();

    fn budget(&self) -> S::Budget {
        self.budget
    }

    fn with_budget(self, budget: S::Budget) -> Self {
        Self { budget, ..self }
    }

    fn anticogging(&self) -> Option<(Anticogging, usize)> {
        Self::LIKE.anticogging?;
        self.parts().late_anticogging()
    }

    fn context(scene: &Scene<Self>) -> LawContext {
        match Self::LIKE.anticogging {
            None => scene.context(),
            Some(_) => context_beside_anticogging::<Self>(&scene_data(scene), N::FORMAT),
        }
    }
}

// With late torques, its numbers decide, which are checked with the timing of the scene.
impl<S: SceneType> Delayed for Typed<S> {}

impl<S: SceneType, const NANOSECONDS: u32> SupportsTiming<AtPhase<NANOSECONDS>> for Typed<S> {}

/// The structure of a scene in numbers, for the types that [`scene_type!`](crate::scene_type!) computes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Structure {
    /// Number of cancellers.
    pub cancellers: usize,
    /// The canceller's delay.
    pub canceller_delay: usize,
    /// Number of walls.
    pub walls: usize,
    /// The wall's delay.
    pub wall_delay: usize,
    /// Whether the wall has a damper.
    pub is_damped: bool,
    /// Whether it has a filter.
    pub is_filtered: bool,
    /// Whether it pulls, at a position that is not zero.
    pub is_displaced: bool,
    /// Whether it only pushes.
    pub is_one_sided: bool,
    /// Number of profiles.
    pub profiles: usize,
    /// The profile's delay.
    pub profile_delay: usize,
    /// Cells of the profile's table; 0 without cells.
    pub cells: usize,
    /// Whether the profile has a damper.
    pub is_profile_damped: bool,
    /// Whether it has a snap point.
    pub snaps: bool,
    /// Whether it is one of several modes.
    pub has_modes: bool,
    /// Number of drags.
    pub drags: usize,
    /// The drag's delay.
    pub drag_delay: usize,
    /// Whether it opposes the cogging of the motor.
    pub has_anticogging: bool,
    /// The delay of what opposes it.
    pub anticogging_delay: usize,
    /// Whether the coupling stores torques.
    pub is_matched: bool,
    /// The whole samples of output delay.
    pub whole: usize,
    /// The number of lags.
    pub lags: usize,
    /// Whether the amplifier is updated several times in a period.
    pub has_updates: bool,
}

impl Structure {
    /// Of a scene.
    ///
    /// # Panics
    /// If its environment is not a sum of parts; in a constant this is a compile error.
    pub const fn of(scene: &Scene) -> Self {
        let Environment::Parts(parts) = &scene.environment else {
            panic!("a board renders sums of parts, and no rational environment");
        };
        let Parts { canceller, wall, profile, drag, anticogging } = parts;
        let (latency, is_matched) = (&scene.latency, matches!(scene.coupling, Coupling::Matched));
        let as_wall = or!(*wall, Wall::spring(0.0, 0));
        Self {
            cancellers: canceller.is_some() as usize,
            canceller_delay: or!(*canceller, Canceller::to(0.0)).delay,
            walls: wall.is_some() as usize,
            wall_delay: as_wall.delay,
            is_damped: as_wall.damper.is_some(),
            is_filtered: as_wall.filter().is_some(),
            is_displaced: matches!(as_wall.side, Side::Displaced(_)),
            is_one_sided: as_wall.is_one_sided(),
            profiles: profile.is_some() as usize,
            profile_delay: match profile {
                Some(profile) => profile.delay,
                None => 0,
            },
            cells: match profile {
                Some(profile) => profile.cells().len(),
                None => 0,
            },
            is_profile_damped: matches!(profile, Some(Profile { damping: Some(_), .. })),
            snaps: matches!(profile, Some(Profile { snap: Some(_), .. })),
            has_modes: matches!(profile, Some(Profile { modes: Some(_), .. })),
            drags: drag.is_some() as usize,
            drag_delay: match drag {
                Some(drag) => drag.delay,
                None => 0,
            },
            has_anticogging: anticogging.is_some(),
            anticogging_delay: parts.is_late() as usize,
            is_matched,
            whole: if is_matched { latency.whole_samples(scene.timing.period) } else { 0 },
            lags: latency.trails(),
            has_updates: latency.actuator_updates != 0,
        }
    }
}

/// The first of two types, or the second.
pub type Either<const IS_FIRST: bool, A, B> = <Choice<IS_FIRST> as Choose<A, B>>::Chosen;

/// A choice between two types.
#[derive(Clone, Copy, Debug)]
pub struct Choice<const IS_FIRST: bool>;

/// The result of a [`Choice`].
pub trait Choose<A, B> {
    /// The chosen type.
    type Chosen;
}

impl<A, B> Choose<A, B> for Choice<true> {
    type Chosen = A;
}

impl<A, B> Choose<A, B> for Choice<false> {
    type Chosen = B;
}

/// Where each parameter of an environment is among its numbers; beyond them if it has none of its name.
type Places = [u8; Parameter::ALL.len()];

const fn places(mut environment: Environment) -> Places {
    let mut places = [u8::MAX; _];
    let mut next = 0;
    each!(i in 0..places.len() => {
        if environment.tunable_mut(Parameter::ALL[i]).is_some() {
            places[i] = next;
            next += 1;
        }
    });
    places
}

/// As many numbers as an environment has.
#[doc(hidden)]
pub const fn count(mut environment: Environment) -> usize {
    let mut count = 0;
    each!(i in 0..Parameter::ALL.len() => {
        count += environment.tunable_mut(Parameter::ALL[i]).is_some() as usize;
    });
    count
}

/// The numbers of an environment in the order of the parameters.
#[doc(hidden)]
pub const fn numbers<const COUNT: usize>(mut environment: Environment) -> [f64; COUNT] {
    let mut numbers = [0.0; COUNT];
    let mut next = 0;
    each!(i in 0..Parameter::ALL.len() => {
        if let Some(number) = environment.tunable_mut(Parameter::ALL[i]) {
            numbers[next] = *number;
            next += 1;
        }
    });
    numbers
}

/// Makes a type of the structure of a certified scene: `scene_type!(pub MyScene: CERTIFIED)`, where `CERTIFIED` is a
/// constant `Certified<Scene>`; with `, host: HOST` after it, a constant `HostTorque`, it has a host. The
/// environment of such a program is `Typed<MyScene>`.
///
/// ```
/// use haptic_servo::certificate::Certified;
/// use haptic_servo::environment::Wall;
/// use haptic_servo::scene::{Coupling, Device, Latency, Scene, Timing};
/// use haptic_servo::scene_type::Typed;
/// use haptic_servo::servo::Servo;
///
/// const CERTIFIED: Certified<Scene> = Scene {
///     device: Device { inertia: 2.2e-5, damping: 0.022, passivity: None },
///     timing: Timing { period: 0.001, worst_period: None },
///     coupling: Coupling::Spring { stiffness: 44.0 },
///     environment: Wall::damped(22.0, 0.01, 1).behind(0.1).alone(),
///     latency: Latency::NONE,
///     torque_limit: Some(1.0),
/// }
/// .certified();
/// haptic_servo::scene_type!(WallScene: CERTIFIED);
/// // A stiffness, a damper, a face, one stored sample, and no more.
/// type WallServo = Servo<Typed<WallScene>, f32>;
/// assert!(size_of::<WallServo>() < size_of::<Servo<haptic_servo::environment::Environment, f32>>());
/// ```
#[macro_export]
macro_rules! scene_type {
    ($(#[$attribute:meta])* $visibility:vis $name:ident: $certified:path $(, host: $host:path)?) => {
        $(#[$attribute])*
        #[derive(Clone, Copy, Debug, PartialEq)]
        $visibility struct $name;

        const _: () = {
            use $crate::scene_type::names::*;

            const GIVEN: Certified<Scene> = $crate::reported_once!($certified);
            const OF: Structure = Structure::of(GIVEN.scene());
            const ENVIRONMENT: Environment = GIVEN.scene().environment;
            const TIMES: HostTimes =
                HostTimes::of(&GIVEN.scene().latency, GIVEN.scene().timing.period);
            #[allow(unused_mut, unused_assignments)]
            const OF_HOST: Option<HostTorque> = {
                let mut host = None;
                $(host = Some($host);)?
                host
            };

            impl SceneType for $name {
                const CERTIFIED: Certified<Scene> = GIVEN;
                const NUMBERS: Self::Numbers = numbers(ENVIRONMENT);
                type Numbers = [f64; count(ENVIRONMENT)];
                type Law<N: Number> = SumLaw<
                    [ProfileLaw<
                        N,
                        Either<{ OF.cells > 0 }, &'static [Cell; OF.cells], &'static [i16]>,
                        Either<{ OF.is_profile_damped }, Difference<N>, NoDamping>,
                        FixedDelay<N, { OF.profile_delay }>,
                        Either<
                            { OF.has_modes },
                            AnySnap<N>,
                            Either<{ OF.snaps }, Snap<N>, NoSnap>,
                        >,
                    >; OF.profiles],
                    [WallLaw<
                        N,
                        Either<
                            { OF.is_filtered },
                            Washout<N>,
                            Either<{ OF.is_damped }, Difference<N>, NoDamping>,
                        >,
                        Either<
                            { OF.is_one_sided },
                            Face<N>,
                            Either<{ OF.is_displaced }, Displaced<N>, Centred>,
                        >,
                        FixedDelay<N, { OF.wall_delay }>,
                    >; OF.walls],
                    [DragLaw<N, FixedDelay<N, { OF.drag_delay }>>; OF.drags],
                    [CancellerLaw<N, FixedDelay<N, { OF.canceller_delay }>>; OF.cancellers],
                >;
                type Memory<N: Number> = Either<
                    { OF.is_matched },
                    MatchedMemory<
                        N,
                        FixedDelay<N, { OF.whole }>,
                        { OF.lags },
                        { OF.has_updates },
                    >,
                    NoMemory,
                >;
                type Anticogging<N: Number> = Either<
                    { OF.has_anticogging },
                    Option<AnticoggingLaw<N, FixedDelay<N, { OF.anticogging_delay }>>>,
                    NoAnticogging,
                >;
                const HOST: Option<HostTorque> = OF_HOST;
                type Host = Either<
                    { OF_HOST.is_some() },
                    Hosted<{ TIMES.ticks }, { !TIMES.is_plain as usize }>,
                    NoHost,
                >;
                type Budget = <Self::Host as BesideServo>::Budget;
                const BUDGET: Self::Budget = ($($host)?);
            }
        };
    };
}

/// A constant, for constants that need it: if it does not compile, its own error is the only one. The compiler
/// repeats the error of a constant in each body that uses it, but not in a pattern.
#[doc(hidden)]
#[macro_export]
macro_rules! reported_once {
    ($constant:path) => {
        match $constant {
            given @ $constant => given,
            _ => unreachable!(),
        }
    };
}

/// All that [`scene_type!`](crate::scene_type!) names.
#[doc(hidden)]
pub mod names {
    pub use crate::certificate::Certified;
    pub use crate::coupling_memory::{MatchedMemory, NoMemory};
    pub use crate::environment::{
        AnticoggingLaw, AnySnap, CancellerLaw, Cell, Centred, Difference, Displaced, DragLaw,
        Environment, Face, FixedDelay, NoAnticogging, NoDamping, NoSnap, ProfileLaw, Snap, SumLaw,
        WallLaw, Washout,
    };
    pub use crate::host::{BesideServo, HostTimes, HostTorque, Hosted, NoHost};
    pub use crate::number::Number;
    pub use crate::scene::Scene;

    pub use super::{Either, SceneType, Structure, count, numbers};
}

#[cfg(test)]
mod tests;
