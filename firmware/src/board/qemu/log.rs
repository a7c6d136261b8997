//! What the servo did, told to the host: frames through a lock-free queue, summed up and logged
//! below the servo's priority. Nothing is logged in the servo's interrupt.

use core::sync::atomic::{AtomicBool, AtomicU32, Ordering};

use embassy_sync::waitqueue::AtomicWaker;
use heapless::spsc::{Consumer, Producer, Queue};
use static_cell::StaticCell;

use super::meter::Scale;
use crate::certificate::Assessment;
use crate::dac::DacCode;

// The logger that carries the bytes; it registers itself.
use defmt_semihosting as _;

/// Frames that the queue holds (one less than its length): the log may fall this far behind.
const LENGTH: usize = 33;
/// Ticks between two lines of the log.
const EVERY: u32 = 1000;

/// One tick, as the servo saw it. Times are in the meter's units.
#[derive(Clone, Copy)]
pub struct Frame {
    /// The code that was written.
    pub code: DacCode,
    /// Ticks that were due when this one began, 1 when all is well.
    pub due: u32,
    /// Time of the compute part, from count to code.
    pub compute: u32,
    /// Time of the previous tick's interrupts, pipes included.
    pub interrupt: u32,
    /// Time of the previous tick's pipes.
    pub lockstep: u32,
}

/// The servo's end of the queue.
pub struct Frames(Producer<'static, Frame>);
/// The log's end of the queue.
pub type FramesEnd = Consumer<'static, Frame>;

static QUEUE: StaticCell<Queue<Frame, LENGTH>> = StaticCell::new();
static DROPPED: AtomicU32 = AtomicU32::new(0);
static ENDED: AtomicBool = AtomicBool::new(false);
static LOG: AtomicWaker = AtomicWaker::new();

/// Makes the queue. To be called once.
pub fn frames() -> (Frames, FramesEnd) {
    let (servo, log) = QUEUE.init(Queue::new()).split();
    (Frames(servo), log)
}

impl Frames {
    /// Gives a frame to the log; a full queue drops it and counts that.
    pub fn push(&mut self, frame: Frame) {
        if self.0.enqueue(frame).is_err() {
            DROPPED.fetch_add(1, Ordering::Relaxed);
        }
        LOG.wake();
    }

    /// There will be no more frames.
    pub fn end(self) {
        ENDED.store(true, Ordering::Release);
        LOG.wake();
    }
}

/// Smallest, largest and sum of a number of instructions.
#[derive(Clone, Copy)]
struct Spread {
    count: u32,
    min: u32,
    max: u32,
    sum: u64,
}

impl Spread {
    const EMPTY: Self = Self { count: 0, min: u32::MAX, max: 0, sum: 0 };

    fn add(&mut self, value: u32) {
        self.count += 1;
        self.min = self.min.min(value);
        self.max = self.max.max(value);
        self.sum += u64::from(value);
    }

    fn log(&self, name: &str) {
        let Self { count, min, max, sum } = *self;
        if count > 0 {
            defmt::info!("spread={=str} count={} min={} max={} sum={}", name, count, min, max, sum);
        }
    }
}

/// Tells the host a certificate's enclosures by their bits, where they exist.
pub fn certificate(by: &str, assessment: &Assessment) {
    let indices = [("alpha", assessment.alpha), ("alpha_coupled", assessment.alpha_coupled)];
    for (name, interval) in indices {
        if let Some(interval) = interval {
            let (lo, hi) = (interval.lo().to_bits(), interval.hi().to_bits());
            defmt::info!("enclosure={=str} by={=str} lo={=u64} hi={=u64}", name, by, lo, hi);
        }
    }
}

/// Takes the frames until the servo has ended, logs what they say, and ends the emulation.
#[embassy_executor::task]
pub async fn log(mut frames: FramesEnd, scale: Scale) {
    let mut summary = Summary::new(scale);
    loop {
        // Read before the queue is drained: frames pushed before the end are then not missed.
        let ended = ENDED.load(Ordering::Acquire);
        while let Some(frame) = frames.dequeue() {
            summary.add(frame);
        }
        if ended {
            break;
        }
        pushed().await;
    }
    summary.log();
    semihosting::process::exit(super::EXIT_DONE)
}

/// Waits until the servo has pushed something.
async fn pushed() {
    let mut waited = false;
    core::future::poll_fn(|context| {
        LOG.register(context.waker());
        if core::mem::replace(&mut waited, true) {
            core::task::Poll::Ready(())
        } else {
            core::task::Poll::Pending
        }
    })
    .await
}

/// The sums over a run.
struct Summary {
    scale: Scale,
    last: Option<Frame>,
    ticks: u32,
    overruns: u32,
    contact: Spread,
    free: Spread,
    interrupt: Spread,
    lockstep: Spread,
}

impl Summary {
    fn new(scale: Scale) -> Self {
        let [contact, free, interrupt, lockstep] = [Spread::EMPTY; 4];
        Self { scale, last: None, ticks: 0, overruns: 0, contact, free, interrupt, lockstep }
    }

    fn add(&mut self, frame: Frame) {
        if let Some(last) = self.last.replace(frame) {
            self.add_compute(last, Some(frame));
        }
        // The first tick has no previous one.
        if self.ticks > 0 {
            let lockstep = self.scale.instructions(frame.lockstep);
            let interrupt = self.scale.instructions(frame.interrupt);
            self.lockstep.add(lockstep);
            self.interrupt.add(interrupt.saturating_sub(lockstep));
        }
        self.overruns += frame.due - 1;
        self.ticks += 1;
        if self.ticks.is_multiple_of(EVERY) {
            defmt::info!("progress={}", self.ticks);
        }
    }

    /// A tick is free where neither it nor the next one gives torque. The next one's is looked at
    /// because what a tick finds in a delayed wall is felt a tick later.
    fn add_compute(&mut self, frame: Frame, next: Option<Frame>) {
        let compute = self.scale.instructions(frame.compute).saturating_sub(self.scale.overhead);
        let gives_torque = |frame: Frame| frame.code != DacCode::MID_SCALE;
        let contact = gives_torque(frame) || next.is_some_and(gives_torque);
        let spread = if contact { &mut self.contact } else { &mut self.free };
        spread.add(compute);
    }

    fn log(mut self) {
        if let Some(last) = self.last {
            self.add_compute(last, None);
        }
        let dropped = DROPPED.load(Ordering::Relaxed);
        defmt::info!("ticks={} dropped={} overruns={}", self.ticks, dropped, self.overruns);
        self.contact.log("contact");
        self.free.log("free");
        self.interrupt.log("interrupt");
        self.lockstep.log("lockstep");
    }
}
