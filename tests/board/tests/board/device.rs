//! A simulated device in a hand, wired to the virtual board.

use analysis::rig::{Plant, SimulatedDevice};
use firmware::dac::DacCode;
use virtual_board::device::Device;

/// A simulated device in a hand that follows its script once it is told to.
pub struct InHand {
    device: SimulatedDevice,
    /// The encoder's position in counts.
    count: i32,
    /// Whether the hand moves, and with it the device.
    pub moving: bool,
}

impl InHand {
    /// The device at rest at zero; the hand waits.
    pub fn new(device: SimulatedDevice) -> Self {
        Self { device, count: 0, moving: false }
    }

    /// The simulated device.
    pub fn device(&self) -> &SimulatedDevice {
        &self.device
    }

    /// The encoder's position in counts.
    pub fn count(&self) -> i32 {
        self.count
    }
}

impl Device for InHand {
    fn sample(&mut self, code: Option<u16>, amplifier: bool) -> i32 {
        if !self.moving {
            return 0;
        }
        // Without an amplifier, or without a level at its input, no torque.
        let code = code.filter(|_| amplifier).unwrap_or(DacCode::MID_SCALE.get());
        self.device.hold(code);
        let count = self.device.count().unwrap_or(self.count);
        let turned = count.wrapping_sub(self.count);
        self.count = count;
        turned
    }
}
