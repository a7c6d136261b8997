//! The serial port to the host, filled and emptied in interrupts below the servo's.

use core::pin::pin;
use core::task::{Context, Poll, Waker};

use embassy_stm32::Peri;
use embassy_stm32::interrupt::typelevel::Binding;
use embassy_stm32::usart::{
    BufferedInterruptHandler, BufferedUart, Config, Instance, RxPin, TxPin,
};
use embedded_io_async::{Read, Write};
use static_cell::StaticCell;

use crate::board::BAUD;
use crate::wire::Port;

/// Capacity for received bytes: 5 ms at the line's rate, about ten times as long as the task needs for
/// anything except a certificate, during which the host waits for its answer.
const RECEIVED: usize = 256;
/// Capacity for bytes to be sent.
const SENT: usize = 256;

/// Bytes that are passed to the driver at once.
const PIECE: usize = 64;

/// The port. Nothing here waits: bytes without room are sent at a later call.
pub struct Serial(BufferedUart<'static>);

/// Opens a port on these pins. Call it once.
pub fn open<T: Instance>(
    port: Peri<'static, T>,
    rx: Peri<'static, impl RxPin<T>>,
    tx: Peri<'static, impl TxPin<T>>,
    interrupts: impl Binding<T::Interrupt, BufferedInterruptHandler<T>> + 'static,
) -> Serial {
    static SENDING: StaticCell<[u8; SENT]> = StaticCell::new();
    static RECEIVING: StaticCell<[u8; RECEIVED]> = StaticCell::new();
    let (sending, receiving) = (SENDING.init([0; _]), RECEIVING.init([0; _]));
    let mut config = Config::default();
    config.baudrate = BAUD;
    let port = BufferedUart::new(port, rx, tx, sending, receiving, interrupts, config);
    // The rate is a constant, and each board's clock divides into it. A build with another clock would stop
    // here at its first start, with the amplifier off.
    Serial(port.expect("the port's clock divides into the line's rate"))
}

impl Port for Serial {
    fn read(&mut self, bytes: &mut [u8]) -> usize {
        match now(self.0.read(bytes)) {
            Some(Ok(count)) => count,
            Some(Err(_)) | None => 0,
        }
    }

    fn write(&mut self, bytes: &[u8]) -> usize {
        let mut sent = 0;
        for piece in bytes.chunks(PIECE) {
            // The driver takes all of a piece or none of it.
            if !matches!(now(self.0.write(piece)), Some(Ok(_))) {
                break;
            }
            sent += piece.len();
        }
        sent
    }
}

/// Polls a future once. No waker is needed: the executor polls again after the next interrupt, and
/// the port's own interrupts are among those.
fn now<T>(future: impl Future<Output = T>) -> Option<T> {
    match pin!(future).poll(&mut Context::from_waker(Waker::noop())) {
        Poll::Ready(value) => Some(value),
        Poll::Pending => None,
    }
}
