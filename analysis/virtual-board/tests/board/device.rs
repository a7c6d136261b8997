//! The device at the virtual board.

use std::collections::VecDeque;

use analysis::lockstep::PlantIo;
use analysis::program::Program;
use virtual_board::device::{Device, Motion};

use crate::bench::MID_SCALE;

/// What one sample was at the pins.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Sample {
    /// What the DAC put out during it.
    pub code: Option<u16>,
    /// Whether the amplifier was on at its end.
    pub amplifier: bool,
    /// The encoder's position at its end, in counts.
    pub count: i32,
}

/// The connections of the pins: a device, and a test that observes it and may turn the encoder itself.
pub struct Pins {
    device: Box<dyn Device + Send>,
    /// Turns of the encoder that are still to come, one a sample, in place of the device's.
    pub turns: VecDeque<i32>,
    /// All samples so far.
    pub samples: Vec<Sample>,
    /// The encoder's position in counts.
    pub count: i32,
    /// Whether the encoder is plugged in.
    pub plugged: bool,
}

impl Pins {
    /// A device at rest at zero.
    pub fn of(device: impl Device + Send + 'static) -> Self {
        Self {
            device: Box::new(device),
            turns: VecDeque::new(),
            samples: Vec::new(),
            count: 0,
            plugged: true,
        }
    }
}

impl Device for Pins {
    fn sample(&mut self, code: Option<u16>, amplifier: bool) -> i32 {
        let turned = self.device.sample(code, amplifier);
        let turned = self.turns.pop_front().unwrap_or(turned);
        let turned = if self.plugged { turned } else { 0 };
        self.count += turned;
        self.samples.push(Sample { code, amplifier, count: self.count });
        turned
    }

    fn turn(&mut self, torque: f64, seconds: f64) -> Motion {
        let motion = self.device.turn(torque, seconds);
        let counts = if self.plugged { motion.counts } else { 0 };
        self.count += counts;
        Motion { counts, ..motion }
    }
}

/// A simulated device in a hand that follows its script once the amplifier is on.
pub struct HandHeldDevice {
    device: Box<dyn PlantIo + Send>,
    /// The encoder's position in counts.
    count: i32,
    begun: bool,
}

impl HandHeldDevice {
    /// A program's device, in the hand that shows it, at rest at zero.
    pub fn of(program: &Program) -> Self {
        Self::with(program.device())
    }

    /// A simulated device at rest at zero.
    pub fn with(device: impl PlantIo + Send + 'static) -> Self {
        Self { device: Box::new(device), count: 0, begun: false }
    }
}

impl Device for HandHeldDevice {
    fn sample(&mut self, code: Option<u16>, amplifier: bool) -> i32 {
        self.begun |= amplifier;
        if !self.begun {
            return 0;
        }
        // Without an amplifier, or without a level at its input, no torque.
        self.device.hold(code.filter(|_| amplifier).unwrap_or(MID_SCALE));
        let count = self.device.count().unwrap_or(self.count);
        count - std::mem::replace(&mut self.count, count)
    }
}
