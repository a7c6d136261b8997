//! Torque profiles: torque over angle in straight lines, for detents, end stops, switches and textures.
//!
//! A profile is one table of [`Knots`], built from [`Shape`]s in a constant. It stays in flash, and a tick
//! reads two of its knots, for any shapes. It may be one of several modes that are selected while the servo
//! runs. A profile without ends repeats a whole number of times per turn,
//! and its law counts angles within the turn, so no error accumulates over any number of turns.
//!
//! The torque of a late profile is that of the environment's position `x_E` some samples ago. The torque of
//! an undelayed profile (`DELAY = 0`) is that of the position in front of the coupling, as the hand feels it:
//! `F = g(x)`. If `V g' < 1` this is a profile `f` of `x_E = x - V g(x)` with the slope `g' / (1 - V g')`,
//! solved in advance (theory, section 14).

mod data;
mod knots;
mod law;
mod layout;
mod mode_table;
mod modes;
mod scale;
mod selection;
mod shape;
mod shape_error;
mod snap;
mod sum;

pub use data::Profile;
pub use knots::{Cell, FULL_SCALE, KnotTable, Knots, MOST_KNOTS, Outline, Table};
pub use law::ProfileLaw;
pub use layout::{Ends, Layout, SnapPoint};
pub use mode_table::{ModeTable, ProfileMode};
pub use modes::{KNOB_MODES, MODES, Mode};
pub use selection::ModeSelection;
pub use shape::Shape;
pub use shape_error::ShapeError;
pub use snap::{AnySnap, Holding, NoSnap, Snap};

#[cfg(test)]
mod snap_tests;
#[cfg(test)]
mod tests;
