//! The last samples of the current interrupt, for the host. They are read at a much lower priority, so two of
//! the numbers may be of consecutive instants.

use core::ptr;
use core::sync::atomic::{AtomicPtr, AtomicU32, Ordering};

use super::WAITING;
use crate::current::{CurrentLoop, IndexOffset, Sample};
use crate::dac::DacCode;
use crate::power_reading::PowerReading;

/// The running current loop; null before it runs.
static CURRENT_LOOP: AtomicPtr<CurrentLoop> = AtomicPtr::new(ptr::null_mut());

/// The current in A, as the bits of an `f32`.
static LATEST_CURRENT: AtomicU32 = AtomicU32::new(0);

/// Counts of the supply in the low half and of the temperature in the high half.
static LATEST_COUNTS: AtomicU32 = AtomicU32::new(0);

/// The offset of the index: its counts (24 bits), whether it is reversed, and whether it is known.
static LATEST_INDEX: AtomicU32 = AtomicU32::new(0);
const IS_REVERSED: u32 = 1 << 30;
const IS_KNOWN: u32 = 1 << 31;

/// Sets the current loop of these numbers.
pub fn of(current_loop: &'static CurrentLoop) {
    CURRENT_LOOP.store(ptr::from_ref(current_loop).cast_mut(), Ordering::Relaxed);
}

/// Stores a sample and its current in A: two writes, by the current interrupt.
#[inline(always)]
pub fn keep(sample: &Sample, current: f32) {
    LATEST_CURRENT.store(current.to_bits(), Ordering::Relaxed);
    let counts = u32::from(sample.temperature) << 16 | u32::from(sample.bus);
    LATEST_COUNTS.store(counts, Ordering::Relaxed);
}

/// Stores the offset of the index, or `None` if it is unknown.
pub fn keep_index(offset: Option<IndexOffset>) {
    let word = offset.map_or(0, |IndexOffset { counts, is_reversed }| {
        IS_KNOWN | if is_reversed { IS_REVERSED } else { 0 } | counts
    });
    LATEST_INDEX.store(word, Ordering::Relaxed);
}

/// The last stored offset of the index.
fn index_offset() -> Option<IndexOffset> {
    let word = LATEST_INDEX.load(Ordering::Relaxed);
    let counts = word & !(IS_KNOWN | IS_REVERSED);
    (word & IS_KNOWN != 0).then_some(IndexOffset { counts, is_reversed: word & IS_REVERSED != 0 })
}

/// The last reading; `None` before the current loop runs.
pub fn power_reading() -> Option<PowerReading> {
    // SAFETY: it is null, or comes from a reference that is valid as long as the program runs.
    let current_loop = unsafe { CURRENT_LOOP.load(Ordering::Relaxed).as_ref() }?;
    let current = f32::from_bits(LATEST_CURRENT.load(Ordering::Relaxed));
    let reference = DacCode::from_low_bits(WAITING.load(Ordering::Relaxed)).offset();
    let counts = LATEST_COUNTS.load(Ordering::Relaxed);
    // The casts take the halves.
    let surroundings = (counts as u16, (counts >> 16) as u16);
    let reading = current_loop.power_reading(current, reference, surroundings);
    Some(PowerReading { index: index_offset(), ..reading })
}
