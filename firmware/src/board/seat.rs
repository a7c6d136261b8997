//! A servo in its place: what its interrupt works with, and nothing else.

use static_cell::StaticCell;

use crate::cycle::{Cycle, FrameQueue, FrameReader, Frames, Hardware, Inbox, Mailbox, Requests};
use crate::environment::Renderable;
use crate::number::Number;
use crate::servo::{OutputMode, Rendering};

/// Frames that may wait for the task that sends them, a power of two: 1.6 ms at 20 kHz.
pub const FRAMES: usize = 32;

/// What the servo's interrupt works with.
pub struct Seat<H, E: Renderable<N> + 'static, N: Number, M: 'static> {
    /// The servo, and what it is doing.
    pub cycle: Cycle<E, N, M>,
    /// The board's registers.
    pub hardware: H,
    /// Requests from below.
    pub inbox: Inbox<'static, Rendering<E, N, M>>,
    /// Frames to below.
    pub frames: Frames<'static, FRAMES>,
}

impl<H: Hardware, E: Renderable<N>, N: Number, M: OutputMode> Seat<H, E, N, M> {
    /// One tick.
    #[inline(always)]
    pub fn tick(&mut self) {
        self.cycle.run(&mut self.hardware, &mut self.inbox, &mut self.frames);
    }
}

/// Where the servo's interrupt and the task below it meet. A program has one, in a static place of
/// its own, since the types are its scene's.
pub type Meeting<E, N, M> = StaticCell<Mailbox<Rendering<E, N, M>>>;

/// The ends of what the interrupt and the task share.
pub struct Ends<E: Renderable<N> + 'static, N: Number, M: 'static> {
    /// The task's end of the mailbox.
    pub requests: Requests<'static, Rendering<E, N, M>>,
    /// The interrupt's end of it.
    pub inbox: Inbox<'static, Rendering<E, N, M>>,
    /// The interrupt's end of the queue of frames.
    pub frames: Frames<'static, FRAMES>,
    /// The task's end of it.
    pub told: FrameReader<'static, FRAMES>,
}

/// Makes the mailbox and the queue of frames. To be called once.
pub fn ends<E: Renderable<N>, N: Number, M: OutputMode>(
    meeting: &'static Meeting<E, N, M>,
) -> Ends<E, N, M> {
    static QUEUE: StaticCell<FrameQueue<FRAMES>> = StaticCell::new();
    let (requests, inbox) = meeting.init_with(Mailbox::new).split();
    let (frames, told) = QUEUE.init_with(FrameQueue::new).split();
    Ends { requests, inbox, frames, told }
}
