//! Memory that keeps its contents through a reset: the fault record for the next boot, and a mark that
//! the supply has not been off.

use core::cell::UnsafeCell;
use core::mem::MaybeUninit;

use crate::fault::{Fault, FaultRecord};

/// Words that start-up does not initialise. After a power-off they are noise; [`FaultRecord::decode`]
/// distinguishes noise from a record.
struct Memory<const N: usize>(UnsafeCell<MaybeUninit<[u32; N]>>);

// SAFETY: its words are read and written one by one and volatile. A writer masks, or is about to stop,
// everything that could interleave; a mixture of two records has a wrong checksum.
unsafe impl<const N: usize> Sync for Memory<N> {}

#[unsafe(link_section = ".uninit.retained")]
static MEMORY: Memory<{ FaultRecord::WORDS }> = Memory::noise();

#[unsafe(link_section = ".uninit.retained")]
static MARK: Memory<2> = Memory::noise();

/// The content of [`MARK`] once the supply is on; noise equals it once in 2^64 times.
const IS_ON: [u32; 2] = [0x504F_5745, 0x5220_4F4E];

impl<const N: usize> Memory<N> {
    /// The content at power-on.
    const fn noise() -> Self {
        Self(UnsafeCell::new(MaybeUninit::uninit()))
    }

    fn write(&self, words: &[u32; N]) {
        let first = self.0.get().cast::<u32>();
        for (i, word) in words.iter().enumerate() {
            // SAFETY: inside the memory, which has as many words; see `Memory` for other accesses.
            unsafe { first.add(i).write_volatile(*word) };
        }
    }

    fn read(&self) -> [u32; N] {
        let first = self.0.get().cast::<u32>();
        core::array::from_fn(|i| {
            // SAFETY: inside the memory. Every content of RAM is a valid number: the words of the last run,
            // or noise.
            unsafe { first.add(i).read_volatile() }
        })
    }
}

/// Stores these words; they survive resets.
pub fn store(words: &[u32; FaultRecord::WORDS]) {
    MEMORY.write(words);
}

/// The stored words, or noise.
pub fn stored() -> [u32; FaultRecord::WORDS] {
    MEMORY.read()
}

/// Stores a fault that occurs outside the servo, where the tick is unknown.
pub fn store_fault(fault: Fault) {
    store(&FaultRecord { fault, tick: 0, count: 0 }.encode());
}

/// Whether the supply has stayed on since the last call, judged by RAM, which loses its content without
/// supply. Call it once per boot.
pub fn power_stayed() -> bool {
    let stayed = MARK.read() == IS_ON;
    MARK.write(&IS_ON);
    stayed
}
