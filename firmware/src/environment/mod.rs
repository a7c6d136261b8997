//! Virtual environments: position `x_E` (rad) to torque `F` (N m).
//!
//! Sign: `F` is the torque that the environment exerts *on the coupling* against positive
//! deflection, so the motor applies `-F` to the device. A spring is `F = stiffness * x_E`.
//!
//! An environment is a sum of [`Parts`], each of them at most once. [`Environment`] is such a sum or one of a few
//! others as data, for the certificate, for files and for the wire. A program's environment is
//! [`Typed`](crate::scene_type::Typed), a type that is computed from its scene, so that a program only contains the code of its scene.
//! [`Discretize`] turns an environment into its [`Law`], which the servo runs. Another crate can define a
//! [`StatedEnvironment`].

mod anticogging;
mod any;
mod any_law;
mod canceller;
mod delay_line;
mod drag;
mod late;
mod late_velocity;
mod law;
mod model;
mod numbers;
mod parts;
mod profile;
mod rational;
mod stated;
mod sum_law;
mod turn;
mod velocity;
mod wall;
mod wall_law;

pub use anticogging::{
    Anticogging, AnticoggingLaw, CoggingError, CoggingMap, Compensation, NoAnticogging,
};
pub use any::Environment;
pub use any_law::AnyLaw;
pub use canceller::{Canceller, CancellerLaw};
pub use delay_line::{DelayLine, FixedDelay, VariableDelay};
pub use drag::{Drag, DragLaw};
pub use late::{Delayed, SupportsTiming};
pub use late_velocity::LateVelocity;
pub use law::{AnyPart, Discretize, Law, LawContext, LawOf};
pub use model::{EnvironmentModel, Memory, ProfileUse, StatedEnvironment};
pub(crate) use model::{is_late, sealed};
pub use parts::{PartSet, Parts};
pub use profile::{
    AnySnap, Cell, Ends, FULL_SCALE, Holding, KNOB_MODES, KnotTable, Knots, Layout, MODES,
    MOST_KNOTS, Mode, ModeSelection, ModeTable, NoSnap, Outline, Profile, ProfileLaw, ProfileMode,
    Shape, ShapeError, Snap, SnapPoint, Table,
};
pub use rational::{Coefficients, Rational, RationalLaw};
pub use stated::{StatedBound, StatedModel};
pub use sum_law::{AnySumLaw, Part, SumLaw};
pub use turn::Turn;
pub use velocity::{AnyVelocity, Difference, NoDamping, Velocity, Washout};
pub use wall::{Damper, Side, Wall};
pub use wall_law::{AnyPlace, Centred, Displaced, Face, Place, WallLaw};

pub use crate::parameter::{MAX_DEGREE, MAX_DELAY};
