//! The simulated hardware of a board: encoder, DAC and timer around a plant.

use haptic_model::simulation::device_in_hand::ReadingOutcome;
use haptic_servo::board::sim_hardware::SimIo;
use haptic_servo::dac::DacCode;
use haptic_servo::encoder::RawCount;
use haptic_servo::fault::Fault;
use haptic_servo::magnetic::ReadingError;
use haptic_servo::servo::OutputTiming;
use haptic_servo::servo_loop::BEGAN_LATE;

use super::device::PlantIo;

/// The device with its encoder, its DAC and its timer.
pub(super) struct PlantHardware {
    plant: Box<dyn PlantIo + Send>,
    count: i32,
    /// Periods since the last tick.
    passed: u32,
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
        let next = DacCode::MID_SCALE;
        Self { plant, count: 0, passed: 0, is_on: false, held: None, next, timing }
    }

    /// A period begins; whether it has a tick, which a reading that fails may not have.
    pub(super) fn begin(&mut self) -> bool {
        if let Some(held) = self.held.replace(self.next) {
            self.plant.hold(if self.is_on { held } else { DacCode::MID_SCALE }.get());
        }
        // A recording that has ended stands still.
        self.count = self.plant.count().unwrap_or(self.count);
        self.passed += 1;
        self.plant.reading() != ReadingOutcome::LeftOut
    }
}

impl SimIo for PlantHardware {
    fn count(&mut self) -> RawCount {
        RawCount::from(self.count)
    }

    fn periods_since_last(&mut self) -> u32 {
        match std::mem::take(&mut self.passed) {
            1 if self.reading_fault().is_some() => BEGAN_LATE,
            passed => passed,
        }
    }

    fn reading_fault(&mut self) -> Option<Fault> {
        let ReadingOutcome::Fault(allowed) = self.plant.reading() else { return None };
        let error = ReadingError::Missing as u32;
        Some(Fault::EncoderReading { error, allowed: allowed.into() })
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
