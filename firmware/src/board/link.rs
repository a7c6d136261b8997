//! A board's serial port with the board's end of the wire at it.

use super::servo_isr::FRAMES;
use crate::environment::Discretize;
use crate::number::Number;
use crate::servo::{OutputMode, SupportsTiming};
use crate::tuning::Tunable;
use crate::wire::Session;

/// A serial port that never waits.
pub trait Port {
    /// Reads received bytes, as far as there is room; returns their number.
    fn read(&mut self, bytes: &mut [u8]) -> usize;
    /// Sends as many of the bytes as there is room for; gives their number.
    fn write(&mut self, bytes: &[u8]) -> usize;
}

/// A port with a session at it.
pub struct Link<P, E: Discretize<N> + 'static, N: Number, M: 'static> {
    /// The port.
    pub port: P,
    /// Its session.
    pub session: Session<'static, E, N, M, FRAMES>,
}

/// Bytes that are taken at once: at most what arrives within a millisecond or so.
const PIECE: usize = 64;

impl<P: Port, E, N, M> Link<P, E, N, M>
where
    E: Tunable<N> + SupportsTiming<M>,
    N: Number,
    M: OutputMode,
{
    /// Hears what has come, answers one thing, and sends what fits. To be called over and over,
    /// below the servo's priority.
    pub fn poll(&mut self) {
        let mut bytes = [0; PIECE];
        let count = self.port.read(&mut bytes);
        self.session.receive(bytes.get(..count).unwrap_or_default());
        self.session.poll();
        let sent = self.port.write(self.session.outgoing());
        self.session.sent(sent);
    }
}
