//! A board without hardware behind a socket: a thread of the package `haptic-client`, or a virtual board with the
//! flashed program.

use std::collections::VecDeque;
use std::io;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::{Duration, Instant};

pub use haptic_client::simulated::{Pacing, SimulatedBoard, SimulatedBoardError};

use haptic_client::Address;
use haptic_client::simulated::{Listener, PlantIo, ReadingOutcome};

use crate::bridge_board::BridgeBoard;
use crate::shaft::HandHeldShaft;
use crate::virtual_board::{VirtualBoard, VirtualBoardError};

/// Bytes to the board with one sample: more than its port takes in a sample.
const BYTES_PER_SAMPLE: usize = 1024;

/// Most bytes that wait for a client that does not read. Later bytes are lost, as on a serial line.
const WAITING: usize = 1 << 20;

/// A virtual board and its device.
pub enum DrivingBoard {
    /// By its DAC.
    Dac {
        /// The board.
        board: VirtualBoard,
        /// The device.
        plant: Box<dyn PlantIo + Send>,
        /// The count to send to the board next; `None` before the first sample.
        count: Option<i32>,
    },
    /// By its own bridge.
    Bridge {
        /// The board.
        board: Box<BridgeBoard>,
        /// The shaft of the motor. The hand lets go of it while the motor is aligned.
        shaft: Box<HandHeldShaft>,
    },
}

impl DrivingBoard {
    /// Runs a sample, with bytes to the serial port; returns the bytes that the port has sent.
    fn sample(&mut self, bytes: &[u8]) -> Result<Vec<u8>, VirtualBoardError> {
        match self {
            Self::Dac { board, plant, count } => {
                if let Some(count) = *count {
                    board.answer(count, bytes)?;
                }
                let sample = board.sample()?;
                plant.hold(sample.applied_code());
                // A recording that has ended stands still.
                *count = Some(plant.count().or(*count).unwrap_or(0));
                board.reading_fails(plant.reading() != ReadingOutcome::Read);
                Ok(sample.sent)
            }
            Self::Bridge { board, shaft } => {
                let sample = board.period(shaft.as_mut(), bytes)?;
                shaft.let_go(sample.is_aligning);
                Ok(sample.sent.clone())
            }
        }
    }

    fn finish(self) -> Result<(), VirtualBoardError> {
        match self {
            Self::Dac { board, .. } => board.finish().map(drop),
            Self::Bridge { board, .. } => board.finish().map(drop),
        }
    }
}

/// Serves a virtual board that has been switched on at the address; `period` of its servo in s.
pub fn listen(board: DrivingBoard, address: &Address, period: f64) -> io::Result<SimulatedBoard> {
    let period = Duration::from_secs_f64(period);
    SimulatedBoard::listen(address, move |listener, over| Ok(serve(board, listener, period, over)?))
}

/// Runs a board's samples in real time with this period.
fn serve(
    mut board: DrivingBoard,
    mut listener: Listener,
    period: Duration,
    over: &AtomicBool,
) -> Result<(), VirtualBoardError> {
    let (mut to_board, mut to_host) = (VecDeque::new(), Vec::new());
    let mut next = Instant::now();
    while !over.load(Ordering::Relaxed) {
        to_board.extend(listener.receive());
        let bytes: Vec<u8> = to_board.drain(..to_board.len().min(BYTES_PER_SAMPLE)).collect();
        to_host.extend(board.sample(&bytes)?);
        to_host.truncate(WAITING);
        listener.send(&mut to_host);
        next += period;
        thread::sleep(next.saturating_duration_since(Instant::now()));
    }
    board.finish()
}
