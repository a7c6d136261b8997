//! The instants between two accesses of the task to what it shares with the interrupt, at which the interrupt
//! may come.

/// The hardware interrupts where it likes.
#[cfg(not(all(test, feature = "wire")))]
#[inline(always)]
pub(super) const fn may_interrupt() {}

#[cfg(all(test, feature = "wire"))]
pub(crate) use by_tests::*;

/// Tests have no interrupt: a test's own is called at each of these instants.
#[cfg(all(test, feature = "wire"))]
mod by_tests {
    use core::cell::RefCell;
    use std::boxed::Box;

    std::thread_local! {
        static INTERRUPT: RefCell<Option<Box<dyn FnMut()>>> = const { RefCell::new(None) };
    }

    /// Calls `interrupt` at each instant of this thread from now on.
    pub(crate) fn set(interrupt: impl FnMut() + 'static) {
        INTERRUPT.set(Some(Box::new(interrupt)));
    }

    pub(crate) fn clear() {
        INTERRUPT.set(None);
    }

    pub(crate) fn may_interrupt() {
        // Taken out while it runs: an interrupt does not interrupt itself.
        let Some(mut interrupt) = INTERRUPT.take() else { return };
        interrupt();
        INTERRUPT.set(Some(interrupt));
    }
}
