//! The statics that the servo's interrupt and the task below it share.

use static_cell::StaticCell;

use crate::number::Number;
use crate::rendering::Rendering;
use crate::servo::{OutputMode, PreparedServo};
pub use crate::servo_loop::{Endpoints, FRAMES, ServoIsr};
use crate::servo_loop::{FrameQueue, Mailbox};

/// The static for the mailbox between the servo's interrupt and the task below it. Each program has its own,
/// because the types depend on its scene.
pub type MailboxCell<E, N, M> = StaticCell<Mailbox<PreparedServo<E, N, M>>>;

/// Makes the mailbox and the queue of frames. Call it once.
pub fn endpoints<E: Rendering<N>, N: Number, M: OutputMode>(
    mailbox: &'static MailboxCell<E, N, M>,
) -> Endpoints<E, N, M> {
    static QUEUE: StaticCell<FrameQueue<FRAMES>> = StaticCell::new();
    Endpoints::of(mailbox.init_with(Mailbox::new), QUEUE.init_with(FrameQueue::new))
}
