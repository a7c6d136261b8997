//! Reset and clock control: oscillators that are ready as soon as they are switched on, unless a
//! test keeps one from starting; the clock that follows from it; and who is clocked and reset.

use super::registers::{Registers, Table};
use super::{Access, Unmodelled};

/// What differs between the families.
#[derive(Debug)]
pub struct Layout {
    /// Registers: place, value out of reset, bits that may be written.
    pub registers: Table,
    /// Place of CFGR, which chooses the system's clock.
    pub choice: u32,
    /// The control and status register, with the causes of resets.
    pub causes: u32,
    /// Its bit that forgets them.
    pub forget: u32,
    /// What the causes of resets are called there.
    pub flags: fn(Cause) -> u32,
    /// The register and its bit that say that the crystal has failed.
    pub failed: (u32, u32),
    /// CFGR: the choice of the internal oscillator, which takes over then.
    pub internal: u32,
    /// Switches of clock sources: register, the switch's bit, and the bit that says it is ready.
    pub switches: &'static [(u32, u32, u32)],
    /// The largest clock in Hz that the core may have at once when its source is another; above it the core's
    /// voltage breaks down.
    pub at_once: u64,
    /// CFGR: where it has the slow peripheral bus's divider.
    pub slow_bus: u32,
    /// The system's clock in Hz for a crystal of so many; none where what was chosen does not run.
    pub system: fn(&dyn Fn(u32) -> u32, crystal: u64) -> Option<u64>,
}

/// The switch of the crystal's oscillator.
pub const CRYSTAL: (u32, u32, u32) = (0x00, 1 << 16, 1 << 17);
/// The switch of the phase-locked loop.
pub const LOOP: (u32, u32, u32) = (0x00, 1 << 24, 1 << 25);

/// CSR: the causes of resets.
const CAUSES: u32 = 0xFE00_0000;

/// CR: the clock security system, which watches the crystal.
pub const SECURITY: u32 = 1 << 19;

/// The causes of a reset.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Cause {
    /// Power was switched on.
    Power,
    /// The supply was too low.
    BrownOut,
    /// The reset pin was low.
    Pin,
    /// The program asked for it.
    Software,
    /// The independent watchdog.
    Watchdog,
    /// The window watchdog.
    WindowWatchdog,
    /// A low-power mode that is forbidden.
    LowPower,
    /// The option bytes were loaded.
    OptionBytes,
}

impl Cause {
    /// All values.
    pub const ALL: [Self; 8] = [
        Self::Power,
        Self::BrownOut,
        Self::Pin,
        Self::Software,
        Self::Watchdog,
        Self::WindowWatchdog,
        Self::LowPower,
        Self::OptionBytes,
    ];
}

/// CSR: flags of the causes that both families have, at the same places. Every reset pulls the pin.
pub const PIN: u32 = 1 << 26;
pub(super) const SOFTWARE: u32 = PIN | 1 << 28;
pub(super) const WATCHDOG: u32 = PIN | 1 << 29;
pub(super) const WINDOW_WATCHDOG: u32 = PIN | 1 << 30;
pub(super) const LOW_POWER: u32 = PIN | 1 << 31;

/// The unit.
#[derive(Clone, Debug)]
pub struct Clock {
    layout: &'static Layout,
    registers: Registers,
    crystal: u64,
    /// Whether the crystal runs when it is switched on.
    pub crystal_runs: bool,
}

impl Clock {
    /// Out of reset, with a crystal of so many Hz.
    pub fn new(layout: &'static Layout, crystal: u64, cause: Cause) -> Self {
        let registers = Registers::new(layout.registers);
        let mut clock = Self { layout, registers, crystal, crystal_runs: true };
        clock.remember((layout.flags)(cause));
        clock
    }

    /// The same unit behind a reset: the causes of earlier ones stay until they are forgotten, or the
    /// power was off.
    #[must_use]
    pub fn after_reset(&self, cause: Cause) -> Self {
        let mut clock =
            Self { crystal_runs: self.crystal_runs, ..Self::new(self.layout, self.crystal, cause) };
        if cause != Cause::Power {
            clock.remember(self.causes());
        }
        clock
    }

    /// Adds to the causes of resets.
    fn remember(&mut self, causes: u32) {
        let register = self.layout.causes;
        self.registers.set(register, self.get(register) | causes);
    }

