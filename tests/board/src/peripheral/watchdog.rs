//! The independent watchdog (RM0440, 43.4; RM0090, 21.4).

use super::{Access, Unmodelled, only};

/// Its oscillator in Hz, as it is on average.
const OSCILLATOR: u64 = 32_000;

/// Values of its key register.
const RELOAD: u32 = 0xAAAA;
const OPEN: u32 = 0x5555;
const START: u32 = 0xCCCC;

/// The watchdog.
#[derive(Clone, Debug)]
pub struct Watchdog {
    open: bool,
    reload: u32,
    /// When it resets the board, once it runs.
    bites: Option<u64>,
}

impl Default for Watchdog {
    fn default() -> Self {
        Self { open: false, reload: 0xFFF, bites: None }
    }
}

impl Watchdog {
    /// When it resets the board unless it is fed.
    pub fn due(&self) -> Option<u64> {
        self.bites
    }

    /// Reads: the registers are taken over at once, so no update is ever under way.
    pub fn read(&self, offset: u32) -> Access<u32> {
        match offset {
            0x08 => Ok(self.reload),
            0x0C => Ok(0),
            _ => Err(Unmodelled::Register),
        }
    }

    /// Writes; `clock` is the core's in Hz.
    pub fn write(&mut self, offset: u32, value: u32, now: u64, clock: u64) -> Access<()> {
        match offset {
            0x00 => match value {
                RELOAD | START => {
                    if value == START || self.bites.is_some() {
                        self.bites = Some(now + self.patience(clock));
                    }
                    self.open = false;
                }
                OPEN => self.open = true,
                _ => return Err(Unmodelled::Bits(value)),
            },
            0x08 if self.open => {
                only(value, 0xFFF)?;
                self.reload = value;
            }
            // Locked: such a write does nothing.
            0x08 => {}
            _ => return Err(Unmodelled::Register),
        }
        Ok(())
    }

    /// Core clocks in which it counts down, by the prescaler of 4 that it has out of reset.
    fn patience(&self, clock: u64) -> u64 {
        4 * (u64::from(self.reload) + 1) * clock / OSCILLATOR
    }
}
