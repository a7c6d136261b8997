//! A live view of a board: its messages, their history, and the screen.

mod canvas;
pub mod control;
pub mod keys;
pub(crate) mod modes;
pub mod poller;
pub(crate) mod record;
pub(crate) mod screen;
#[cfg(test)]
mod tests;
pub(crate) mod tui;

use haptic_servo::wire::Discarded;
use haptic_servo::wire::message::{ActiveParameters, BoardUnits, PreviousFault, Status};

pub use haptic_model::board::{Power, formatting, history, sample};

use self::control::Control;
use self::history::History;
use self::poller::Event;
use self::sample::{Sample, Scale};

/// The state of a board.
#[derive(Clone, Debug)]
pub struct Scope {
    /// Its address.
    pub address: String,
    /// Its own description.
    pub connected: Option<ConnectedBoard>,
    /// Why there is no link now.
    pub lost: Option<String>,
    /// Its last status, and the frames that the host could not read.
    pub status: Option<(Status, Discarded)>,
    /// The active parameters.
    pub parameters: Option<ActiveParameters>,
    /// The last seconds.
    pub history: History,
    /// Requests to the board.
    pub control: Control,
}

/// The board that is connected.
#[derive(Clone, Debug)]
pub struct ConnectedBoard {
    /// Name of its program.
    pub program: String,
    /// The units of its numbers.
    pub board: BoardUnits,
    /// The fault that stopped it before its last start.
    pub previous_fault: Option<PreviousFault>,
    scale: Scale,
}

impl Scope {
    /// Nothing is known yet of the board there; `window` seconds are kept.
    pub fn new(address: String, window: f64) -> Self {
        let history = History::new(window);
        let control = Control::default();
        Self {
            address,
            connected: None,
            lost: None,
            status: None,
            parameters: None,
            history,
            control,
        }
    }

    /// Handles the board's messages, and passes ticks to `each`.
    pub fn take<E>(
        &mut self,
        event: Event,
        mut each: impl FnMut(&Sample) -> Result<(), E>,
    ) -> Result<(), E> {
        match event {
            Event::Connected { program, board, previous_fault } => {
                let scale = Scale::new(board);
                self.connected = Some(ConnectedBoard { program, board, previous_fault, scale });
                self.lost = None;
                self.history.clear();
            }
            Event::Ticks(frames) => {
                let Some(connected) = &mut self.connected else { return Ok(()) };
                for frame in &frames {
                    let sample = connected.scale.sample(frame);
                    each(&sample)?;
                    self.history.push(sample);
                }
            }
            Event::Status(status, discarded) => self.status = Some((status, discarded)),
            Event::ActiveParameters(parameters) => self.parameters = Some(parameters),
            Event::Reply(request, reply) => self.control.message = Some(reply.line(&request)),
            Event::Lost(why) => self.lost = Some(why),
        }
        Ok(())
    }
}
