//! The lockstep of the emulated board with the plant: two pipes to a process on the host, which simulates the
//! plant.
//!
//! In each tick the host writes the encoder's state into the pipe `counts`, and the board writes its outputs
//! into the pipe `codes`. Both pipes are in the folder where the emulator was started;
//! [`output`](crate::board::output) defines the bytes. The board waits for its count, so host and board
//! cannot drift apart. The host ends the run by closing `counts`.

use core::slice::from_raw_parts_mut;
use core::sync::atomic::{AtomicBool, AtomicU8, AtomicU16, AtomicU32, Ordering};

use semihosting::fs::File;
use semihosting::io::{Read, Write};

use super::lines;
use crate::board::isr_cell::IsrCell;
use crate::board::lockstep_protocol::{TickInput, TickOutput};
use crate::servo_loop::State;

/// The host's end could not be opened.
#[derive(Clone, Copy, Debug)]
pub struct NoHost;

/// Counts from the host, and the board's output.
struct Pipes {
    counts: File,
    codes: File,
}

static PIPES: IsrCell<Pipes> = IsrCell::empty();
/// The last input from the host. It has its own static, so that it is available after a fault at any
/// instruction.
static LATEST_INPUT: [AtomicU8; TickInput::BYTES] = [const { AtomicU8::new(0) }; TickInput::BYTES];
/// Number of the last reported tick.
static SHOWN: AtomicU16 = AtomicU16::new(0);
/// Whether the next count becomes the encoder's zero.
static ZEROING: AtomicBool = AtomicBool::new(false);
/// The host's count at the encoder's zero.
static ZERO: AtomicU32 = AtomicU32::new(0);

/// Opens both pipes, the host's pipe first.
///
/// # Errors
/// If no host has opened the other ends.
pub fn pipes() -> Result<(File, File), NoHost> {
    let counts = File::open(c"counts").map_err(|_| NoHost)?;
    let codes = File::create(c"codes").map_err(|_| NoHost)?;
    Ok((counts, codes))
}

/// Opens both pipes.
///
/// # Safety
/// The interrupt that uses the pipes must not be enabled yet.
pub(super) unsafe fn open() -> Result<(), NoHost> {
    let (counts, codes) = pipes()?;
    // SAFETY: the caller guarantees that the cell is unused.
    unsafe { PIPES.init(Pipes { counts, codes }) };
    Ok(())
}

/// Makes the position at the next tick the encoder's zero.
pub(super) fn zero_count() {
    ZEROING.store(true, Ordering::Relaxed);
}

/// Waits for the host's input; returns the periods that passed without a tick, or `None` once the host has
/// closed the pipe.
///
/// # Safety
/// The pipes must be open.
pub(super) unsafe fn receive() -> Option<u32> {
    // SAFETY: the caller opened the pipes, and only shared references exist.
    let mut counts = unsafe { &PIPES.borrow().counts };
    // SAFETY: no other code accesses the atomics' bytes meanwhile.
    let bytes =
        unsafe { from_raw_parts_mut(LATEST_INPUT.as_ptr().cast_mut().cast(), LATEST_INPUT.len()) };
    if counts.read_exact(bytes).is_err() {
        return None;
    }
    let (TickInput { count, missed }, _) = latest_input();
    if ZEROING.swap(false, Ordering::Relaxed) {
        ZERO.store(count, Ordering::Relaxed);
    }
    lines::set_count(count.wrapping_sub(ZERO.load(Ordering::Relaxed)));
    Some(missed.into())
}

/// The last input from the host, and its tick.
fn latest_input() -> (TickInput, u16) {
    TickInput::from_bytes(LATEST_INPUT.each_ref().map(|byte| byte.load(Ordering::Relaxed)))
}

/// Reports the board's outputs to the host, if it waits for them. If the host has closed the pipes, the run
/// ends at the next count.
///
/// # Safety
/// The pipes must be open if a host has asked.
pub(super) unsafe fn show(state: State) {
    let (_, number) = latest_input();
    if number != SHOWN.load(Ordering::Relaxed) {
        let (code, amplifier) = lines::outputs();
        let output = TickOutput { code, amplifier, state };
        // SAFETY: as in `receive`.
        let _ = unsafe { &PIPES.borrow().codes }.write_all(&output.to_bytes(number));
        SHOWN.store(number, Ordering::Relaxed);
    }
}
