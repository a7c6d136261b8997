//! Counts instructions.
//!
//! Under `-icount shift=N` each instruction takes 2^N ns of the emulator's time, and the emulated
//! TIM2 counts that time's nanoseconds; so its differences are instructions, exactly and
//! repeatably, once they are divided by what a loop of known length takes. They are instructions,
//! never cycles: the emulator knows nothing of wait states or of the pipeline.

use core::arch::{asm, naked_asm};
use core::sync::atomic::{Ordering, compiler_fence};

pub use super::tick_timer::now;
use super::tick_timer::{COUNTER, now_at};

use crate::environment::Discretize;
use crate::number::Number;
use crate::scene::Scene;
use crate::servo::{BuildError, Servo, Transducers};

/// A servo to be measured, of a scene that the host has judged, in a number format in which it may not
/// be certified. This board has no motor.
///
/// # Errors
/// Where the scene or the transducers cannot be had in this number format.
#[doc(hidden)]
pub fn uncertified_servo<E: Discretize<N>, N: Number>(
    scene: &Scene<E>,
    transducers: &Transducers,
) -> Result<Servo<E, N>, BuildError> {
    Servo::build(scene, transducers)
}

/// Scale of the counter.
#[derive(Clone, Copy, Debug)]
pub struct Scale {
    /// Counts that one instruction takes.
    pub per_instruction: u32,
    /// Instructions that a [`measurement`](measure) counts of itself.
    pub overhead: u32,
    /// Overhead of the measurement of an interrupt in instructions: an empty interrupt has one
    /// instruction of its own.
    pub around: u32,
}

impl Scale {
    /// Measures a loop of known length, and nothing at all.
    pub fn calibrate() -> Self {
        let (short, long) = (loop_time(LOOP), loop_time(2 * LOOP));
        // To the nearest: around one of the loops there may be an instruction more.
        let per_instruction = ((long.wrapping_sub(short) + LOOP) / (2 * LOOP)).max(1);
        let empty = measure(0, |nothing| (nothing, nothing));
        let around = return_time() / per_instruction - 1;
        Self { per_instruction, overhead: empty / per_instruction, around }
    }

    /// Instructions of a stretch of time.
    pub fn instructions(&self, time: u32) -> u32 {
        time / self.per_instruction
    }

    /// Instructions of a stretch of time that [`measure`] has measured.
    pub fn measured(&self, time: u32) -> u32 {
        self.instructions(time).saturating_sub(self.overhead)
    }

    /// Instructions of a stretch of time that [`interrupt`] has measured.
    pub fn of_interrupt(&self, time: u32) -> u32 {
        self.instructions(time).saturating_sub(self.around)
    }
}

/// Calls what an interrupt does, and gives the time that it took, with what the measurement takes of
/// itself.
#[inline(always)]
pub fn interrupt(handler: extern "C" fn()) -> u32 {
    let start = now();
    handler();
    now().wrapping_sub(start)
}

/// Time of the shortest interrupt that there is; in a function of its own, so that nothing else is
/// done meanwhile.
#[inline(never)]
fn return_time() -> u32 {
    interrupt(return_at_once)
}

/// The shortest interrupt that there is.
#[unsafe(naked)]
extern "C" fn return_at_once() {
    naked_asm!("bx lr")
}

/// Turns of the calibration's loop.
const LOOP: u32 = 500;

/// Time of a loop of two instructions a turn.
fn loop_time(turns: u32) -> u32 {
    let start = now();
    // SAFETY: counts a register down to zero and touches nothing else.
    unsafe { asm!("2:", "subs {0}, {0}, #1", "bne 2b", inout(reg) turns => _) };
    now().wrapping_sub(start)
}

/// Does something with a number that has two results, and gives the time that it took, with what the
/// measurement takes of itself.
///
/// The number is hidden from the optimiser after the first reading and the results are demanded
/// before the second, so that no part of it can be moved out of the measured stretch. The servo's
/// interrupt waits meanwhile, which is no longer than the interrupt itself.
#[inline(always)]
pub fn measure(number: u32, what: impl FnOnce(u32) -> (u32, u32)) -> u32 {
    cortex_m::interrupt::free(|_| {
        let mut counter = COUNTER;
        // SAFETY: no instruction; the operand is unchanged. The compiler does not know that it is a
        // constant, which it would otherwise make again within the measured stretch.
        unsafe { asm!("/* {0} */", inout(reg) counter) };
        // SAFETY: the address is unchanged.
        let start = unsafe { now_at(counter) };
        let mut number = number;
        // SAFETY: no instruction; the operand is unchanged. It may touch memory as far as the
        // compiler knows, which keeps what the work needs where it is.
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
