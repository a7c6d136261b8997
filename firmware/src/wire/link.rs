//! A board's serial port with its session.

use super::{BoardInfo, Session};
use crate::boot::{Booted, Program, Startup, boot};
use crate::number::Number;
use crate::rendering::Rendering;
use crate::servo::{OutputMode, Step, SupportsTiming};
use crate::servo_loop::{Endpoints, FRAMES, ServoIsr};
use crate::tuning::Tunable;

/// A serial port that never waits.
pub trait Port {
    /// Reads received bytes into `bytes`, as many as fit; returns their number.
    fn read(&mut self, bytes: &mut [u8]) -> usize;
    /// Sends as many of the bytes as the port has room for; returns their number.
    fn write(&mut self, bytes: &[u8]) -> usize;
}

/// A port and its session.
pub struct Link<P, E: Rendering<N> + 'static, N: Number, M: 'static> {
    /// The port.
    pub port: P,
    /// Its session.
    pub session: Session<'static, E, N, M, FRAMES>,
}

/// Bytes that are taken at once: about those of a millisecond.
const PIECE: usize = 64;

impl<P: Port, E, N, M> Link<P, E, N, M>
where
    E: Tunable<N> + SupportsTiming<M>,
    N: Number,
    M: OutputMode,
{
    /// Reads the received bytes, answers one message, and sends as much as fits. Call it in a loop, at a
    /// priority below the servo's.
    pub fn poll(&mut self) {
        let mut bytes = [0; PIECE];
        let count = self.port.read(&mut bytes);
        self.session.receive(bytes.get(..count).unwrap_or_default());
        self.session.poll();
        let sent = self.port.write(self.session.outgoing());
        self.session.sent(sent);
    }
}

/// The interrupt's state, and the link below it.
pub type BroughtUp<H, P, E, N, M> = (ServoIsr<H, E, N, M>, Link<P, E, N, M>);

/// Everything from reset to the first tick of a board. The board must then begin its periods, call
/// [`ServoIsr::tick`] in each of them, and call [`Link::poll`] in a loop at a lower priority. The servo stays
/// off until the host arms it, or this reset is a power-on and the program arms it then.
///
/// `name` is the name of the program. The package `own-board` is an example.
///
/// # Errors
/// If the board refuses the scene: the step of the self-check that failed. The amplifier is then off.
pub fn bring_up<H, P, E, N, M>(
    name: &'static str,
    program: Program<E>,
    mut hardware: H,
    port: P,
    endpoints: Endpoints<E, N, M>,
) -> Result<BroughtUp<H, P, E, N, M>, Step>
where
    H: Startup,
    E: Tunable<N> + SupportsTiming<M>,
    N: Number,
    M: OutputMode,
{
    let Endpoints { requests, inbox, frames, frame_reader } = endpoints;
    let Booted { servo_loop, margin, reset, previous_fault, .. } =
        boot(&program, &mut hardware, &requests)?;
    let info = BoardInfo {
        name,
        timer_counts: hardware.period(),
        reset,
        low_brown_out: false,
        previous_fault,
        stack_left: || None,
        power: || None,
    };
    let session = Session::new(program, margin, info, requests, frame_reader);
    Ok((ServoIsr { servo_loop, hardware, inbox, frames }, Link { port, session }))
}
