//! Critical sections that do not hold up the servo.
//!
//! The usual critical section switches all interrupts off, and a log line written in one has been measured at
//! 5 us and more: at 20 kHz a tenth of a period. Here it raises the base priority, which holds off everything
//! but the servo's interrupt, and where a bridge drives the motor, the current loop's above it. Neither ever
//! enters a critical section: their shared data goes through atomics and lock-free queues.

use core::sync::atomic::{Ordering, compiler_fence};

use cortex_m::register::basepri;
use critical_section::{Impl, RawRestoreState};

/// Priority of the servo's interrupt: the highest but for the current loop's.
pub const SERVO: u8 = if cfg!(feature = "bridge") { 1 } else { 0 };

/// Holds off all priorities below the servo's; the chips have four bits of priority, at the top of the byte.
pub const BELOW_SERVO: u8 = (SERVO + 1) << 4;

/// Masks interrupts below the servo.
struct AllButServo;

critical_section::set_impl!(AllButServo);

// SAFETY: with one core, what runs at the raised base priority is interrupted by higher priorities only.
// The boards give those to the servo's interrupt, to the current loop's above it, and to no other
// (`lower_all`), and nothing that these interrupts call uses a critical section or what one guards.
unsafe impl Impl for AllButServo {
    unsafe fn acquire() -> RawRestoreState {
        let before = basepri::read();
        // SAFETY: raises the base priority or leaves it; nested sections see it raised.
        unsafe { basepri::write(BELOW_SERVO) };
        // An interrupt that was about to begin is through before the section's first access.
        cortex_m::asm::isb();
        compiler_fence(Ordering::SeqCst);
        before
    }

    unsafe fn release(before: RawRestoreState) {
        compiler_fence(Ordering::SeqCst);
        // SAFETY: what `acquire` found, which is zero outside of all sections.
        unsafe { basepri::write(before) };
    }
}

/// Lowers all interrupts below the servo's. Call it after all code that sets priorities and before
/// the first interrupt is enabled.
pub fn lower_all(nvic: &mut cortex_m::peripheral::NVIC) {
    for priority in &nvic.ipr {
        // SAFETY: no interrupt is enabled yet whose order this could change.
        unsafe { priority.write(BELOW_SERVO) };
    }
}
