//! Memory that keeps its contents through a reset: where a fault's record waits for the next boot.

use core::cell::UnsafeCell;
use core::mem::MaybeUninit;

use crate::fault::{Fault, Retained};

/// The record's words, which start-up leaves as they are. After power was off they are noise, which
/// [`Retained::decode`] tells from a record.
struct Memory(UnsafeCell<MaybeUninit<[u32; Retained::WORDS]>>);

// SAFETY: its words are read and written one by one and volatile. Who writes them holds off or is
// about to stop everything that could interleave; and a record that was mixed with another one has
// a wrong check sum.
unsafe impl Sync for Memory {}

#[unsafe(link_section = ".uninit.retained")]
static MEMORY: Memory = Memory(UnsafeCell::new(MaybeUninit::uninit()));

/// Keeps these words through resets.
pub fn keep(words: &[u32; Retained::WORDS]) {
    let first = MEMORY.0.get().cast::<u32>();
    for (i, word) in words.iter().enumerate() {
        // SAFETY: inside of the memory, which has as many words; see `Memory` for who else may be
        // at it.
        unsafe { first.add(i).write_volatile(*word) };
    }
}

/// The words that were kept, or noise.
pub fn kept() -> [u32; Retained::WORDS] {
    let first = MEMORY.0.get().cast::<u32>();
    core::array::from_fn(|i| {
        // SAFETY: inside of the memory. It is RAM, whose every content is a number: what the last
        // run wrote, or noise.
        unsafe { first.add(i).read_volatile() }
    })
}

/// Keeps a fault that is met outside of the servo, where nobody knows the tick.
pub fn keep_fault(fault: Fault) {
    keep(&Retained { fault, tick: 0, count: 0 }.encode());
}
