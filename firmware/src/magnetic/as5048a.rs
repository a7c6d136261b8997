//! AS5048A of ams. It predicts nothing: its register 0x3FFF is the plain angle.

use super::as504x::{CLEAR_ERRORS, INTERFACE, check_magnet, decode};
use super::{Chip, Frame};
use crate::encoder::CounterWidth;
use crate::time_range::TimeRange;

/// Reads register 0x3FFD.
const READ_DIAGNOSTICS: Frame = [0x7FFD, 0, 0];

/// AS5048A. Not confirmed: its delay of 91 to 110 us, to which its update adds 89 us; the edge at which it samples;
/// its noise of 2.7 counts; its time to start.
pub const AS5048A: Chip = Chip {
    name: "as5048a",
    width: CounterWidth::Bits14,
    interface: INTERFACE,
    command: [0xFFFF, 0, 0],
    set_up: &[CLEAR_ERRORS],
    diagnosis: Some((READ_DIAGNOSTICS, check_magnet)),
    start_up: 0.02,
    age: TimeRange::between(9.1e-5, 1.99e-4),
    is_period_late: true,
    lag: TimeRange::ZERO,
    frozen_after: Some(100),
    ones_are_angle: false,
    checksum: None,
    decode,
};
