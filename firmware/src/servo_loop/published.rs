//! Words that the interrupt publishes, and that the task reads as a whole or not at all.

use core::sync::atomic::{AtomicU32, Ordering, fence};

use super::interruption::may_interrupt;

/// The last published words; zeros before the first. One writer, which replaces them, and one reader.
///
/// A sequence lock. The writer stores an odd version, the words, and the next even version, and never waits.
/// The reader loads the version, the words, and the version again. An interrupt between these loads that
/// publishes changes the version, and the words are dropped.
#[derive(Debug)]
pub(super) struct Published<const WORDS: usize> {
    version: AtomicU32,
    words: [AtomicU32; WORDS],
}

impl<const WORDS: usize> Published<WORDS> {
    pub(super) const fn new() -> Self {
        Self { version: AtomicU32::new(0), words: [const { AtomicU32::new(0) }; WORDS] }
    }

    /// Replaces the words.
    pub(super) fn publish(&self, words: [u32; WORDS]) {
        let version = self.version.load(Ordering::Relaxed);
        self.version.store(version.wrapping_add(1), Ordering::Relaxed);
        // No word before the odd version.
        fence(Ordering::Release);
        for (place, word) in self.words.iter().zip(words) {
            place.store(word, Ordering::Relaxed);
        }
        self.version.store(version.wrapping_add(2), Ordering::Release);
    }

    /// The words; `None` if they were replaced meanwhile: read them again at the next poll.
    pub(super) fn read(&self) -> Option<[u32; WORDS]> {
        let version = self.version.load(Ordering::Acquire);
        let mut words = [0; WORDS];
        for (word, place) in words.iter_mut().zip(&self.words) {
            may_interrupt();
            *word = place.load(Ordering::Relaxed);
        }
        may_interrupt();
        // The second load of the version after all words.
        fence(Ordering::Acquire);
        let is_whole = version.is_multiple_of(2) && self.version.load(Ordering::Relaxed) == version;
        is_whole.then_some(words)
    }
}
