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
mod duty_current;
mod encoder_index;
mod error;
mod fault;
mod follower;
mod heating;
mod modulation;
mod motor;
mod phase;
mod power_stage;
mod program;
mod regeneration;
mod response;
mod supervision;
mod vector;
mod zero_current;

pub use alignment::{Alignment, AlignmentStep};
pub use controller::CurrentController;
pub use current_loop::CurrentLoop;
pub use duty_current::{DutyCurrent, DutyError};
pub use encoder_index::{EncoderIndex, IndexOffset, OffsetCheck};
pub use error::DriveError;
pub use fault::{AlignmentError, PowerFault};
pub use heating::{HeatStep, Heating};
pub use modulation::{Duties, PwmTiming, Sample};
pub use motor::{Drive, Motor, Regeneration, Supply, SupplyRange, Winding};
pub use phase::PhaseAlignment;
pub use power_stage::{B_G431B_ESC1, PowerStage, Thermistor, TripRange};
pub use regeneration::{Bus, Push, RegenerationError, ReturnedEnergy};
pub use response::{CurrentResolution, TorqueResponse, TorqueSource};
pub use vector::sine_and_cosine;
pub use zero_current::{TripCodes, TripSearch};

#[cfg(test)]
mod tests;
