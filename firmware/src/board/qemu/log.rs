//! The servo's log for the host: ticks go through a lock-free queue and are summarised and logged at a
//! priority below the servo's, never in its interrupt.

use core::sync::atomic::{AtomicBool, AtomicU32, Ordering};

use heapless::spsc::{Consumer, Producer, Queue};
use semihosting::println;
use static_cell::StaticCell;

use super::meter::{Scale, now};
use super::stop::EXIT_DONE;
use crate::board::isr_cell::IsrCell;
use crate::certificate::Assessment;
use crate::encoder::RawCount;

/// Length of the queue: it holds one tick less, and the log may lag behind by that number.
const LENGTH: usize = 17;
/// Ticks between two lines of the log.
const EVERY: u32 = 1000;

/// The measurements of one tick. Times are in the meter's units.
#[derive(Clone, Copy)]
pub struct Measured {
    /// The encoder's counter.
    pub count: RawCount,
    /// The code that was written.
    pub code: u16,
    /// Whether the servo was running before.
    pub was_running: bool,
    /// Time of the servo's interrupt.
    pub tick: u32,
    /// Time of the lockstep around it.
    pub lockstep: u32,
}

/// Smallest, largest and sum of a number of instructions.
#[derive(Clone, Copy)]
pub struct InstructionStats {
    count: u32,
    min: u32,
    max: u32,
    sum: u64,
}

impl InstructionStats {
    /// Statistics of no values.
    pub const EMPTY: Self = Self { count: 0, min: u32::MAX, max: 0, sum: 0 };

    /// Adds a value.
    pub fn add(&mut self, value: u32) {
        self.count += 1;
        self.min = self.min.min(value);
        self.max = self.max.max(value);
        self.sum += u64::from(value);
    }

    /// The number of values.
    pub const fn count(&self) -> u32 {
        self.count
    }

    /// Logs the statistics, if there are values.
    pub fn log(&self, name: &str) {
        let Self { count, min, max, sum } = *self;
        if count > 0 {
            println!("spread={name} count={count} min={min} max={max} sum={sum}");
        }
    }
}

/// Analyses the parts of each tick.
pub trait Parts {
    /// Takes a tick.
    fn take(&mut self, tick: &Measured, scale: &Scale);
    /// Logs the result.
    fn log(&mut self);
}

/// A tick without parts.
pub struct NoParts;

impl Parts for NoParts {
    fn take(&mut self, _: &Measured, _: &Scale) {}
    fn log(&mut self) {}
}

/// The interrupt's end of the queue.
static TICKS: IsrCell<Producer<'static, Measured>> = IsrCell::empty();
static DROPPED: AtomicU32 = AtomicU32::new(0);
static ENDED: AtomicBool = AtomicBool::new(false);

/// Passes a tick to the log; a full queue drops and counts it.
///
/// # Safety
/// Only the interrupt that uses the queue may call this, after [`Log::open`].
pub unsafe fn push(tick: Measured) {
    // SAFETY: the caller guarantees that the cell is filled and that only this interrupt uses it.
    if unsafe { TICKS.borrow_mut() }.enqueue(tick).is_err() {
        DROPPED.fetch_add(1, Ordering::Relaxed);
    }
}

/// Time that was spent in the servo's interrupt and the lockstep around it, wrapping.
static SPENT: AtomicU32 = AtomicU32::new(0);

/// Adds time spent in the interrupt.
pub fn spend(time: u32) {
    // An atomic addition is not needed: no other writer interrupts this.
    SPENT.store(SPENT.load(Ordering::Relaxed).wrapping_add(time), Ordering::Relaxed);
}

/// The present time without the time spent in the servo's interrupt.
fn time_below() -> u32 {
    cortex_m::interrupt::free(|_| now().wrapping_sub(SPENT.load(Ordering::Relaxed)))
}

/// Marks the end of the ticks.
pub fn end() {
    ENDED.store(true, Ordering::Release);
}

/// Logs the bits of a certificate's enclosures, if they exist.
pub fn certificate(by: &str, assessment: &Assessment) {
    let indices = [("alpha", assessment.alpha), ("alpha_coupled", assessment.alpha_coupled)];
    for (name, interval) in indices {
        if let Some(interval) = interval {
            let (lo, hi) = (interval.lo().to_bits(), interval.hi().to_bits());
            println!("enclosure={name} by={by} lo={lo} hi={hi}");
        }
    }
}

/// The log of a run.
pub struct Log<P> {
    ticks: Consumer<'static, Measured>,
    scale: Scale,
    parts: P,
    total: u32,
    interrupt: InstructionStats,
    /// The same of the ticks with another code than the last.
    changed: InstructionStats,
    code: u16,
    lockstep: InstructionStats,
    /// Statistics of the work below the interrupt.
    below: InstructionStats,
}

impl<P: Parts> Log<P> {
    /// Begins a log that also analyses the parts of a tick. Call it once.
    ///
    /// # Safety
    /// The interrupt that pushes the ticks must not be enabled yet.
    pub unsafe fn open(scale: Scale, parts: P) -> Self {
        static QUEUE: StaticCell<Queue<Measured, LENGTH>> = StaticCell::new();
        let (push, ticks) = QUEUE.init(Queue::new()).split();
        // SAFETY: the caller guarantees that the cell is unused.
        unsafe { TICKS.init(push) };
        let [interrupt, changed, lockstep, below] = [InstructionStats::EMPTY; 4];
        Self { ticks, scale, parts, total: 0, interrupt, changed, code: 0, lockstep, below }
    }

    /// Runs work below the interrupt, and measures it.
    pub fn around(&mut self, work: impl FnOnce()) {
        let start = time_below();
        work();
        let time = time_below().wrapping_sub(start);
        self.below.add(self.scale.instructions(time));
    }

    /// Takes the queued ticks; ends the emulation once the host has ended the run.
    pub fn poll(&mut self) {
        // Read before the queue is drained, so that ticks pushed before the end are not missed.
        let ended = ENDED.load(Ordering::Acquire);
        while let Some(tick) = self.ticks.dequeue() {
            self.add(&tick);
        }
        if ended {
            self.log();
            semihosting::process::exit(EXIT_DONE)
        }
    }

    /// Ticks with a ramp, a swap or a fault are not included in the statistics.
    fn add(&mut self, tick: &Measured) {
        self.parts.take(tick, &self.scale);
        if tick.was_running {
            let instructions = self.scale.of_interrupt(tick.tick);
            self.interrupt.add(instructions);
            if tick.code != self.code {
                self.changed.add(instructions);
            }
            self.lockstep.add(self.scale.instructions(tick.lockstep));
        }
        self.code = tick.code;
        self.total += 1;
        if self.total.is_multiple_of(EVERY) {
            println!("progress={}", self.total);
        }
    }

    fn log(&mut self) {
        let dropped = DROPPED.load(Ordering::Relaxed);
        let overruns = super::tick_timer::missed();
        let ticks = self.interrupt.count();
        println!("ticks={ticks} dropped={dropped} overruns={overruns}");
        self.parts.log();
        self.interrupt.log("interrupt");
        self.changed.log("changed");
        self.below.log("below");
        self.lockstep.log("lockstep");
    }
}
