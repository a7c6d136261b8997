//! The device at the board: it turns the encoder and receives the motor's torque.

use std::sync::{Arc, Mutex, PoisonError};

/// What a device is, to the board.
pub trait Device {
    /// A sample ends: the code that the DAC put out from the sample's beginning or from its phase on, and
    /// whether the amplifier was on. Gives the counts that the encoder has turned in it.
    fn sample(&mut self, code: Option<u16>, amplifier: bool) -> i32;

    /// A period of the board's own power stage ends, in s, in which the motor that is wired to it had this
    /// torque in N m as a mean. Gives the motion at its end. Without an implementation, it stands still.
    fn turn(&mut self, torque: f64, seconds: f64) -> Motion {
        let _ = (torque, seconds);
        Motion::default()
    }
}

/// How a device moves.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Motion {
    /// Counts that the encoder has turned since the last time.
    pub counts: i32,
    /// Angle in rad.
    pub angle: f64,
    /// Speed in rad/s.
    pub speed: f64,
}

/// A device that stands still.
#[derive(Clone, Copy, Debug, Default)]
pub struct FixedDevice;

impl Device for FixedDevice {
    fn sample(&mut self, _: Option<u16>, _: bool) -> i32 {
        0
    }
}

/// A device that is shared.
impl<D: Device> Device for Arc<Mutex<D>> {
    fn sample(&mut self, code: Option<u16>, amplifier: bool) -> i32 {
        self.lock().unwrap_or_else(PoisonError::into_inner).sample(code, amplifier)
    }

    fn turn(&mut self, torque: f64, seconds: f64) -> Motion {
        self.lock().unwrap_or_else(PoisonError::into_inner).turn(torque, seconds)
    }
}
