//! The state of the servo's interrupt, and the endpoints that it shares with the task below.

use static_cell::StaticCell;

use crate::environment::Discretize;
use crate::number::Number;
use crate::servo::{OutputMode, PreparedServo};
use crate::servo_loop::{
    FrameQueue, FrameReader, Frames, Hardware, Inbox, Mailbox, Requests, ServoLoop,
};

/// Frames that may wait for the task that sends them, a power of two: 1.6 ms at 20 kHz.
pub const FRAMES: usize = 32;

/// State of the servo's interrupt.
pub struct ServoIsr<H, E: Discretize<N> + 'static, N: Number, M: 'static> {
    /// The servo and its state.
    pub servo_loop: ServoLoop<E, N, M>,
    /// The board's registers.
    pub hardware: H,
    /// Requests from below.
    pub inbox: Inbox<'static, PreparedServo<E, N, M>>,
    /// Frames to below.
    pub frames: Frames<'static, FRAMES>,
}

impl<H: Hardware, E: Discretize<N>, N: Number, M: OutputMode> ServoIsr<H, E, N, M> {
    /// One tick.
    #[inline(always)]
    pub fn tick(&mut self) {
        self.servo_loop.run(&mut self.hardware, &mut self.inbox, &mut self.frames);
    }
}

/// Where the servo's interrupt and the task below it meet. A program has one, in a static place of
/// its own, since the types are its scene's.
pub type MailboxCell<E, N, M> = StaticCell<Mailbox<PreparedServo<E, N, M>>>;

/// Endpoints of interrupt and task.
pub struct Endpoints<E: Discretize<N> + 'static, N: Number, M: 'static> {
    /// The task's end of the mailbox.
    pub requests: Requests<'static, PreparedServo<E, N, M>>,
    /// The interrupt's end of it.
    pub inbox: Inbox<'static, PreparedServo<E, N, M>>,
    /// The interrupt's end of the queue of frames.
    pub frames: Frames<'static, FRAMES>,
    /// The task's end of it.
    pub frame_reader: FrameReader<'static, FRAMES>,
}

/// Makes the mailbox and the queue of frames. To be called once.
pub fn endpoints<E: Discretize<N>, N: Number, M: OutputMode>(
    mailbox: &'static MailboxCell<E, N, M>,
) -> Endpoints<E, N, M> {
    static QUEUE: StaticCell<FrameQueue<FRAMES>> = StaticCell::new();
    let (requests, inbox) = mailbox.init_with(Mailbox::new).split();
    let (frames, frame_reader) = QUEUE.init_with(FrameQueue::new).split();
    Endpoints { requests, inbox, frames, frame_reader }
}
