//! A piece of code that a board's program does not know, and that holds up one of its interrupts.

use virtual_board::chip::FLASH;
use virtual_board::core::exceptions::{FIRST_INTERRUPT, Number};

use crate::assembly::bytes;
use crate::bench::Bench;

/// What an interrupt does while it is held up.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Masks {
    /// Leaves the others alone.
    None,
    /// Masks all of them.
    All,
}

/// Bytes of it, at the end of flash.
const SIZE: u32 = 32;

/// Holds the serial port's interrupt up for so many instructions before its handler, from the next
/// byte on, which is sent. Gives when it begins.
pub fn hold_up(bench: &mut Bench, instructions: u64, masks: Masks) -> u64 {
    let chip = bench.board().chip();
    let number: Number = FIRST_INTERRUPT + chip.serial_interrupt;
    let at = FLASH + chip.flash - SIZE;
    let handler = bench.machine.divert(number, Some(at));
    let code = stub(instructions, masks, handler);
    assert!(bench.machine.core_mut().set_memory(at, &code));
    let is_active = |bench: &Bench| bench.board().system.exceptions.is_active(number);
    bench.board_mut().send(&[0]);
    while !is_active(bench) {
        bench.run_for(1);
    }
    bench.machine.divert(number, None);
    bench.now()
}

/// The code: two instructions a round, then on to the handler.
fn stub(instructions: u64, masks: Masks, handler: u32) -> Vec<u8> {
    const NOP: u32 = 0xBF00;
    let (mask, unmask) = match masks {
        Masks::None => (NOP, NOP),
        // cpsid i, cpsie i
        Masks::All => (0xB672, 0xB662),
    };
    let mut code = bytes(&[
        mask,
        0x4803, // ldr r0, the rounds
        0x3801, // subs r0, #1
        0xD1FD, // bne to there
        unmask,
        0xF8DF_F008, // ldr pc, the handler
        NOP,
    ]);
    let rounds = (instructions / 2) as u32;
    code.extend([rounds, handler].into_iter().flat_map(u32::to_le_bytes));
    code
}
