//! What the current interrupt sampled last, for the host. It is read far below that interrupt, so that two of its
//! numbers may be of instants that follow each other.

use core::ptr;
use core::sync::atomic::{AtomicPtr, AtomicU32, Ordering};

use super::WAITING;
use crate::current::{CurrentLoop, IndexOffset, Sample};
use crate::dac::DacCode;
use crate::power_reading::PowerReading;

/// The current loop that runs; null before it does.
static CURRENT_LOOP: AtomicPtr<CurrentLoop> = AtomicPtr::new(ptr::null_mut());

/// The current in A, as the bits of an `f32`.
static LATEST_CURRENT: AtomicU32 = AtomicU32::new(0);

/// Counts of the supply in the low half and of the temperature in the high half.
static LATEST_COUNTS: AtomicU32 = AtomicU32::new(0);

/// The offset of the index: its counts, which take 24 bits, whether it is reversed, and whether there is one.
static LATEST_INDEX: AtomicU32 = AtomicU32::new(0);
const IS_REVERSED: u32 = 1 << 30;
const IS_KNOWN: u32 = 1 << 31;

/// Names the current loop whose numbers these are.
pub fn of(current_loop: &'static CurrentLoop) {
    CURRENT_LOOP.store(ptr::from_ref(current_loop).cast_mut(), Ordering::Relaxed);
}

/// Keeps a sample and its current in A: two writes, for the current interrupt.
#[inline(always)]
pub fn keep(sample: &Sample, current: f32) {
    LATEST_CURRENT.store(current.to_bits(), Ordering::Relaxed);
    let counts = u32::from(sample.temperature) << 16 | u32::from(sample.bus);
    LATEST_COUNTS.store(counts, Ordering::Relaxed);
}

/// Keeps the offset of the index, or that none is known.
pub fn keep_index(offset: Option<IndexOffset>) {
    let word = offset.map_or(0, |IndexOffset { counts, is_reversed }| {
        IS_KNOWN | if is_reversed { IS_REVERSED } else { 0 } | counts
    });
    LATEST_INDEX.store(word, Ordering::Relaxed);
}

/// The offset of the index that was kept last.
fn index_offset() -> Option<IndexOffset> {
    let word = LATEST_INDEX.load(Ordering::Relaxed);
    let counts = word & !(IS_KNOWN | IS_REVERSED);
    (word & IS_KNOWN != 0).then_some(IndexOffset { counts, is_reversed: word & IS_REVERSED != 0 })
}

/// The last reading; `None` before the current loop runs.
pub fn power_reading() -> Option<PowerReading> {
    // SAFETY: it is null, or was made of a reference that lives as long as the program.
    let current_loop = unsafe { CURRENT_LOOP.load(Ordering::Relaxed).as_ref() }?;
    let current = f32::from_bits(LATEST_CURRENT.load(Ordering::Relaxed));
    let reference = DacCode::from_low_bits(WAITING.load(Ordering::Relaxed)).offset();
    let counts = LATEST_COUNTS.load(Ordering::Relaxed);
    // The casts take the halves.
    let surroundings = (counts as u16, (counts >> 16) as u16);
    let reading = current_loop.power_reading(current, reference, surroundings);
    Some(PowerReading { index: index_offset(), ..reading })
}
