//! The serial port to the host: USART1, which the emulator connects to a socket.

use core::sync::atomic::{AtomicU32, Ordering};

use cortex_m::peripheral::NVIC;
use heapless::spsc::{Consumer, Producer, Queue};
use static_cell::StaticCell;

use super::tick_timer;
use crate::board::BAUD;
use crate::board::isr_cell::IsrCell;
use crate::wire::Port;

/// USART1's registers, from the F405's memory map: status, data, and control register 1.
const STATUS: *const u32 = 0x4001_1000 as *const u32;
const DATA: *mut u32 = 0x4001_1004 as *mut u32;
const CONTROL: *mut u32 = 0x4001_100C as *mut u32;

/// Status: a byte was received.
const RECEIVED: u32 = 1 << 5;
/// Control: port on, an interrupt for each received byte, transmitter on, receiver on.
const ON: u32 = 1 << 13 | 1 << 5 | 1 << 3 | 1 << 2;

/// Length of the queue of received bytes, which holds one byte less, as on the other boards. A byte without
/// room is lost, and its frame with it.
const WAITING: usize = 257;

/// Duration of a byte on a line in clock counts: ten bits, with a clock of 1 GHz.
const CLOCK_PER_BYTE: u32 = 1_000_000_000 / (BAUD / 10);
/// Capacity of the port in bytes.
const ROOM: u32 = 256;

/// USART1's interrupt.
#[derive(Clone, Copy)]
struct Interrupt;

/// Its number in the F405's vector table.
pub(super) const INTERRUPT: u16 = 37;

// SAFETY: the F405 has 82 interrupts, and the number is 37 as long as the program runs.
unsafe impl cortex_m::interrupt::InterruptNumber for Interrupt {
    fn number(self) -> u16 {
        INTERRUPT
    }
}

/// The interrupt's end of the queue.
static INCOMING: IsrCell<Producer<'static, u8>> = IsrCell::empty();
/// Bytes that were lost because the queue was full.
static LOST: AtomicU32 = AtomicU32::new(0);

/// The port. Nothing here waits: bytes without room are sent at a later call.
pub struct Serial {
    incoming: Consumer<'static, u8>,
    /// The clock at the end of the last written byte.
    free: u32,
}

/// Opens the port. Call it once, after [`lower_all`](crate::board::critical::lower_all).
pub fn open() -> Serial {
    static QUEUE: StaticCell<Queue<u8, WAITING>> = StaticCell::new();
    let (producer, incoming) = QUEUE.init_with(Queue::new).split();
    // SAFETY: the interrupt that uses the cell is not enabled yet.
    unsafe { INCOMING.init(producer) };
    // SAFETY: nothing else uses the port, and its interrupt finds the cell filled.
    unsafe {
        CONTROL.write_volatile(ON);
        NVIC::unmask(Interrupt);
    }
    Serial { incoming, free: tick_timer::now() }
}

/// Handles received bytes.
///
/// # Safety
/// Only the handler of the port's interrupt may call it.
pub(super) unsafe fn receive() {
    // SAFETY: the cell was filled before the interrupt was enabled, and nothing else uses it.
    let incoming = unsafe { INCOMING.borrow_mut() };
    // SAFETY: the port's registers; reading the data clears the flag.
    while unsafe { STATUS.read_volatile() } & RECEIVED != 0 {
        let byte = unsafe { DATA.read_volatile() } as u8;
        if incoming.enqueue(byte).is_err() {
            LOST.fetch_add(1, Ordering::Relaxed);
        }
    }
}

/// Bytes that were lost because earlier bytes were not read.
#[cfg(feature = "log")]
pub fn lost() -> u32 {
    LOST.load(Ordering::Relaxed)
}

impl Port for Serial {
    fn read(&mut self, bytes: &mut [u8]) -> usize {
        let mut count = 0;
        for place in bytes {
            let Some(byte) = self.incoming.dequeue() else { break };
            *place = byte;
            count += 1;
        }
        count
    }

    /// The emulated port takes any number of bytes in no time; this limits it to the rate of a line.
    fn write(&mut self, bytes: &[u8]) -> usize {
        if bytes.is_empty() {
            return 0;
        }
        let now = tick_timer::now();
        let busy = self.free.wrapping_sub(now).cast_signed();
        if busy <= 0 {
            self.free = now;
        }
        let waiting = busy.max(0).cast_unsigned().div_ceil(CLOCK_PER_BYTE);
        let count = bytes.len().min(ROOM.saturating_sub(waiting) as usize);
        for &byte in bytes.iter().take(count) {
            // SAFETY: the port's data register, which always has room here.
            unsafe { DATA.write_volatile(byte.into()) };
            self.free = self.free.wrapping_add(CLOCK_PER_BYTE);
        }
        count
    }
}
