//! Counts instructions.
//!
//! Under `-icount shift=N` each instruction takes 2^N ns of the emulator's time, and the emulated TIM2 counts
//! that time's nanoseconds; so its differences, divided by those of a loop of known length, are numbers of
//! instructions, exact and repeatable. They are instructions, never cycles: the emulator models neither wait
//! states nor the pipeline.

use core::arch::{asm, naked_asm};
use core::sync::atomic::{Ordering, compiler_fence};

pub use super::tick_timer::now;
use super::tick_timer::{COUNTER, now_at};

use crate::number::Number;
use crate::rendering::Rendering;
use crate::scene::Scene;
use crate::servo::{BuildError, Servo, Transducers};

/// The servo of a scene for a measurement. The host has judged the scene; it need not be certified in this
/// number format, because this board has no motor.
///
/// # Errors
/// If this number format cannot represent the scene or the transducers.
#[doc(hidden)]
pub fn uncertified_servo<E: Rendering<N>, N: Number>(
    scene: &Scene<E>,
    transducers: &Transducers,
) -> Result<Servo<E, N>, BuildError> {
    Servo::build(scene, transducers)
}

/// Scale of the counter.
#[derive(Clone, Copy, Debug)]
pub struct Scale {
    /// Counts per instruction.
    pub per_instruction: u32,
    /// Instructions of a [`measurement`](measure) itself.
    pub overhead: u32,
    /// Overhead of the measurement of an interrupt in instructions: an empty interrupt has one
    /// instruction of its own.
    pub around: u32,
}

impl Scale {
    /// Measures a loop of known length, and an empty measurement.
    pub fn calibrate() -> Self {
        let (short, long) = (loop_time(LOOP), loop_time(2 * LOOP));
        // Rounded to the nearest: one of the loops may have one more instruction around it.
        let per_instruction = ((long.wrapping_sub(short) + LOOP) / (2 * LOOP)).max(1);
        let empty = measure(0, |nothing| (nothing, nothing));
        let around = return_time() / per_instruction - 1;
        Self { per_instruction, overhead: empty / per_instruction, around }
    }

    /// The number of instructions in an interval.
    pub fn instructions(&self, time: u32) -> u32 {
        time / self.per_instruction
    }

    /// The number of instructions in an interval measured by [`measure`].
    pub fn measured(&self, time: u32) -> u32 {
        self.instructions(time).saturating_sub(self.overhead)
    }

    /// The number of instructions in an interval measured by [`interrupt`].
    pub fn of_interrupt(&self, time: u32) -> u32 {
        self.instructions(time).saturating_sub(self.around)
    }
}

/// Calls an interrupt's handler, and returns its time, including that of the measurement itself.
#[inline(always)]
pub fn interrupt(handler: extern "C" fn()) -> u32 {
    let start = now();
    handler();
    now().wrapping_sub(start)
}

/// Time of an empty interrupt; in a separate function, so that no other code is measured.
#[inline(never)]
fn return_time() -> u32 {
    interrupt(return_at_once)
}

/// An empty interrupt.
#[unsafe(naked)]
extern "C" fn return_at_once() {
    naked_asm!("bx lr")
}

/// Iterations of the calibration's loop.
const LOOP: u32 = 500;

/// Time of a loop of two instructions per iteration.
fn loop_time(turns: u32) -> u32 {
    let start = now();
    // SAFETY: counts a register down to zero and touches nothing else.
    unsafe { asm!("2:", "subs {0}, {0}, #1", "bne 2b", inout(reg) turns => _) };
    now().wrapping_sub(start)
}

/// Calls `what` with a number, and returns its time, including that of the measurement itself.
///
/// The number is hidden from the optimiser after the first reading, and both results are used before the
/// second, so that no part of the work can be moved out of the measured interval. The servo's interrupt waits
/// meanwhile, no longer than the interrupt itself takes.
#[inline(always)]
pub fn measure(number: u32, what: impl FnOnce(u32) -> (u32, u32)) -> u32 {
    cortex_m::interrupt::free(|_| {
        let mut counter = COUNTER;
        // SAFETY: no instruction; the operand is unchanged. The compiler does not know that the value is a
        // constant; otherwise it would load the constant again within the measured interval.
        unsafe { asm!("/* {0} */", inout(reg) counter) };
        // SAFETY: the address is unchanged.
        let start = unsafe { now_at(counter) };
        let mut number = number;
        // SAFETY: no instruction; the operand is unchanged. The compiler must assume that it accesses memory,
        // so it keeps the data of the work in place.
        unsafe { asm!("/* {0} */", inout(reg) number) };
        let (one, other) = what(number);
        // SAFETY: no instruction; as above, with the results as inputs.
        unsafe { asm!("/* {0} {1} */", in(reg) one, in(reg) other) };
        // SAFETY: the address is unchanged.
        let end = unsafe { now_at(counter) };
        compiler_fence(Ordering::SeqCst);
        end.wrapping_sub(start)
    })
}
