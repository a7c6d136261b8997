//! The core that executes here, against two others: the servo's own functions on the same random and
//! hard numbers, on the virtual board, in QEMU and on the host. All results are equal to the bit, and
//! the two boards need equally many instructions for each.
//!
//! Both boards run the same file. Their cores are of one family, some years apart; the host's is of
//! another, and so is its compiler's back end.

mod certificates;
mod closed_loops;
mod sines;
mod ticks;

use std::path::Path;
use std::sync::LazyLock;

use analysis::emulator::{EmulatorError, Transport};
use analysis::toolchain::{Toolchain, Tools, prepare};
use rand::Rng;
use rand::seq::IndexedRandom;
use rand_chacha::ChaCha8Rng;
use virtual_board::chip::NETDUINO_PLUS_2;
use virtual_board::semihosting::{CallError, Guest};

static TOOLCHAIN: LazyLock<Toolchain> =
    LazyLock::new(|| prepare(Tools::CompilerAndEmulator).unwrap_or_else(|error| panic!("{error}")));

/// A program on the virtual board.
struct VirtualGuest(Guest);

impl VirtualGuest {
    fn boot(elf: &Path) -> Self {
        let guest = Guest::boot(elf, &NETDUINO_PLUS_2, ["counts", "codes"]);
        Self(guest.unwrap_or_else(|error| panic!("{error}")))
    }
}

fn failed(error: CallError) -> EmulatorError {
    EmulatorError::Transport(error.into())
}

impl Transport for VirtualGuest {
    fn exchange(&mut self, question: &[u8], answer: &mut [u8]) -> Result<(), EmulatorError> {
        self.0.exchange(question, answer).map_err(failed)
    }

    fn finish(self: Box<Self>) -> Result<(), EmulatorError> {
        self.0.finish().map(drop).map_err(failed)
    }
}

/// Counts of a device that wanders, jumps anywhere, stands at the ends of the counter, and stands
/// still until all that a filter remembers is gone.
fn counts(rng: &mut ChaCha8Rng, ticks: usize) -> Vec<i32> {
    const EDGES: [i32; 7] = [0, 1, -1, i32::MAX, i32::MIN, 1 << 15, 1 << 24];
    let (mut count, mut still) = (0_i32, 0);
    let mut next = || {
        if still > 0 {
            still -= 1;
            return count;
        }
        count = match rng.random_range(0..12) {
            0 => *EDGES.choose(rng).expect("there are edges"),
            1 => rng.random(),
            2 => rng.random_range(-70_000..=70_000),
            3..=5 => count.wrapping_add(rng.random_range(-1..=1)),
            _ => count.wrapping_add(rng.random_range(-900..=900)),
        };
        still = if rng.random_range(0..50) == 0 { 150 } else { 0 };
        count
    };
    (0..ticks).map(|_| next()).collect()
}
