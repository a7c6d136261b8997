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
                        self.bites = Some(now + self.timeout(clock));
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
    fn timeout(&self, clock: u64) -> u64 {
        4 * (u64::from(self.reload) + 1) * clock / OSCILLATOR
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const KEY: u32 = 0x00;
    const COUNTS: u32 = 0x08;
    /// Core clocks of a count: 4 of the oscillator's.
    const CLOCK: u64 = 168_000_000;
    const COUNT: u64 = CLOCK / 8000;

    fn write(watchdog: &mut Watchdog, now: u64, writes: &[(u32, u32)]) {
        for &(register, value) in writes {
            watchdog.write(register, value, now, CLOCK).unwrap();
        }
    }

    #[test]
    fn it_bites_a_count_after_its_reload_value_and_never_before_it_was_started() {
        let mut watchdog = Watchdog::default();
        write(&mut watchdog, 0, &[(KEY, OPEN), (COUNTS, 65), (KEY, RELOAD)]);
        assert_eq!(watchdog.due(), None);
        write(&mut watchdog, 1000, &[(KEY, START)]);
        assert_eq!(watchdog.due(), Some(1000 + 66 * COUNT));
        write(&mut watchdog, 5000, &[(KEY, RELOAD)]);
        assert_eq!(watchdog.due(), Some(5000 + 66 * COUNT));
    }

    #[test]
    fn its_patience_is_locked_and_taken_over_when_it_is_fed() {
        let mut watchdog = Watchdog::default();
        write(&mut watchdog, 0, &[(KEY, START), (COUNTS, 7)]);
        write(&mut watchdog, 0, &[(KEY, RELOAD)]);
        assert_eq!(watchdog.due(), Some(4096 * COUNT), "locked");
        write(&mut watchdog, 0, &[(KEY, OPEN), (COUNTS, 7)]);
        assert_eq!(watchdog.due(), Some(4096 * COUNT), "not fed yet");
        write(&mut watchdog, 9, &[(KEY, RELOAD), (COUNTS, 9)]);
        assert_eq!(watchdog.due(), Some(9 + 8 * COUNT), "and locked again");
    }
}
