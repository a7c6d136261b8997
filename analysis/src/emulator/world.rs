//! A world around an emulated board that goes on by itself, so that somebody can talk to the board
//! meanwhile.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::JoinHandle;

use firmware::board::shown::{Moved, Shown};

use super::{Emulator, EmulatorError};

/// A thread that is a board's world.
pub struct World {
    port: PathBuf,
    over: Arc<AtomicBool>,
    thread: Option<JoinHandle<Result<Emulator, EmulatorError>>>,
}

impl World {
    /// From now on `next` says in each tick what has become of the world, and is told afterwards
    /// what the board shows.
    pub fn start(mut emulator: Emulator, mut world: impl Act + Send + 'static) -> Self {
        let (port, over) = (emulator.port(), Arc::<AtomicBool>::default());
        let is_over = over.clone();
        let thread = std::thread::spawn(move || {
            while !is_over.load(Ordering::Relaxed) {
                let moved = world.next();
                world.see(moved, emulator.tick(moved)?);
            }
            Ok(emulator)
        });
        Self { port, over, thread: Some(thread) }
    }

    /// The board's serial port.
    pub fn port(&self) -> &Path {
        &self.port
    }

    /// Ends the world and gives the board back.
    ///
    /// # Errors
    /// What ended it before.
    pub fn end(mut self) -> Result<Emulator, EmulatorError> {
        self.over.store(true, Ordering::Relaxed);
        let thread = self.thread.take().expect("a world ends once");
        thread.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic))
    }
}

impl Drop for World {
    fn drop(&mut self) {
        // The thread notices within a tick; with it goes the emulator.
        self.over.store(true, Ordering::Relaxed);
    }
}

/// What happens in a world.
pub trait Act {
    /// What has become of the world since the last tick.
    fn next(&mut self) -> Moved;
    /// What the board shows at the end of the tick.
    fn see(&mut self, _: Moved, _: Shown) {}
}

/// A world in which the device is held still at a count.
pub struct Still(pub i32);

impl Act for Still {
    fn next(&mut self) -> Moved {
        Moved { count: self.0.cast_unsigned(), missed: 0 }
    }
}
