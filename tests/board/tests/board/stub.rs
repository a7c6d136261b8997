//! A piece of code that a board's program does not know, and that holds up one of its interrupts.

use virtual_board::core::exceptions::{FIRST_INTERRUPT, Number};

use crate::bench::Bench;

/// What an interrupt does while it is held up.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Masks {
    /// Leaves the others alone.
    None,
    /// Masks all of them.
    All,
}

/// Bytes of it, at the end of RAM.
const SIZE: u32 = 32;

/// Holds the serial port's interrupt up for so many instructions before its handler, from the next
/// byte on, which is sent. Gives when it begins.
pub fn hold_up(bench: &mut Bench, instructions: u64, masks: Masks) -> u64 {
    let chip = bench.machine.board().chip();
    let number: Number = FIRST_INTERRUPT + chip.serial_interrupt;
    let at = 0x2000_0000 + chip.ram - SIZE;
    let handler = bench.machine.divert(number, Some(at));
    let code = stub(instructions, masks, handler);
    assert!(bench.machine.core_mut().set_memory(at, &code));
    let is_active = |bench: &Bench| bench.machine.board().system.exceptions.is_active(number);
    bench.machine.board_mut().send(&[0]);
    while !is_active(bench) {
        bench.run_for(1);
    }
    bench.machine.divert(number, None);
    bench.machine.board().now
}

/// The code: two instructions a round, then on to the handler.
fn stub(instructions: u64, masks: Masks, handler: u32) -> Vec<u8> {
    const NOP: u16 = 0xBF00;
    let (mask, unmask) = match masks {
        Masks::None => (NOP, NOP),
        // cpsid i, cpsie i
        Masks::All => (0xB672, 0xB662),
    };
    let code = [
        mask, // ldr r0, the rounds; subs r0, #1; bne to there
        0x4803, 0x3801, 0xD1FD, unmask, // ldr pc, the handler
        0xF8DF, 0xF008, NOP,
    ];
    let words = [(instructions / 2) as u32, handler];
    let code = code.into_iter().flat_map(u16::to_le_bytes);
    code.chain(words.into_iter().flat_map(u32::to_le_bytes)).collect()
}
