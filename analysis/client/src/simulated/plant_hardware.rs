//! The simulated hardware of a board: encoder, DAC and timer around a plant.

use haptic_servo::board::sim_hardware::SimIo;
use haptic_servo::dac::DacCode;
use haptic_servo::encoder::RawCount;
use haptic_servo::servo::OutputTiming;

use super::device::PlantIo;

/// The device with its encoder, its DAC and its timer.
pub(super) struct PlantHardware {
    plant: Box<dyn PlantIo + Send>,
    count: i32,
    is_on: bool,
    /// The code that the DAC holds, once a period has begun.
    held: Option<DacCode>,
    /// The code that it holds from the next period on, if the output is latched.
    next: DacCode,
    timing: OutputTiming,
}

impl PlantHardware {
    /// At rest, switched off.
    pub(super) fn new(plant: Box<dyn PlantIo + Send>, timing: OutputTiming) -> Self {
        Self { plant, count: 0, is_on: false, held: None, next: DacCode::MID_SCALE, timing }
    }
}

impl SimIo for PlantHardware {
    fn count(&mut self) -> RawCount {
        if let Some(held) = self.held.replace(self.next) {
            self.plant.hold(if self.is_on { held } else { DacCode::MID_SCALE }.get());
        }
        // A recording that has ended stands still.
        self.count = self.plant.count().unwrap_or(self.count);
        RawCount::from(self.count)
    }

    fn write(&mut self, code: DacCode) {
        self.next = code;
        if self.timing != OutputTiming::Latched {
            self.held = Some(code);
        }
    }

    fn amplifier(&mut self, on: bool) {
        self.is_on = on;
    }
}
