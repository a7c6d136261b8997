//! Instructions skipped by an IT block (ARM DDI 0403E, A7.3): the engine does not report them, but a core
//! needs a clock for each.

/// Largest number of instructions in a block.
const LONGEST: u32 = 4;
/// Largest distance in bytes from a block's beginning to its last instruction.
const TO_LAST: u32 = 2 + 4 * (LONGEST - 1);
/// Largest number of bytes skipped at once.
const SKIPPED: u32 = 4 * LONGEST;

/// Addresses of the last instructions, to find the IT block of a skipped instruction.
#[derive(Clone, Copy, Debug, Default)]
pub struct PcHistory {
    /// The latest addresses, at their numbers modulo the length.
    places: [u32; 8],
    /// Number of instructions so far.
    count: usize,
    /// Number of instructions at the last jump.
    jumped: usize,
    /// Expected address of the next instruction, without a jump or a skip.
    next: u32,
}

impl PcHistory {
    /// Address of the latest instruction.
    pub fn latest(&self) -> u32 {
        self.place(self.count.wrapping_sub(1))
    }

    /// Whether an instruction there follows the last one, so that nothing was skipped.
    #[inline]
    pub fn is_next(&self, address: u32) -> bool {
        address == self.next
    }

    /// Records an executed instruction with its size in bytes.
    #[inline]
    pub fn push(&mut self, address: u32, size: u32) {
        self.places[self.count % self.places.len()] = address;
        self.count += 1;
        self.next = address + size;
    }

    /// Number of skipped instructions before an instruction that does not follow the last; `read` returns the
    /// program from an address on. 0: a jump.
    pub fn skip(&mut self, address: u32, read: impl FnOnce(u32, &mut [u8])) -> u64 {
        let skipped = self.skipped(address, read);
        if skipped == 0 {
            self.jumped = self.count;
        }
        skipped
    }

    /// Number of instructions from the expected address up to `address`, if a block extends that far.
    fn skipped(&self, address: u32, read: impl FnOnce(u32, &mut [u8])) -> u64 {
        // Skipped instructions are always ahead and near.
        if address.wrapping_sub(self.next) > SKIPPED {
            return 0;
        }
        // Instructions since the last jump that are near enough to be the beginning of the block.
        let near = self.next.saturating_sub(TO_LAST);
        let since = (self.jumped..self.count).rev().map(|number| self.place(number));
        let candidates = since.take(LONGEST as usize + 1).take_while(|&at| at >= near);
        let Some(from) = candidates.clone().last() else { return 0 };
        let mut code = [0; (TO_LAST + SKIPPED) as usize];
        let code = &mut code[..(address - from) as usize];
        read(from, code);
        let half = |at: u32| {
            let at = (at - from) as usize;
            u16::from_le_bytes([code[at], code[at + 1]])
        };
        let Some(block) = candidates.into_iter().find(|&at| length(half(at)) > 0) else { return 0 };
        let (mut at, mut skipped) = (block + 2, 0);
        for _ in 0..length(half(block)) {
            if at >= address {
                break;
            }
            skipped += u64::from(at >= self.next);
            at += if is_long(half(at)) { 4 } else { 2 };
        }
        // Only a jump leads beyond the block.
        if address <= at { skipped } else { 0 }
    }

    /// Address of the instruction with this number.
    fn place(&self, number: usize) -> u32 {
        self.places[number % self.places.len()]
    }
}

/// Number of instructions in the block of an IT instruction; 0 for others.
fn length(instruction: u16) -> u32 {
    if instruction & 0xFF00 != 0xBF00 || instruction & 0xF == 0 {
        return 0;
    }
    4 - u32::from(instruction & 0xF).trailing_zeros()
}

/// Whether an instruction that begins so is of 32 bits (A5.1).
fn is_long(half: u16) -> bool {
    half >= 0xE800
}

#[cfg(test)]
mod tests {
    use super::*;

    /// `itte eq`, an instruction of 4 bytes, one of 2, one of 4, and what follows.
    const PROGRAM: [u16; 8] = [0xBF06, 0xF04F, 0x0001, 0x2002, 0xF04F, 0x0003, 0x4770, 0xBF00];

    fn read(from: u32, bytes: &mut [u8]) {
        for (byte, at) in bytes.iter_mut().zip(from as usize..) {
            *byte = PROGRAM[at / 2].to_le_bytes()[at % 2];
        }
    }

    fn skipped(run: &[(u32, u32)]) -> Vec<u64> {
        let mut history = PcHistory::default();
        let mut step = |&(address, size)| {
            let follows = history.is_next(address);
            let skipped = if follows { 0 } else { history.skip(address, read) };
            history.push(address, size);
            skipped
        };
        run.iter().map(&mut step).collect()
    }

    #[test]
    fn what_a_block_skips_is_counted() {
        // The condition holds: the last is skipped. It does not: the first two are.
        assert_eq!(skipped(&[(0, 2), (2, 4), (6, 2), (12, 2)]), [0, 0, 0, 1]);
        assert_eq!(skipped(&[(0, 2), (8, 4), (12, 2)]), [0, 2, 0]);
        assert_eq!(skipped(&[(0, 2), (12, 2)]), [0, 3]);
    }

    #[test]
    fn jumps_skip_nothing() {
        assert_eq!(skipped(&[(0, 2), (14, 2)]), [0, 0], "further than the block goes");
        assert_eq!(skipped(&[(0, 2), (2, 4), (6, 2), (8, 4), (14, 2)]), [0; 5]);
        // Into the block from elsewhere, then forwards.
        assert_eq!(skipped(&[(0, 2), (2, 4), (0x1000, 2), (6, 2), (12, 2)]), [0; 5]);
    }
}
