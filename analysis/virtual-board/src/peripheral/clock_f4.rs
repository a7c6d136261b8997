//! The F405's reset and clock control (RM0090, 7.3).

use super::clock::{self, CRYSTAL, Cause, LOOP, Layout, SECURITY};

/// Its registers.
pub const LAYOUT: Layout = Layout {
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
    flags,
    failed: (0x0C, 1 << 7),
    internal: 0,
    // With the internal oscillators: of 16 MHz, and the slow one.
    switches: &[CRYSTAL, LOOP, (0x00, 1, 1 << 1), (0x74, 1, 1 << 1)],
    // No bound in RM0090.
    at_once: u64::MAX,
    slow_bus: 10,
    system,
};

/// Which flags a cause sets: power-on is a brown-out, too.
fn flags(cause: Cause) -> u32 {
    const BROWN_OUT: u32 = clock::PIN | 1 << 25;
    match cause {
        Cause::Power => BROWN_OUT | 1 << 27,
        Cause::BrownOut => BROWN_OUT,
        // Loaded by any reset, and by no reset of their own.
        Cause::Pin | Cause::OptionBytes => clock::PIN,
        Cause::Software => clock::SOFTWARE,
        Cause::Watchdog => clock::WATCHDOG,
        Cause::WindowWatchdog => clock::WINDOW_WATCHDOG,
        Cause::LowPower => clock::LOW_POWER,
    }
}

fn system(register: &dyn Fn(u32) -> u32, crystal: u64) -> Option<u64> {
    const INTERNAL: u64 = 16_000_000;
    let (switches, looped, choice) = (register(0x00), register(0x04), register(0x08));
    let source = if looped & (1 << 22) == 0 { INTERNAL } else { crystal };
    let field = |shift: u32, bits: u32| u64::from(looped >> shift & ((1 << bits) - 1));
    // Input divider, multiplier and the divider of output P.
    let locked = (source * field(6, 9)).checked_div(field(0, 6) * 2 * (field(16, 2) + 1));
    match choice & 0b11 {
        0 => Some(INTERNAL),
        1 => Some(crystal),
        2 if switches & (1 << 24) != 0 => locked,
        _ => None,
    }
}
