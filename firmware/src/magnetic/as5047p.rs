//! AS5047P of ams, by its register 0x3FFE, the angle without the prediction from the velocity (DAEC).
//!
//! Register 0x3FFF, which the chip also gives with its data input tied high, predicts: it has no certificate. So this
//! chip needs the wire of its data input.

use super::as504x::{CLEAR_ERRORS, INTERFACE, check_magnet, decode};
use super::{Chip, Frame};
use crate::encoder::CounterWidth;
use crate::time_range::TimeRange;

/// Reads register 0x3FFC.
const READ_DIAAGC: Frame = [0xFFFC, 0, 0];

/// AS5047P. Not confirmed: its delay of 90 to 112 us; the edge at which it samples; its noise of about 3 counts; its
/// time to start; that bit 0 of its settings is to be written as 1, as it is delivered.
pub const AS5047P: Chip = Chip {
    name: "as5047p",
    width: CounterWidth::Bits14,
    interface: INTERFACE,
    command: [0x7FFE, 0, 0],
    // Writes DAECDIS, bit 4 of SETTINGS1 at 0x18, so that no register predicts.
    set_up: &[CLEAR_ERRORS, [0x0018, 0, 0], [0x0011, 0, 0]],
    diagnosis: Some((READ_DIAAGC, check_magnet)),
    start_up: 0.02,
    age: TimeRange::between(9e-5, 1.12e-4),
    is_period_late: true,
    lag: TimeRange::ZERO,
    frozen_after: Some(100),
    ones_are_angle: false,
    checksum: None,
    decode,
};
