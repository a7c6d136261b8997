//! The device at the board: it turns the encoder and receives the motor's torque.

use std::sync::{Arc, Mutex, PoisonError};

/// The board's interface to a device.
pub trait Device {
    /// Ends a sample: receives the code that the DAC put out from the sample's beginning or from its phase
    /// on, and whether the amplifier was on. Returns the encoder's counts in the sample.
    fn sample(&mut self, code: Option<u16>, amplifier: bool) -> i32;

    /// Whether the transfers of a magnetic encoder fail from now on, until this is asked again with the next motion.
    fn readings_fail(&self) -> bool {
        false
    }

    /// Ends a period of the board's own power stage, with its duration in s and the motor's mean torque in N
    /// m. Returns the motion at its end. By default the device stands still.
    fn turn(&mut self, torque: f64, seconds: f64) -> Motion {
        let _ = (torque, seconds);
        Motion::default()
    }
}

/// The motion of a device.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Motion {
    /// Counts of the encoder since the last call.
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

/// A shared device.
impl<D: Device> Device for Arc<Mutex<D>> {
    fn sample(&mut self, code: Option<u16>, amplifier: bool) -> i32 {
        self.lock().unwrap_or_else(PoisonError::into_inner).sample(code, amplifier)
    }

    fn turn(&mut self, torque: f64, seconds: f64) -> Motion {
        self.lock().unwrap_or_else(PoisonError::into_inner).turn(torque, seconds)
    }
}
