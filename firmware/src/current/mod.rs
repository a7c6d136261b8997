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
mod alignment_error;
mod controller;
mod current_loop;
mod current_sense;
mod duty_current;
mod encoder_index;
mod error;
mod fault;
mod follower;
mod heating;
mod index_check;
mod indexed_loop;
mod motion;
mod motor;
mod offset;
mod offset_check;
mod phase;
mod plant;
mod power_stage;
mod program;
mod reading;
mod regeneration;
mod resolution;
mod sample;
mod sine_table;
mod speed;
mod supervision;
mod surroundings;
mod thermistor;
mod timing;
mod trip_search;
mod vector;

pub use alignment::{Alignment, AlignmentStep};
pub use alignment_error::AlignmentError;
pub use controller::CurrentController;
pub use current_loop::{CurrentLoop, OVER_CURRENT, TorqueResponse};
pub use duty_current::{DutyCurrent, DutyError};
pub use encoder_index::{EncoderIndex, IndexOffset};
pub use error::DriveError;
pub use fault::PowerFault;
pub use heating::{HeatStep, Heating};
pub use motion::TorqueSource;
pub use motor::{Drive, Motor, Regeneration, Supply, SupplyRange, Winding};
pub use offset_check::OffsetCheck;
pub use phase::PhaseAlignment;
pub use power_stage::{B_G431B_ESC1, PowerStage};
pub use regeneration::{Bus, Push, RegenerationError, ReturnedEnergy};
pub use resolution::CurrentResolution;
pub use sample::{Duties, Sample};
pub use sine_table::sine_and_cosine;
pub use thermistor::Thermistor;
pub use timing::PwmTiming;
pub use trip_search::{TripCodes, TripRange, TripSearch};

#[cfg(test)]
mod tests;
