//! The digital-to-analogue converter (DAC), channel 1 (RM0440, 22.7; RM0090, 14.5): a code that is
//! written appears at once, or at the next trigger.

use super::{Access, Unmodelled, only};

/// CR: the channel drives its pin.
const ENABLE: u32 = 1;

/// Where the two families differ.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Layout {
    /// CR: codes wait for a trigger.
    pub triggered: u32,
    /// CR: which trigger, as a field.
    pub trigger: u32,
    /// That field, where it is TIM6's update.
    pub tim6_trigger: u32,
    /// That field, where it is TIM7's update.
    pub tim7_trigger: u32,
    /// Bits of CR that change nothing here.
    pub ignored: u32,
    /// Whether there is a mode register.
    pub has_mode: bool,
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
    triggered: 1 << 1,
    trigger: 0xF << 2,
    tim6_trigger: 7 << 2,
    tim7_trigger: 2 << 2,
    ignored: 0,
    has_mode: true,
};

/// The F405's.
pub const F405: Layout = Layout {
    triggered: 1 << 2,
    trigger: 0b111 << 3,
    tim6_trigger: 0,
    tim7_trigger: 2 << 3,
    ignored: 0,
    has_mode: false,
};

/// MCR of the G4: the range of bus clocks, which has no effect on codes.
const CLOCK_RANGE: u32 = 0b11 << 14;

/// The channel.
#[derive(Clone, Debug)]
pub struct Dac {
    layout: Layout,
    control: u32,
    mode: u32,
    /// What was written last, DHR.
    held: u32,
    /// What the pin is driven with, DOR.
    output: u32,
}

impl Dac {
    /// Out of reset.
    pub fn new(layout: Layout) -> Self {
        Self { layout, control: 0, mode: 0, held: 0, output: 0 }
    }

    /// The code that its pin is driven with; none while it is off.
    pub fn output(&self) -> Option<u16> {
        (self.control & ENABLE != 0).then_some(self.output as u16)
    }

    /// What was written last.
    pub fn held(&self) -> u16 {
        self.held as u16
    }

    /// A timer's update.
    pub fn trigger(&mut self, source: Trigger) {
        let waits = self.control & self.layout.triggered != 0;
        if waits && self.layout.source(self.control) == Some(source) {
            self.output = self.held;
        }
    }

    /// Reads.
    pub fn read(&self, offset: u32) -> Access<u32> {
        match offset {
            0x00 => Ok(self.control),
            0x08 => Ok(self.held),
            0x2C => Ok(self.output),
            0x3C if self.layout.has_mode => Ok(self.mode),
            _ => Err(Unmodelled::Register),
        }
    }

    /// Writes.
    pub fn write(&mut self, offset: u32, value: u32) -> Access<()> {
        let Layout { triggered, trigger, ignored, has_mode, .. } = self.layout;
        match offset {
            0x00 => {
                only(value, ENABLE | triggered | trigger | ignored)?;
                if value & triggered != 0 && self.layout.source(value).is_none() {
                    return Err(Unmodelled::Bits(value & trigger));
                }
                self.control = value;
            }
            0x08 => {
                only(value, 0xFFF)?;
                self.held = value;
            }
            0x3C if has_mode => {
                only(value, CLOCK_RANGE)?;
                self.mode = value;
            }
            _ => return Err(Unmodelled::Register),
        }
        if self.control & ENABLE != 0 && self.control & triggered == 0 {
            self.output = self.held;
        }
        Ok(())
    }
}
