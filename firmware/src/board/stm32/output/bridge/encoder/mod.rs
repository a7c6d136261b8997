//! The encoder at each update of the modulation: the current interrupt takes its count, and passes it to the servo,
//! which it pends at a fixed number of updates.

#[cfg(feature = "magnetic")]
pub mod chip;
#[cfg(not(feature = "magnetic"))]
pub mod quadrature;

use core::sync::atomic::{AtomicU32, Ordering};

use crate::encoder::RawCount;

/// The clock when the count of the present period was read, and that count.
static TIME: AtomicU32 = AtomicU32::new(0);
static COUNT: AtomicU32 = AtomicU32::new(0);

/// Stores the count and the time of a period's beginning.
#[inline(always)]
pub fn begin_period(count: RawCount, now: u32) {
    COUNT.store(count.bits(), Ordering::Relaxed);
    TIME.store(now, Ordering::Relaxed);
}

/// The count at the beginning of the period.
#[inline(always)]
pub fn count() -> RawCount {
    let bits = COUNT.load(Ordering::Relaxed);
    #[cfg(not(feature = "magnetic"))]
    let bits = bits as u16;
    RawCount::from(bits)
}

/// The clock at the beginning of the period. A tick is late if the interrupt of the current loop missed its update.
#[inline(always)]
pub fn period_began() -> u32 {
    TIME.load(Ordering::Relaxed)
}
