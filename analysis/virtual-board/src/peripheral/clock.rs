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
    /// Its flags of a power-on, a brown-out and loaded option bytes, beside that of the pin.
    pub flags: [u32; 3],
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
    /// CFGR: the choice of the crystal.
    pub crystal: u32,
    /// CFGR: the choice of the phase-locked loop.
    pub looped: u32,
    /// The phase-locked loop.
    pub pll: Pll,
}

/// PLLCFGR: where it is, and its fields, each by its shift and its bits.
#[derive(Debug)]
pub struct Pll {
    register: u32,
    /// The mask of the source, and its values of the internal oscillator and of the crystal.
    source: [u32; 3],
    /// The input's divider, and the number added to it.
    input: (u32, u32, u64),
    times: (u32, u32),
    /// The output's divider: twice the field plus one.
    output: (u32, u32),
    /// The output's switch; 0 if it has none.
    on: u32,
}

/// The internal oscillator in Hz.
const INTERNAL: u64 = 16_000_000;

impl Pll {
    /// Its output in Hz for a crystal of so many.
    fn locked(&self, value: u32, crystal: u64) -> Option<u64> {
        let field = |shift: u32, bits: u32| u64::from(value >> shift & ((1 << bits) - 1));
        let [mask, internal, external] = self.source;
        let source = match value & mask {
            source if source == internal => INTERNAL,
            source if source == external => crystal,
            _ => 0,
        };
        let (shift, bits, added) = self.input;
        let divider = (field(shift, bits) + added) * 2 * (field(self.output.0, self.output.1) + 1);
        let is_on = value & self.on == self.on;
        (source * field(self.times.0, self.times.1)).checked_div(divider).filter(|_| is_on)
    }
}

/// The G4's (RM0440, 7.4).
pub static G4: Layout = Layout {
    registers: &[
        // CR: both oscillators, the loop, and what watches the crystal.
        (0x00, 0x0000_0500, (1 << 8) | (1 << 16) | (1 << 18) | SECURITY | (1 << 24)),
        // CFGR: the system's clock and the buses' dividers.
        (0x08, 0x0000_0005, 0x0000_3FF3),
        // PLLCFGR.
        (0x0C, 0x0000_1000, 0xFFFF_FFFF),
        // CIFR: no interrupt is enabled.
        (0x1C, 0, 0),
        // The resets: AHB1, AHB2, APB1, APB2.
        (0x28, 0, u32::MAX),
        (0x2C, 0, u32::MAX),
        (0x38, 0, u32::MAX),
        (0x3C, 0, u32::MAX),
        (0x40, 0, u32::MAX),
        // The clocks: AHB1, AHB2, APB1, APB2.
        (0x48, 0x0000_0100, u32::MAX),
        (0x4C, 0, u32::MAX),
        (0x58, 0, u32::MAX),
        (0x5C, 0, u32::MAX),
        (0x60, 0, u32::MAX),
        // CCIPR, CCIPR2: every peripheral at its bus's clock, USART2 also at the system's, which is the same
        // where nothing divides.
        (0x88, 0, 0b01 << 2),
        (0x9C, 0, 0),
        // BDCR: the clock of the day and its reset, which nothing here uses.
        (0x90, 0, (1 << 16) | (1 << 15) | (0b11 << 8)),
        // CSR: the slow oscillator, and forgetting the causes of resets.
        (0x94, 0, 1 | (1 << 23)),
        // CRRCR: the oscillator of 48 MHz.
        (0x98, 0, 1),
    ],
    choice: 0x08,
    causes: 0x94,
    forget: 1 << 23,
    // Of power-on and brown-out it is the same one.
    flags: [1 << 27, 1 << 27, 1 << 25],
    failed: (0x1C, 1 << 8),
    internal: 1,
    switches: &[
        CRYSTAL,
        LOOP,
        // The internal oscillators: of 16 MHz, the slow one, and the one of 48 MHz.
        (0x00, 1 << 8, 1 << 10),
        (0x94, 1, 1 << 1),
        (0x98, 1, 1 << 1),
    ],
    // RM0440, system clock selection, which ST's driver follows: beyond 80 MHz in two steps.
    at_once: 85_000_000,
    slow_bus: 8,
    crystal: 2,
    looped: 3,
    pll: Pll {
        register: 0x0C,
        source: [0b11, 2, 3],
        input: (4, 4, 1),
        times: (8, 7),
        output: (25, 2),
        on: 1 << 24,
    },
};

