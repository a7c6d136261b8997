//! The static places of the servo's interrupt and of the task below it.

use static_cell::StaticCell;

use crate::environment::Discretize;
use crate::number::Number;
use crate::servo::{OutputMode, PreparedServo};
pub use crate::servo_loop::{Endpoints, FRAMES, ServoIsr};
use crate::servo_loop::{FrameQueue, Mailbox};

/// Where the servo's interrupt and the task below it meet. A program has one, in a static place of
/// its own, since the types are its scene's.
pub type MailboxCell<E, N, M> = StaticCell<Mailbox<PreparedServo<E, N, M>>>;

/// Makes the mailbox and the queue of frames. To be called once.
pub fn endpoints<E: Discretize<N>, N: Number, M: OutputMode>(
    mailbox: &'static MailboxCell<E, N, M>,
) -> Endpoints<E, N, M> {
    static QUEUE: StaticCell<FrameQueue<FRAMES>> = StaticCell::new();
    Endpoints::of(mailbox.init_with(Mailbox::new), QUEUE.init_with(FrameQueue::new))
}
