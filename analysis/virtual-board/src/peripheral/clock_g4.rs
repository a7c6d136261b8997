//! The G4's reset and clock control (RM0440, 7.4).

use super::clock::{self, CRYSTAL, Cause, LOOP, Layout, SECURITY};

/// Its registers.
pub const LAYOUT: Layout = Layout {
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
    flags,
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
    system,
};

/// Which flags a cause sets: of power-on and brown-out it is the same one.
fn flags(cause: Cause) -> u32 {
    match cause {
        Cause::Power | Cause::BrownOut => clock::PIN | 1 << 27,
        Cause::OptionBytes => clock::PIN | 1 << 25,
        Cause::Pin => clock::PIN,
        Cause::Software => clock::SOFTWARE,
        Cause::Watchdog => clock::WATCHDOG,
        Cause::WindowWatchdog => clock::WINDOW_WATCHDOG,
        Cause::LowPower => clock::LOW_POWER,
    }
}

fn system(register: &dyn Fn(u32) -> u32, crystal: u64) -> Option<u64> {
    const INTERNAL: u64 = 16_000_000;
    let (switches, choice, looped) = (register(0x00), register(0x08), register(0x0C));
    let source = match looped & 0b11 {
        2 => INTERNAL,
        3 => crystal,
        _ => 0,
    };
    let field = |shift: u32, bits: u32| u64::from(looped >> shift & ((1 << bits) - 1));
    // Input divider, multiplier and the divider of output R.
    let locked = source / (field(4, 4) + 1) * field(8, 7) / (2 * (field(25, 2) + 1));
    match choice & 0b11 {
        1 => Some(INTERNAL),
        2 => Some(crystal),
        3 if switches & (1 << 24) != 0 && looped & (1 << 24) != 0 => Some(locked),
        _ => None,
    }
}
