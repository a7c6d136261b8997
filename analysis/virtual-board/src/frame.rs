//! The stack frame of the code that an exception interrupts (ARM DDI 0403E, B1.5.6 to B1.5.8).
//!
//! The floating-point registers are stored in the frame at once. A core with lazy stacking stores them only
//! if the handler uses such registers; the only difference is time.

use unicorn_engine::RegisterARM;

use crate::processor::Processor;

/// The status: Thumb.
pub const THUMB: u32 = 1 << 24;

/// Size in bytes of a frame, and of a frame with the floating-point registers.
const SHORT: u32 = 0x20;
const LONG: u32 = 0x68;
/// The frame's status: the stack was moved by a word to align it.
const REALIGNED: u32 = 1 << 9;
/// The common bits of an exception's return word.
const RETURN: u32 = 0xFFFF_FFE1;
/// To the program and not to another exception; without the floating-point registers.
const TO_PROGRAM: u32 = 1 << 3;
const WITHOUT_FLOATING: u32 = 1 << 4;
/// To the stack that exceptions do not use.
const OTHER_STACK: u32 = 1 << 2;

/// The first registers, in this order; after them the next instruction and the status.
const KEPT: [RegisterARM; 6] = [
    RegisterARM::R0,
    RegisterARM::R1,
    RegisterARM::R2,
    RegisterARM::R3,
    RegisterARM::R12,
    RegisterARM::LR,
];

/// The floating-point registers that a frame keeps.
const FLOATING: [RegisterARM; 16] = [
    RegisterARM::S0,
    RegisterARM::S1,
    RegisterARM::S2,
    RegisterARM::S3,
    RegisterARM::S4,
    RegisterARM::S5,
    RegisterARM::S6,
    RegisterARM::S7,
    RegisterARM::S8,
    RegisterARM::S9,
    RegisterARM::S10,
    RegisterARM::S11,
    RegisterARM::S12,
    RegisterARM::S13,
    RegisterARM::S14,
    RegisterARM::S15,
];

/// Pushes a frame on the stack and sets the return word. `nested`: the interrupted code is an exception
/// itself.
pub fn push(core: &mut Processor, nested: bool) {
    let long = core.uses_floating_point();
    let stack = core.register(RegisterARM::MSP);
    let frame = stack.wrapping_sub(if long { LONG } else { SHORT }) & !7;
    let realigned = if stack & 4 != 0 { REALIGNED } else { 0 };
    let mut words = KEPT.map(|register| core.register(register)).to_vec();
    words.push(core.register(RegisterARM::PC));
    words.push(core.register(RegisterARM::XPSR) & !REALIGNED | realigned);
    if long {
        words.extend(FLOATING.map(|register| core.register(register)));
        words.extend([core.register(RegisterARM::FPSCR), 0]);
    }
    let bytes: Vec<u8> = words.into_iter().flat_map(u32::to_le_bytes).collect();
    // An overflowed stack stores nothing; the handler of faults does not rely on it.
    core.set_memory(frame, &bytes);
    let word = if nested { RETURN } else { RETURN | TO_PROGRAM };
    core.set_uses_floating_point(false);
    core.set_register(RegisterARM::MSP, frame);
    core.set_register(RegisterARM::LR, if long { word } else { word | WITHOUT_FLOATING });
}

/// The frame of an exception's return.
pub struct Frame {
    words: Vec<u32>,
    /// The return word.
    word: u32,
    /// The stack pointer before the frame, except for its alignment.
    above: u32,
}

impl Frame {
    /// The frame on the stack for this return word; `None` if it is not a return word, or if there is no
    /// stack.
    pub fn of(core: &Processor, word: u32) -> Option<Self> {
        let is_return = word & !(TO_PROGRAM | WITHOUT_FLOATING) | 1 == RETURN;
        if !is_return || word & OTHER_STACK != 0 {
            return None;
        }
        let stack = core.register(RegisterARM::MSP);
        let size = if word & WITHOUT_FLOATING == 0 { LONG } else { SHORT };
        let bytes = core.memory(stack, size as usize)?;
        let words = bytes
            .chunks_exact(4)
            .map(|word| u32::from_le_bytes([word[0], word[1], word[2], word[3]]))
            .collect();
        Some(Self { words, word, above: stack + size })
    }

    /// Whether it is of the program, and not of another exception.
    pub fn is_of_program(&self) -> bool {
        self.word & TO_PROGRAM != 0
    }

    /// Pops it from the stack and restores the registers.
    pub fn pop(&self, core: &mut Processor) {
        for (register, value) in KEPT.into_iter().zip(&self.words) {
            core.set_register(register, *value);
        }
        let (next, status) = (self.words[6], self.words[7]);
        let long = self.word & WITHOUT_FLOATING == 0;
        if long {
            for (register, value) in FLOATING.into_iter().zip(&self.words[8..]) {
                core.set_register(register, *value);
            }
            core.set_register(RegisterARM::FPSCR, self.words[24]);
        }
        core.set_uses_floating_point(long);
        let realigned = if status & REALIGNED != 0 { 4 } else { 0 };
        core.set_register(RegisterARM::MSP, self.above | realigned);
        core.set_register(RegisterARM::XPSR, status & !REALIGNED);
        core.set_register(RegisterARM::XPSR_G, status & !REALIGNED);
        core.set_register(RegisterARM::FAULTMASK, 0);
        core.set_register(RegisterARM::PC, next | 1);
    }
}
