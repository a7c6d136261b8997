//! Critical sections that do not delay the servo.
//!
//! The usual critical section disables all interrupts, and a log line written in one was measured at 5 us and
//! more: a tenth of a period at 20 kHz. Here a critical section raises the base priority, which masks
//! everything except the servo's interrupt and, with a bridge, the current loop's interrupt above it. Neither
//! of them ever enters a critical section: their shared data goes through atomics and lock-free queues.

use core::sync::atomic::{Ordering, compiler_fence};

use cortex_m::register::basepri;
use critical_section::{Impl, RawRestoreState};

/// Priority of the servo's interrupt: the highest except the current loop's.
pub const SERVO: u8 = if cfg!(feature = "bridge") { 1 } else { 0 };

/// Base priority that masks all priorities below the servo's; the chips have four bits of priority, at the
/// top of the byte.
pub const BELOW_SERVO: u8 = (SERVO + 1) << 4;

/// Masks interrupts below the servo.
struct AllButServo;

critical_section::set_impl!(AllButServo);

// SAFETY: there is one core, and only higher priorities interrupt code at the raised base priority. The
// boards give those to the servo's interrupt, to the current loop's above it, and to no other (`lower_all`).
// Nothing that these interrupts call uses a critical section or data that one guards.
unsafe impl Impl for AllButServo {
    unsafe fn acquire() -> RawRestoreState {
        let before = basepri::read();
        // SAFETY: raises the base priority or leaves it unchanged; nested sections find it raised.
        unsafe { basepri::write(BELOW_SERVO) };
        // A pending interrupt finishes before the section's first access.
        cortex_m::asm::isb();
        compiler_fence(Ordering::SeqCst);
        before
    }

    unsafe fn release(before: RawRestoreState) {
        compiler_fence(Ordering::SeqCst);
        // SAFETY: restores the value that `acquire` read, which is zero outside all sections.
        unsafe { basepri::write(before) };
    }
}

/// Sets all interrupts to a priority below the servo's. Call it after all code that sets priorities and
/// before the first interrupt is enabled.
pub fn lower_all(nvic: &mut cortex_m::peripheral::NVIC) {
    for priority in &nvic.ipr {
        // SAFETY: no interrupt is enabled yet, so no order changes.
        unsafe { priority.write(BELOW_SERVO) };
    }
}
