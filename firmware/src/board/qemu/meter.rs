//! Counts instructions.
//!
//! Under `-icount shift=N` each instruction takes 2^N ns of the emulator's time, and the emulated
//! TIM2 counts that time's nanoseconds; so its differences are instructions, exactly and
//! repeatably, once they are divided by what a loop of known length takes. They are instructions,
//! never cycles: the emulator knows nothing of wait states or of the pipeline.

use core::arch::asm;
use core::sync::atomic::{AtomicU32, Ordering, compiler_fence};

use crate::dac::DacCode;
use crate::encoder::RawCount;
use crate::servo::Output;
use crate::torque::LimitReason;

/// TIM2's control register 1, from the F405's memory map.
const CONTROL: *mut u32 = 0x4000_0000 as *mut u32;
/// TIM2's counter, 32 bits.
const COUNTER: *const u32 = 0x4000_0024 as *const u32;
/// TIM2's reload register.
const RELOAD: *mut u32 = 0x4000_002C as *mut u32;

/// Time spent in interrupts since it was last taken.
pub static INTERRUPT: Stopwatch = Stopwatch::new();
/// Time spent in the lockstep's pipes since it was last taken.
pub static LOCKSTEP: Stopwatch = Stopwatch::new();

/// Sums up stretches of time.
pub struct Stopwatch(AtomicU32);

impl Stopwatch {
    const fn new() -> Self {
        Self(AtomicU32::new(0))
    }

    /// Adds the time since `start`.
    #[inline(always)]
    pub fn add(&self, start: u32) {
        // Not an atomic addition: what is measured never interrupts itself, and the loop of an
        // exclusive store would be counted too.
        let sum = self.0.load(Ordering::Relaxed).wrapping_add(now().wrapping_sub(start));
        self.0.store(sum, Ordering::Relaxed);
    }

    /// Gives the sum and begins a new one.
    pub fn take(&self) -> u32 {
        let sum = self.0.load(Ordering::Relaxed);
        self.0.store(0, Ordering::Relaxed);
        sum
    }
}

/// The counter, in units of [`Scale`].
#[inline(always)]
pub fn now() -> u32 {
    // SAFETY: TIM2's counter is a register that may be read at any time and without effect.
    unsafe { COUNTER.read_volatile() }
}

/// What the counter's numbers mean.
#[derive(Clone, Copy, Debug)]
pub struct Scale {
    /// Counts that one instruction takes.
    pub per_instruction: u32,
    /// Instructions that a measurement of a tick counts of itself.
    pub overhead: u32,
}

impl Scale {
    /// Starts the counter and measures a loop of known length and an empty tick.
    pub fn calibrate() -> Self {
        // SAFETY: nothing else uses TIM2; a full reload and the enable bit let it run freely.
        unsafe {
            RELOAD.write_volatile(u32::MAX);
            CONTROL.write_volatile(1);
        }
        let (short, long) = (loop_time(LOOP), loop_time(2 * LOOP));
        let per_instruction = (long.wrapping_sub(short) / (2 * LOOP)).max(1);
        let nothing = Output { code: DacCode::MID_SCALE, limit: LimitReason::None };
        let (_, empty) = tick(RawCount::from(0_u32), |_| nothing);
        Self { per_instruction, overhead: empty / per_instruction }
    }

    /// Instructions of a stretch of time.
    pub fn instructions(&self, time: u32) -> u32 {
        time / self.per_instruction
    }
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

/// Runs one tick and gives the time that it took, what the measurement takes of itself included.
///
/// The count is hidden from the optimiser after the first reading and the result is demanded
/// before the second, so that no part of the tick can be moved out of the measured stretch.
#[inline(always)]
pub fn tick(raw: RawCount, tick: impl FnOnce(RawCount) -> Output) -> (Output, u32) {
    let start = now();
    let mut count = raw.bits();
    // SAFETY: no instruction; the operand is unchanged. It may touch memory as far as the compiler
    // knows, which keeps the servo's state where it is.
    unsafe { asm!("/* {0} */", inout(reg) count) };
    let output = tick(RawCount::from(count));
    // SAFETY: no instruction; as above, with the results as inputs.
    unsafe {
        asm!("/* {0} {1} */", in(reg) u32::from(output.code.get()), in(reg) output.limit as u32)
    };
    let end = now();
    compiler_fence(Ordering::SeqCst);
    (output, end.wrapping_sub(start))
}

/// Bytes of the stack that have been written since reset, and bytes that there are; the start-up
/// code has painted it.
pub fn stack() -> (u32, u32) {
    /// What cortex-m-rt paints with.
    const PAINT: u32 = 0xCCCC_CCCC;
    let (bottom, top) = (&raw const STACK_BOTTOM, &raw const STACK_TOP);
    let mut lowest = bottom;
    // SAFETY: reads words between the ends of the stack, which are RAM and which nothing writes
    // meanwhile below the current frame.
    while lowest < top && unsafe { lowest.read_volatile() } == PAINT {
        lowest = lowest.wrapping_add(1);
    }
    (top.addr().wrapping_sub(lowest.addr()) as u32, top.addr().wrapping_sub(bottom.addr()) as u32)
}

unsafe extern "C" {
    /// The linker script's symbol for the first address above the stack; only its address means
    /// something.
    #[link_name = "_stack_start"]
    static STACK_TOP: u32;
    /// The symbol for the stack's lowest address.
    #[link_name = "_stack_end"]
    static STACK_BOTTOM: u32;
}
