//! The serial port to the host, which arms, tunes and monitors the servo. Nothing here waits. Bytes without
//! room are lost with their frame, which the host sends again.

use haptic_servo::wire::Port;
use heapless::spsc::{Consumer, Producer};
use stm32_metapac::USART3;

/// The port's end below all interrupts.
pub struct Serial(pub Consumer<'static, u8>);

/// Stores a received byte; called by the port's interrupt.
pub fn receive(received: &mut Producer<'static, u8>) {
    // This order also ends an overrun.
    let (status, data) = (USART3.sr().read(), USART3.dr().read());
    if status.rxne() {
        let _ = received.enqueue(data.dr() as u8);
    }
}

impl Port for Serial {
    fn read(&mut self, bytes: &mut [u8]) -> usize {
        let received = core::iter::from_fn(|| self.0.dequeue());
        bytes.iter_mut().zip(received).map(|(place, byte)| *place = byte).count()
    }

    fn write(&mut self, bytes: &[u8]) -> usize {
        match bytes.first() {
            Some(byte) if USART3.sr().read().txe() => {
                USART3.dr().write(|w| w.set_dr((*byte).into()));
                1
            }
            _ => 0,
        }
    }
}
