//! A plant around an emulated board in its own thread, so that a client can communicate with the board
//! meanwhile.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::JoinHandle;

use haptic_servo::board::lockstep_protocol::{TickInput, TickOutput};

use super::{Emulator, EmulatorError};

/// A thread that simulates the plant of an emulated board.
pub struct PlantThread {
    port: PathBuf,
    over: Arc<AtomicBool>,
    thread: Option<JoinHandle<Result<Emulator, EmulatorError>>>,
}

impl PlantThread {
    /// Starts the thread: in each tick the plant provides the board's input and observes its output.
    pub fn start(mut emulator: Emulator, mut plant: impl PlantModel + Send + 'static) -> Self {
        let (port, over) = (emulator.port(), Arc::<AtomicBool>::default());
        let is_over = over.clone();
        let thread = std::thread::spawn(move || {
            while !is_over.load(Ordering::Relaxed) {
                let input = plant.next_input();
                plant.observe(input, emulator.tick(input)?);
            }
            Ok(emulator)
        });
        Self { port, over, thread: Some(thread) }
    }

    /// The board's serial port.
    pub fn port(&self) -> &Path {
        &self.port
    }

    /// Ends the thread and returns the board.
    pub fn end(mut self) -> Result<Emulator, EmulatorError> {
        self.over.store(true, Ordering::Relaxed);
        let thread = self.thread.take().expect("the thread ends once");
        thread.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic))
    }
}

impl Drop for PlantThread {
    fn drop(&mut self) {
        // The thread ends within a tick, and with it the emulator.
        self.over.store(true, Ordering::Relaxed);
    }
}

/// A plant, tick by tick.
pub trait PlantModel {
    /// The board's input for the next tick.
    fn next_input(&mut self) -> TickInput;
    /// Takes the board's output at the end of the tick.
    fn observe(&mut self, _: TickInput, _: TickOutput) {}
}

/// A device that is held still at a count.
pub struct FixedCount(pub i32);

impl PlantModel for FixedCount {
    fn next_input(&mut self) -> TickInput {
        TickInput { count: self.0.cast_unsigned(), missed: 0 }
    }
}
