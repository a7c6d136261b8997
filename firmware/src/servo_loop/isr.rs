//! The state of the servo's interrupt, and the data shared with the task below it.

use super::{FrameQueue, FrameReader, Frames, Hardware, Inbox, Mailbox, Requests, ServoLoop};
use crate::number::Number;
use crate::output_timing::OutputMode;
use crate::rendering::Rendering;
use crate::servo::PreparedServo;

/// Capacity of the queue of frames, a power of two: 1.6 ms at 20 kHz.
pub const FRAMES: usize = 32;

/// State of the servo's interrupt.
pub struct ServoIsr<H, E: Rendering<N> + 'static, N: Number, M: 'static> {
    /// The servo and its state.
    pub servo_loop: ServoLoop<E, N, M>,
    /// The board's registers.
    pub hardware: H,
    /// Requests from the task.
    pub inbox: Inbox<'static, PreparedServo<E, N, M>>,
    /// Frames to the task.
    pub frames: Frames<'static, FRAMES>,
}

impl<H: Hardware, E: Rendering<N>, N: Number, M: OutputMode> ServoIsr<H, E, N, M> {
    /// One tick.
    #[inline(always)]
    pub fn tick(&mut self) {
        self.servo_loop.run(&mut self.hardware, &mut self.inbox, &mut self.frames);
    }
}

/// Endpoints of interrupt and task.
pub struct Endpoints<E: Rendering<N> + 'static, N: Number, M: 'static> {
    /// The task's end of the mailbox.
    pub requests: Requests<'static, PreparedServo<E, N, M>>,
    /// The interrupt's end of the mailbox.
    pub inbox: Inbox<'static, PreparedServo<E, N, M>>,
    /// The interrupt's end of the queue of frames.
    pub frames: Frames<'static, FRAMES>,
    /// The task's end of the queue of frames.
    pub frame_reader: FrameReader<'static, FRAMES>,
}

impl<E: Rendering<N>, N: Number, M: OutputMode> Endpoints<E, N, M> {
    /// The ends of a mailbox and of a queue of frames in statics.
    pub fn of(
        mailbox: &'static mut Mailbox<PreparedServo<E, N, M>>,
        queue: &'static mut FrameQueue<FRAMES>,
    ) -> Self {
        let (requests, inbox) = mailbox.split();
        let (frames, frame_reader) = queue.split();
        Self { requests, inbox, frames, frame_reader }
    }
}
