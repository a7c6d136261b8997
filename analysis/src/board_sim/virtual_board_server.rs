//! A virtual board with the flashed program and a simulated device, behind a socket.

use std::collections::VecDeque;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::{Duration, Instant};

use super::listener::Listener;
use crate::lockstep::PlantIo;
use crate::virtual_board::{VirtualBoard, VirtualBoardError};

/// Bytes to the board with one sample: more than its port takes in a sample.
const BYTES_PER_SAMPLE: usize = 1024;

/// Runs a board's samples as a real one's would pass, or all that it can where `period` is none.
pub(super) fn serve(
    mut board: VirtualBoard,
    mut plant: Box<dyn PlantIo + Send>,
    mut listener: Listener,
    period: Option<Duration>,
    over: &AtomicBool,
) -> Result<(), VirtualBoardError> {
    let (mut to_board, mut to_host) = (VecDeque::new(), Vec::new());
    let (mut count, mut next) = (0, Instant::now());
    while !over.load(Ordering::Relaxed) {
        let sample = board.sample()?;
        plant.hold(sample.applied_code());
        // A recording that has ended stands still.
        count = plant.count().unwrap_or(count);
        to_host.extend(sample.sent);
        to_board.extend(listener.carry_bytes(&mut to_host));
        let bytes: Vec<u8> = to_board.drain(..to_board.len().min(BYTES_PER_SAMPLE)).collect();
        board.answer(count, &bytes)?;
        if let Some(period) = period {
            next += period;
            thread::sleep(next.saturating_duration_since(Instant::now()));
        }
    }
    board.finish().map(drop)
}
