//! The digital-to-analogue converter (DAC), channel 1 (RM0440, 22.7; RM0090, 14.5): a code that is
//! written appears at once, or at the next trigger.

use super::registers::{Registers, Table};
use super::{Access, Unmodelled};

const CR: u32 = 0x00;
const DHR12R1: u32 = 0x08;
const DOR1: u32 = 0x2C;
const MCR: u32 = 0x3C;

/// CR: the channel drives its pin.
const ENABLE: u32 = 1;

/// Where the two families differ.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Layout {
    registers: Table,
    /// CR: codes wait for a trigger.
    pub triggered: u32,
    /// CR: which trigger, as a field.
    pub trigger: u32,
    /// That field, where it is TIM6's update.
    pub tim6_trigger: u32,
    /// That field, where it is TIM7's update.
    pub tim7_trigger: u32,
}

/// Whose update triggers it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Trigger {
    /// The pacing timer's.
    Tim6,
    /// That of the timer a phase behind it.
    Tim7,
}

impl Layout {
    /// The timer that a value of CR names, if it is one of the two.
    fn source(&self, control: u32) -> Option<Trigger> {
        match control & self.trigger {
            field if field == self.tim6_trigger => Some(Trigger::Tim6),
            field if field == self.tim7_trigger => Some(Trigger::Tim7),
            _ => None,
        }
    }
}

/// The G4's.
pub const G4: Layout = Layout {
    registers: &[(CR, 0, ENABLE | 1 << 1 | 0xF << 2), (DHR12R1, 0, 0xFFF), (MCR, 0, CLOCK_RANGE)],
    triggered: 1 << 1,
    trigger: 0xF << 2,
    tim6_trigger: 7 << 2,
    tim7_trigger: 2 << 2,
};

/// The F405's.
pub const F405: Layout = Layout {
    registers: &[(CR, 0, ENABLE | 1 << 2 | 0b111 << 3), (DHR12R1, 0, 0xFFF)],
    triggered: 1 << 2,
    trigger: 0b111 << 3,
    tim6_trigger: 0,
    tim7_trigger: 2 << 3,
};

/// MCR of the G4: the range of bus clocks, which has no effect on codes.
const CLOCK_RANGE: u32 = 0b11 << 14;

/// The channel.
#[derive(Clone, Debug)]
pub struct Dac {
    layout: Layout,
    registers: Registers,
    /// What the pin is driven with.
    output: u32,
}

impl Dac {
    /// Out of reset.
    pub fn new(layout: Layout) -> Self {
        Self { layout, registers: Registers::new(layout.registers), output: 0 }
    }

    /// The code that its pin is driven with; none while it is off.
    pub fn output(&self) -> Option<u16> {
        self.registers.has(CR, ENABLE).then_some(self.output as u16)
    }

    /// What was written last.
    pub fn held(&self) -> u16 {
        self.registers.get(DHR12R1) as u16
    }

    /// A timer's update.
    pub fn trigger(&mut self, source: Trigger) {
        let waits = self.registers.has(CR, self.layout.triggered);
        if waits && self.layout.source(self.registers.get(CR)) == Some(source) {
            self.output = self.held().into();
        }
    }

    /// Reads.
    pub fn read(&self, offset: u32) -> Access<u32> {
        if offset == DOR1 { Ok(self.output) } else { self.registers.read(offset) }
    }

    /// Writes.
    pub fn write(&mut self, offset: u32, value: u32) -> Access<()> {
        let Layout { triggered, trigger, .. } = self.layout;
        self.registers.check(offset, value, 0)?;
        if offset == CR && value & triggered != 0 && self.layout.source(value).is_none() {
            return Err(Unmodelled::Bits(value & trigger));
        }
        self.registers.set(offset, value);
        if self.registers.has(CR, ENABLE) && !self.registers.has(CR, triggered) {
            self.output = self.held().into();
        }
        Ok(())
    }
}
