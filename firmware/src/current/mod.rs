//! The current controller of an on-board power stage: from a code to the compare values of a timer.
//!
//! A [`Drive`] and the [`PowerStage`] of a board become a [`CurrentLoop`] at compile time, or do not compile.
//! A [`CurrentController`] runs it, with one call per instant of the pulse-width modulation. It does not
//! depend on hardware: the flashed code is the tested code (theory, section 15).
//!
//! ```text
//! instant    k                        k+1                      k+2
//!            |                        |                        |
//! current    i(k) sampled             i(k+1) sampled           i(k+2) sampled
//! computed   voltage v(k)             voltage v(k+1)
//! at motor   v(k-1)                   v(k)                     v(k+1)
//! ```
//!
//! The current follows a reference model, which is the amplifier in the certificate: a lag with a gain of 1
//! after a delay of one instant ([`TorqueResponse`]).

mod alignment;
mod controller;
mod current_loop;
mod design;
mod drive;
mod fault;
mod limits;
mod modulation;
mod phase;
mod power_stage;
mod program;
mod regeneration;
mod response;
mod supervision;

pub use alignment::{Alignment, AlignmentStep, tolerance as alignment_tolerance};
pub use controller::CurrentController;
pub use current_loop::CurrentLoop;
pub use drive::{Drive, DriveError, DriveLimits, Motor, Regeneration, Supply, Winding};
pub use fault::{AlignmentError, PowerFault};
pub use modulation::{Duties, PwmTiming, Sample, sine_and_cosine};
pub use phase::{EncoderIndex, IndexOffset, OffsetCheck, PhaseAlignment};
pub use power_stage::{B_G431B_ESC1, PowerStage, SupplyRange, Thermistor, TripRange};
pub use regeneration::{Bus, Push, RegenerationError, ReturnedEnergy};
pub use response::{CurrentResolution, TorqueResponse, TorqueSource};
pub use supervision::{HeatStep, Heating, TripCodes, TripSearch};

/// Whether the program may be for a board's own bridge. The programs of other boards have no code for its heat
/// and for the energy that it returns.
pub(crate) const MAY_HAVE_BRIDGE: bool = cfg!(any(not(target_os = "none"), feature = "bridge"));

#[cfg(test)]
mod tests;