/// The F405's (RM0090, 7.3).
pub static F405: Layout = Layout {
    registers: &[
        // CR: both oscillators, the loop, and what watches the crystal.
        (0x00, 0x0000_0083, 1 | (1 << 16) | (1 << 18) | SECURITY | (1 << 24)),
        // PLLCFGR.
        (0x04, 0x2400_3010, 0xFFFF_FFFF),
        // CFGR: the system's clock and the buses' dividers.
        (0x08, 0, 0x0000_FCF3),
        // CIR: no interrupt is enabled.
        (0x0C, 0, 0),
        // The resets: AHB1, APB1, APB2.
        (0x10, 0, u32::MAX),
        (0x20, 0, u32::MAX),
        (0x24, 0, u32::MAX),
        // The clocks: AHB1, APB1, APB2.
        (0x30, 0x0010_0000, u32::MAX),
        (0x40, 0, u32::MAX),
        (0x44, 0, u32::MAX),
        // BDCR: the clock of the day and its reset, which nothing here uses.
        (0x70, 0, (1 << 16) | (1 << 15) | (0b11 << 8)),
        // CSR: the slow oscillator, and forgetting the causes of resets.
        (0x74, 0, 1 | (1 << 24)),
        // PLLI2SCFGR, left alone.
        (0x84, 0x2400_3000, 0),
        // DCKCFGR of larger chips of the family: reads as zero here, and the driver leaves it so.
        (0x8C, 0, 0),
    ],
    choice: 0x08,
    causes: 0x74,
    forget: 1 << 24,
    // Power-on is a brown-out, too; option bytes are loaded by any reset, and by no reset of their own.
    flags: [1 << 25 | 1 << 27, 1 << 25, 0],
    failed: (0x0C, 1 << 7),
    internal: 0,
    // With the internal oscillators: of 16 MHz, and the slow one.
    switches: &[CRYSTAL, LOOP, (0x00, 1, 1 << 1), (0x74, 1, 1 << 1)],
    // No bound in RM0090.
    at_once: u64::MAX,
    slow_bus: 10,
    crystal: 1,
    looped: 2,
    pll: Pll {
        register: 0x04,
        source: [1 << 22, 0, 1 << 22],
        input: (0, 6, 0),
        times: (6, 9),
        output: (16, 2),
        on: 0,
    },
};

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
const PIN: u32 = 1 << 26;

impl Layout {
    fn flags_of(&self, cause: Cause) -> u32 {
        let [power, brown_out, option_bytes] = self.flags;
        let flag = match cause {
            Cause::Power => power,
            Cause::BrownOut => brown_out,
            Cause::OptionBytes => option_bytes,
            Cause::Pin => 0,
            Cause::Software => 1 << 28,
            Cause::Watchdog => 1 << 29,
            Cause::WindowWatchdog => 1 << 30,
            Cause::LowPower => 1 << 31,
        };
        PIN | flag
    }
}

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
        clock.remember(layout.flags_of(cause));
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
        let (layout, crystal) = (self.layout, if self.crystal_runs { self.crystal } else { 0 });
        let system = match self.get(layout.choice) & 0b11 {
            choice if choice == layout.internal => INTERNAL,
            choice if choice == layout.crystal => crystal,
            choice if choice == layout.looped && self.get(LOOP.0) & LOOP.1 != 0 => {
                layout.pll.locked(self.get(layout.pll.register), crystal).unwrap_or(0)
            }
            _ => 0,
        };
        system / divider
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