    /// Has the internal oscillator take over where the crystal has stopped and is watched; whether that
    /// has just been so (RM0440, 7.2.10; RM0090, 7.2.7).
    pub fn notice_failure(&mut self) -> bool {
        let (crystal, looped) = (CRYSTAL.1, LOOP.1);
        let switches = self.get(0x00);
        if self.crystal_runs || switches & SECURITY == 0 || switches & crystal == 0 {
            return false;
        }
        // With the crystal goes the loop that it drives.
        self.registers.set(0x00, switches & !crystal & !looped);
        let choice = self.layout.choice;
        self.registers.set(choice, self.get(choice) & !0b11 | self.layout.internal);
        let (register, flag) = self.layout.failed;
        self.registers.set(register, self.get(register) | flag);
        true
    }

    /// The causes of resets that have not been forgotten.
    pub fn causes(&self) -> u32 {
        self.get(self.layout.causes) & CAUSES
    }

    /// The core's clock in Hz; 0 where its source does not run.
    pub fn core(&self) -> u64 {
        let hpre = self.get(self.layout.choice) >> 4 & 0xF;
        let divider = match hpre {
            0..8 => 1,
            8..12 => 1 << (hpre - 7),
            _ => 1 << (hpre - 6),
        };
        let crystal = if self.crystal_runs { self.crystal } else { 0 };
        let system = (self.layout.system)(&|offset| self.get(offset), crystal);
        system.unwrap_or(0) / divider
    }

    /// Whether what the core's clock comes from does not run any longer.
    pub fn has_stopped(&self) -> bool {
        !self.crystal_runs && self.core() == 0
    }

    /// Core clocks for one of the slow peripheral bus.
    pub fn bus_divider(&self) -> u64 {
        let ppre1 = self.get(self.layout.choice) >> self.layout.slow_bus & 0b111;
        if ppre1 < 4 { 1 } else { 1 << (ppre1 - 3) }
    }

    /// Core clocks for one of that bus's timers, which run twice as fast as a divided bus.
    pub fn timer_divider(&self) -> u64 {
        self.bus_divider().div_ceil(2)
    }

    /// Whether a bit of a register that switches peripherals' clocks is set.
    pub fn is_set(&self, offset: u32, bit: u32) -> bool {
        self.get(offset) & (1 << bit) != 0
    }

    /// Reads.
    pub fn read(&self, offset: u32) -> Access<u32> {
        let value = self.with_ready(offset, self.registers.read(offset)?);
        // What runs is what was chosen.
        let runs = if offset == self.layout.choice { (value & 0b11) << 2 } else { 0 };
        Ok(value | runs)
    }

    /// Writes.
    pub fn write(&mut self, offset: u32, value: u32) -> Access<()> {
        let own = self.own(offset);
        self.registers.check(offset, value, own)?;
        let kept = if offset != self.layout.causes {
            value & !own
        } else if value & self.layout.forget != 0 {
            // The bit that forgets does not stay.
            value & !own & !self.layout.forget
        } else {
            value & !own | self.causes()
        };
        let before = self.get(offset);
        self.registers.set(offset, kept);
        let changes_source = offset == self.layout.choice && (before ^ kept) & 0b11 != 0;
        if changes_source && self.core() > self.layout.at_once {
            return Err(Unmodelled::ClockStep);
        }
        Ok(())
    }

    /// A register's bits that the chip itself sets; programs write them back when they change
    /// other bits.
    fn own(&self, offset: u32) -> u32 {
        let choice = if offset == self.layout.choice { 0b1100 } else { 0 };
        let causes = if offset == self.layout.causes { CAUSES } else { 0 };
        self.switches(offset).fold(choice | causes, |own, (_, ready)| own | ready)
    }

    fn get(&self, offset: u32) -> u32 {
        self.registers.get(offset)
    }

    /// A register's switches and the bits that say they are ready.
    fn switches(&self, offset: u32) -> impl Iterator<Item = (u32, u32)> {
        let here = self.layout.switches.iter().filter(move |&&(register, ..)| register == offset);
        here.map(|&(_, on, ready)| (on, ready))
    }

    /// A register with its ready bits.
    fn with_ready(&self, offset: u32, value: u32) -> u32 {
        self.switches(offset).fold(value, |value, (on, ready)| {
            let starts = (offset, on, ready) != CRYSTAL || self.crystal_runs;
            if value & on != 0 && starts { value | ready } else { value & !ready }
        })
    }
}
