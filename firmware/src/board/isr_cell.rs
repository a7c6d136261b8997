//! A cell for the state of one interrupt, and the statics that the servo's interrupt and the task below it share.

use core::cell::UnsafeCell;
use core::mem::MaybeUninit;

use static_cell::StaticCell;

use crate::number::Number;
use crate::rendering::Rendering;
use crate::servo::{OutputMode, PreparedServo};
use crate::servo_loop::{Endpoints, FRAMES, FrameQueue, Mailbox};

/// Holds the state of one interrupt. The main program fills the cell before it enables the interrupt, and
/// does not access it afterwards. So the interrupt needs no critical section for it, and no test whether it
/// is filled.
pub struct IsrCell<T>(UnsafeCell<MaybeUninit<T>>);

// SAFETY: both functions require of their callers that one owner at a time uses the cell; the value
// moves from the main program to the interrupt, which `Send` permits.
unsafe impl<T: Send> Sync for IsrCell<T> {}

impl<T> IsrCell<T> {
    /// An empty cell.
    pub const fn empty() -> Self {
        Self(UnsafeCell::new(MaybeUninit::uninit()))
    }

    /// Puts a value into the cell.
    ///
    /// # Safety
    /// The interrupt that uses the cell must not be enabled yet, and no reference from
    /// [`borrow_mut`](Self::borrow_mut) may be alive.
    pub unsafe fn init(&'static self, value: T) {
        // SAFETY: the caller guarantees exclusive access.
        unsafe { (*self.0.get()).write(value) };
    }

    /// The value.
    ///
    /// # Safety
    /// The cell must have been filled, and the caller must be the handler of the one interrupt that
    /// uses it, which does not interrupt itself.
    #[inline(always)]
    #[expect(clippy::mut_from_ref, reason = "the caller is the only one, as it promises")]
    pub unsafe fn borrow_mut(&'static self) -> &'static mut T {
        // SAFETY: the caller guarantees a filled cell and exclusive access.
        unsafe { (*self.0.get()).assume_init_mut() }
    }

    /// The value, for shared use.
    ///
    /// # Safety
    /// The cell must be filled, and [`borrow_mut`](Self::borrow_mut) must never be used with it.
    #[inline(always)]
    pub unsafe fn borrow(&'static self) -> &'static T {
        // SAFETY: the caller guarantees a filled cell and only shared borrows.
        unsafe { (*self.0.get()).assume_init_ref() }
    }
}

impl<T> Default for IsrCell<T> {
    fn default() -> Self {
        Self::empty()
    }
}

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
