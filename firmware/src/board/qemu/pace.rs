//! One tick of the servo a period, paced by SysTick.

use core::future::poll_fn;
use core::sync::atomic::{AtomicU32, Ordering};
use core::task::Poll;

use cortex_m::peripheral::{SYST, syst::SystClkSource};
use embassy_sync::waitqueue::AtomicWaker;

use crate::board::StartError;

/// SysTick's clock in Hz: the emulated F405 runs at its full speed from the start.
const CORE_CLOCK: f64 = 168e6;
/// SysTick counts down from at most this: it has 24 bits.
const LONGEST_RELOAD: u32 = 0xFF_FFFF;

/// Ticks that SysTick has begun and the servo has not.
static DUE: AtomicU32 = AtomicU32::new(0);
/// Wakes the servo.
static SERVO: AtomicWaker = AtomicWaker::new();

/// SysTick's reload value for a period in s.
pub fn reload(period: f64) -> Result<u32, StartError> {
    let longest = (LONGEST_RELOAD as f64 + 1.0) / CORE_CLOCK;
    // Written so that NaN is refused.
    if !(period > 1.5 / CORE_CLOCK && period <= longest) {
        return Err(StartError::Period { period, longest });
    }
    Ok((period * CORE_CLOCK + 0.5) as u32 - 1)
}

/// Begins to pace.
pub fn start(mut timer: SYST, reload: u32) {
    timer.set_clock_source(SystClkSource::Core);
    timer.set_reload(reload);
    timer.clear_current();
    timer.enable_counter();
    timer.enable_interrupt();
}

/// Waits for the next tick; gives the number of ticks that were due, more than one when the servo
/// came late.
pub async fn next() -> u32 {
    poll_fn(|context| {
        SERVO.register(context.waker());
        match DUE.swap(0, Ordering::Relaxed) {
            0 => Poll::Pending,
            due => Poll::Ready(due),
        }
    })
    .await
}

/// A period has begun.
#[cortex_m_rt::exception]
fn SysTick() {
    #[cfg(feature = "log")]
    let start = super::meter::now();
    DUE.fetch_add(1, Ordering::Relaxed);
    SERVO.wake();
    #[cfg(feature = "log")]
    super::meter::INTERRUPT.add(start);
}
