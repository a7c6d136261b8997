//! Memory that keeps its contents through a reset: the fault record for the next boot, and a mark that
//! the supply has not been off.

use core::cell::UnsafeCell;
use core::mem::MaybeUninit;

use crate::fault::{Fault, FaultRecord};

/// Words which start-up leaves as they are. After power was off they are noise, which
/// [`FaultRecord::decode`] tells from a record.
struct Memory<const N: usize>(UnsafeCell<MaybeUninit<[u32; N]>>);

// SAFETY: its words are read and written one by one and volatile. Who writes them holds off or is
// about to stop everything that could interleave; and a record that was mixed with another one has
// a wrong check sum.
unsafe impl<const N: usize> Sync for Memory<N> {}

#[unsafe(link_section = ".uninit.retained")]
static MEMORY: Memory<{ FaultRecord::WORDS }> = Memory::noise();

#[unsafe(link_section = ".uninit.retained")]
static MARK: Memory<2> = Memory::noise();

/// What [`MARK`] holds once the supply is on, whose digits noise has once in 2^64 times.
const IS_ON: [u32; 2] = [0x504F_5745, 0x5220_4F4E];

impl<const N: usize> Memory<N> {
    /// As it is at power-on.
    const fn noise() -> Self {
        Self(UnsafeCell::new(MaybeUninit::uninit()))
    }

    fn write(&self, words: &[u32; N]) {
        let first = self.0.get().cast::<u32>();
        for (i, word) in words.iter().enumerate() {
            // SAFETY: inside of the memory, which has as many words; see `Memory` for who else may be
            // at it.
            unsafe { first.add(i).write_volatile(*word) };
        }
    }

    fn read(&self) -> [u32; N] {
        let first = self.0.get().cast::<u32>();
        core::array::from_fn(|i| {
            // SAFETY: inside of the memory. It is RAM, whose every content is a number: what the last
            // run wrote, or noise.
            unsafe { first.add(i).read_volatile() }
        })
    }
}

/// Stores these words through resets.
pub fn store(words: &[u32; FaultRecord::WORDS]) {
    MEMORY.write(words);
}

/// The stored words, or noise.
pub fn stored() -> [u32; FaultRecord::WORDS] {
    MEMORY.read()
}

/// Stores a fault that occurs outside of the servo, where the tick is not known.
pub fn store_fault(fault: Fault) {
    store(&FaultRecord { fault, tick: 0, count: 0 }.encode());
}

/// Whether the supply has stayed on since this was last asked, as far as RAM can tell: it forgets once
/// the supply is gone. To be asked once a boot.
pub fn power_stayed() -> bool {
    let stayed = MARK.read() == IS_ON;
    MARK.write(&IS_ON);
    stayed
}
