//! Measurements of a motor board's power stage, as the host receives them.

use crate::current::IndexOffset;

/// The last reading of a power stage, in integers of small units, for the wire.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "wire", derive(serde::Serialize, serde::Deserialize))]
pub struct PowerReading {
    /// Current into the motor in mA, with the sign of its torque.
    pub current: i32,
    /// The current in mA of the servo's last torque. `current` was sampled a little earlier: the two agree if
    /// the torque does not change.
    pub reference: i32,
    /// Voltage of the supply in mV.
    pub voltage: u32,
    /// Temperature at the power stage's sensor in tenths of a degree Celsius.
    pub temperature: i32,
    /// The phase of a brushless motor at its encoder's index, once both are known since the last reset or the last
    /// fault of the index.
    pub index: Option<IndexOffset>,
}
