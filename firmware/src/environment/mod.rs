//! Virtual environments: position `x_E` (rad) to torque `F` (N m).
//!
//! Sign: `F` is the torque that the environment exerts *on the coupling* against positive
//! deflection, so the motor applies `-F` to the device. A spring is `F = stiffness * x_E`.
//!
//! Each environment has its own type, so that a program only contains the code of its scene. [`Environment`]
//! represents them all as data, for scenes from a file or from the wire. [`Discretize`] turns an environment
//! into its [`Law`], which the servo runs. Another crate can define a [`StatedEnvironment`].

/// The only list of all environments. It calls a macro with each of them: its generic parameters, whether it
/// may cancel the device's damping, the torques that its law stores for a coupling, and its possible torque
/// profile. Each is also listed as [`Matched`].
macro_rules! for_every_environment {
    ($apply:ident) => {
        $apply! {
            [const N: usize] DelayedSpring<N>: false, None, ProfileUse::NONE;
            [const N: usize] Placed<DelayedSpring<N>>: false, None, ProfileUse::NONE;
            [const N: usize] OneSided<DelayedSpring<N>>: false, None, ProfileUse::NONE;
            [const N: usize] DamperWall<N>: false, None, ProfileUse::NONE;
            [const N: usize] Placed<DamperWall<N>>: false, None, ProfileUse::NONE;
            [const N: usize] OneSided<DamperWall<N>>: false, None, ProfileUse::NONE;
            [const N: usize] FilteredWall<N>: false, None, ProfileUse::NONE;
            [const N: usize] Placed<FilteredWall<N>>: false, None, ProfileUse::NONE;
            [const N: usize] OneSided<FilteredWall<N>>: false, None, ProfileUse::NONE;
            [const N: usize] FreeMode<N>: true, None, ProfileUse::NONE;
            [const N: usize] FreeModeWall<DelayedSpring<N>>: true, None, ProfileUse::NONE;
            [const N: usize] FreeModeWall<DamperWall<N>>: true, None, ProfileUse::NONE;
            [const N: usize] FreeModeWall<FilteredWall<N>>: true, None, ProfileUse::NONE;
            [const N: usize] FreeModeWall<OneSided<DelayedSpring<N>>>: true, None, ProfileUse::NONE;
            [const N: usize] FreeModeWall<OneSided<DamperWall<N>>>: true, None, ProfileUse::NONE;
            [const N: usize] FreeModeWall<OneSided<FilteredWall<N>>>: true, None, ProfileUse::NONE;
            [const KNOTS: usize, const N: usize] Profile<KNOTS, N>: false, None, ProfileUse::table(N);
            [const KNOTS: usize, const N: usize] DampedProfile<KNOTS, N>: false, None, ProfileUse::damped(N);
            [const N: usize] ProfileModes<N>: false, None, ProfileUse::modes(N);
            [const KNOTS: usize, const N: usize]
                FreeModeProfile<Profile<KNOTS, N>>: true, None, ProfileUse::sum(N);
            [const KNOTS: usize, const D: usize, const N: usize]
                WallAndProfile<DelayedSpring<D>, Profile<KNOTS, N>>: false, None, ProfileUse::sum(N);
            [const KNOTS: usize, const D: usize, const N: usize]
                WallAndProfile<DamperWall<D>, Profile<KNOTS, N>>: false, None, ProfileUse::sum(N);
            [const KNOTS: usize, const D: usize, const N: usize]
                WallAndProfile<OneSided<DelayedSpring<D>>, Profile<KNOTS, N>>:
                false, None, ProfileUse::sum(N);
            [const KNOTS: usize, const D: usize, const N: usize]
                WallAndProfile<OneSided<DamperWall<D>>, Profile<KNOTS, N>>:
                false, None, ProfileUse::sum(N);
            [const KNOTS: usize, const D: usize, const N: usize]
                FreeModeWallAndProfile<DelayedSpring<D>, Profile<KNOTS, N>>:
                true, None, ProfileUse::sum(N);
            [const KNOTS: usize, const D: usize, const N: usize]
                FreeModeWallAndProfile<DamperWall<D>, Profile<KNOTS, N>>:
                true, None, ProfileUse::sum(N);
            [const KNOTS: usize, const D: usize, const N: usize]
                FreeModeWallAndProfile<OneSided<DelayedSpring<D>>, Profile<KNOTS, N>>:
                true, None, ProfileUse::sum(N);
            [const KNOTS: usize, const D: usize, const N: usize]
                FreeModeWallAndProfile<OneSided<DamperWall<D>>, Profile<KNOTS, N>>:
                true, None, ProfileUse::sum(N);
            [const KNOTS: usize, const N: usize] SnapProfile<KNOTS, N>: false, None, ProfileUse::snap(N);
            [] Rational: false, None, ProfileUse::NONE;
            [] Environment: true, Any, ProfileUse::ANY;
        }
    };
}
pub(crate) use for_every_environment;

/// Traits for this crate's types alone.
mod sealed {
    pub trait Sealed {}
}

mod any;
mod any_wall;
mod composed;
mod composed_data;
mod data;
mod delay_line;
mod free_mode;
mod late;
mod law;
mod matched;
mod model;
mod numbers;
mod profile;
mod rational;
mod stated;
mod turn;
mod uncoupled;
mod velocity;
mod wall_law;
mod walls;

pub use any::{DataLaw, Environment, EnvironmentLaw};
pub use any_wall::Wall;
pub use composed::{
    Composed, ComposedLaw, FreeModeProfile, FreeModeWallAndProfile, WallAndProfile,
    WallAndProfileLaw,
};
pub use delay_line::{DelayLine, FixedDelay, VariableDelay};
pub use free_mode::{FreeMode, FreeModeLaw, FreeModeWall, FreeModeWallLaw};
pub use late::{Delayed, SupportsTiming};
pub use law::{Discretize, Law, LawContext};
pub use matched::{CouplingMemory, Matched, MatchedLaw};
pub use model::{EnvironmentModel, Memory, ProfileUse, StatedEnvironment};
pub use profile::{
    AnyProfile, AnySnap, Cell, DampedProfile, Ends, FULL_SCALE, Holding, KNOB_MODES, KnotTable,
    Knots, Layout, MODES, MOST_KNOTS, Mode, ModeSelection, ModeTable, NoSnap, Outline, Profile,
    ProfileLaw, ProfileMode, ProfileModes, Shape, ShapeError, Snap, SnapPoint, SnapProfile,
};
pub use rational::{Coefficients, Rational, RationalLaw};
pub use stated::{StatedBound, StatedModel};
pub use turn::Turn;
pub use uncoupled::Uncoupled;
pub use velocity::{AnyVelocity, Difference, NoDamping, Velocity, Washout};
pub use wall_law::{AnySide, Centred, Displaced, Face, Side, WallLaw};
pub use walls::{DamperWall, DelayedSpring, FilteredWall, OneSided, Placed, Spring};

pub use crate::parameter::{MAX_DEGREE, MAX_DELAY};
