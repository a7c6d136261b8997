//! The system control space (ARM DDI 0403E, B3.2 and B3.4).

use super::exceptions::{
    Exceptions, FIRST_INTERRUPT, HARD_FAULT, INTERRUPTS, Number, PEND_SV, SYS_TICK,
};
use crate::peripheral::{Access, Unmodelled, only};

/// First address of the system control space.
pub const SYSTEM: u32 = 0xE000_E000;

/// AIRCR: the key to write with it, and the value read instead.
const KEY: u32 = 0x05FA;
const KEY_READ: u32 = 0xFA05 << 16;
/// AIRCR: requests a reset.
const RESET_REQUEST: u32 = 1 << 2;
/// AIRCR: the bits of a priority that decide preemption. Zero: all bits.
const GROUPING: u32 = 0b111 << 8;
/// CPACR: full access to the floating-point unit.
const FLOATING_POINT: u32 = 0xF << 20;
/// FPCCR: floating-point registers are saved on exception entry, lazily if possible.
const KEPT: u32 = 0b11 << 30;
/// HFSR: a fault that was escalated.
const FORCED: u32 = 1 << 30;
/// CCR after reset: frames are aligned to 8 bytes.
const ALIGNED_FRAMES: u32 = 1 << 9;
/// CPUID of a Cortex-M4, revision 0, patch 1.
const CPUID: u32 = 0x410F_C241;

/// The registers of the core that are memory to the program.
#[derive(Clone, Debug, Default)]
pub struct System {
    /// Which exceptions are pending and active.
    pub exceptions: Exceptions,
    /// A reset was requested.
    pub reset_requested: bool,
    vectors: u32,
    coprocessors: u32,
    sleep: u32,
    /// CFSR, HFSR.
    faults: (u32, u32),
    fault_address: u32,
}

/// The modelled bits of CFSR.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u32)]
pub enum FaultStatus {
    /// An instruction fetch without memory.
    Fetch = 1 << 8,
    /// A data access without memory, at a known address.
    Data = (1 << 9) | (1 << 15),
    /// An undefined instruction.
    Undefined = 1 << 16,
    /// Not a Thumb instruction, or an invalid return from an exception.
    State = 1 << 17,
}

impl System {
    /// The address of the vector table.
    pub fn vectors(&self) -> u32 {
        self.vectors
    }

    /// Whether a wait for an interrupt continues after the exception that ended it.
    pub fn sleeps_on_exit(&self) -> bool {
        self.sleep & (1 << 1) != 0
    }

    /// Stores a fault and requests its exception, which is the hard fault: the programs enable no other.
    pub fn fault(&mut self, status: FaultStatus, address: u32) {
        self.faults.0 |= status as u32;
        self.faults.1 |= FORCED;
        self.fault_address = address;
        self.exceptions.pend(HARD_FAULT);
    }

    /// Reads a word of the system control space.
    pub fn read(&self, offset: u32) -> Access<u32> {
        Ok(match offset {
            0x100..0x180 => self.bits(offset & 0x7F, Exceptions::is_enabled),
            0x180..0x200 => self.bits(offset & 0x7F, Exceptions::is_enabled),
            0x200..0x280 => self.bits(offset & 0x7F, Exceptions::is_pending),
            0x280..0x300 => self.bits(offset & 0x7F, Exceptions::is_pending),
            0x300..0x380 => self.bits(offset & 0x7F, Exceptions::is_active),
            0xD00 => CPUID,
            0xD04 => self.control_state(),
            0xD08 => self.vectors,
            0xD0C => KEY_READ,
            0xD10 => self.sleep,
            0xD14 => ALIGNED_FRAMES,
            // Only the hard fault is enabled.
            0xD24 => 0,
            0xD28 => self.faults.0,
            0xD2C => self.faults.1,
            0xD34 | 0xD38 => self.fault_address,
            0xD88 => self.coprocessors,
            // No debugger is connected.
            0xDF0 => 0,
            0xF34 => KEPT,
            _ => return Err(Unmodelled::Register),
        })
    }

