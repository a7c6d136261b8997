//! The simulated hardware of a board.

use firmware::board::in_time::Lines;
use firmware::dac::DacCode;
use firmware::encoder::RawCount;
use firmware::servo::OutputTiming;

use crate::rig::Plant;

/// The device with its encoder, its converter and its timer.
pub(super) struct Board {
    plant: Box<dyn Plant + Send>,
    count: i32,
    is_on: bool,
    /// What the converter holds, once a period has begun.
    held: Option<DacCode>,
    /// What it holds from the next period on, where that is what a code waits for.
    next: DacCode,
    timing: OutputTiming,
}

impl Board {
    /// At rest, switched off.
    pub(super) fn new(plant: Box<dyn Plant + Send>, timing: OutputTiming) -> Self {
        Self { plant, count: 0, is_on: false, held: None, next: DacCode::MID_SCALE, timing }
    }
}

impl Lines for Board {
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