    /// Writes a word of the system control space.
    pub fn write(&mut self, offset: u32, value: u32) -> Access<()> {
        match offset {
            0x100..0x180 => self.each(offset & 0x7F, value, |e, n| e.enable(n, true)),
            0x180..0x200 => self.each(offset & 0x7F, value, |e, n| e.enable(n, false)),
            0x200..0x280 => self.each(offset & 0x7F, value, Exceptions::pend),
            0x280..0x300 => self.each(offset & 0x7F, value, Exceptions::unpend),
            0xD04 => self.set_control_state(value)?,
            0xD08 => self.vectors = value,
            0xD0C => self.set_control(value)?,
            0xD10 => {
                // Sleep on exit; deep sleep and events of pending interrupts are not modelled.
                only(value, 1 << 1)?;
                self.sleep = value;
            }
            // Written bits are cleared.
            0xD28 => self.faults.0 &= !value,
            0xD2C => self.faults.1 &= !value,
            0xD88 => {
                only(value, FLOATING_POINT)?;
                self.coprocessors = value;
            }
            0xF34 if value == KEPT => {}
            _ => return Err(Unmodelled::Register),
        }
        Ok(())
    }

    /// The priority byte at an offset from the first interrupt's or the system handlers', if there is one:
    /// only these may be accessed by bytes.
    pub fn priority_at(offset: u32) -> Option<Number> {
        match offset {
            0x400..0x5F0 => Some(FIRST_INTERRUPT + (offset - 0x400) as Number),
            // From the memory fault's on.
            0xD18..0xD24 => Some(4 + (offset - 0xD18) as Number),
            _ => None,
        }
    }

    /// ICSR: the pending and active exceptions.
    fn control_state(&self) -> u32 {
        let exceptions = &self.exceptions;
        let pending = (FIRST_INTERRUPT..FIRST_INTERRUPT + INTERRUPTS as Number)
            .find(|&number| exceptions.is_enabled(number) && exceptions.is_pending(number));
        u32::from(exceptions.current().unwrap_or(0))
            | u32::from(exceptions.depth() <= 1) << 11
            | u32::from(pending.unwrap_or(0)) << 12
            | u32::from(pending.is_some()) << 22
            | u32::from(exceptions.is_pending(SYS_TICK)) << 26
            | u32::from(exceptions.is_pending(PEND_SV)) << 28
    }

    fn set_control_state(&mut self, value: u32) -> Access<()> {
        only(value, 0b1111 << 25)?;
        for (bit, number) in [(28, PEND_SV), (26, SYS_TICK)] {
            if value & (1 << bit) != 0 {
                self.exceptions.pend(number);
            }
            if value & (1 << (bit - 1)) != 0 {
                self.exceptions.unpend(number);
            }
        }
        Ok(())
    }

    /// AIRCR.
    fn set_control(&mut self, value: u32) -> Access<()> {
        // Without its key a write has no effect.
        if value >> 16 != KEY {
            return Ok(());
        }
        only(value & 0xFFFF, RESET_REQUEST)?;
        if value & GROUPING != 0 {
            return Err(Unmodelled::Bits(value & GROUPING));
        }
        self.reset_requested |= value & RESET_REQUEST != 0;
        Ok(())
    }

    fn bits(&self, offset: u32, is: fn(&Exceptions, Number) -> bool) -> u32 {
        numbers(offset).enumerate().fold(0, |bits, (bit, number)| {
            bits | u32::from(number.is_some_and(|n| is(&self.exceptions, n))) << bit
        })
    }

    fn each(&mut self, offset: u32, value: u32, act: impl Fn(&mut Exceptions, Number)) {
        for (bit, number) in numbers(offset).enumerate() {
            if let Some(number) = number
                && value & (1 << bit) != 0
            {
                act(&mut self.exceptions, number);
            }
        }
    }
}

/// Whether a write requests this interrupt: ISPR.
pub fn pends(offset: u32, value: u32, interrupt: Number) -> bool {
    let interrupt = u32::from(interrupt);
    offset == 0x200 + 4 * (interrupt / 32) && value >> (interrupt % 32) & 1 != 0
}

/// The interrupts of a word of the controller's bits, lowest first; `None` for bits without an interrupt.
fn numbers(offset: u32) -> impl Iterator<Item = Option<Number>> {
    let first = usize::try_from(offset).unwrap_or(0) * 8;
    (first..first + 32)
        .map(|interrupt| (interrupt < INTERRUPTS).then(|| FIRST_INTERRUPT + interrupt as Number))
}
