//! A live view of a board: its messages, their history, and the screen.

mod canvas;
pub mod control;
pub mod keys;
pub(crate) mod modes;
pub(crate) mod record;
pub(crate) mod screen;
#[cfg(test)]
mod tests;
pub(crate) mod tui;

use haptic_servo::wire::Discarded;
use haptic_servo::wire::message::{ActiveParameters, Status};

pub use haptic_model::board::{Power, formatting, history, sample};

use self::control::Control;
use self::history::History;
use self::sample::{Sample, Scale};
use crate::link::{Connected, Event};

/// The state of a board.
#[derive(Clone, Debug)]
pub struct Scope {
    /// Its address.
    pub address: String,
    /// Its own description.
    pub connected: Option<Connected>,
    scale: Option<Scale>,
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

impl Scope {
    /// Nothing is known yet of the board there; `window` seconds are kept.
    pub fn new(address: String, window: f64) -> Self {
        let history = History::new(window);
        let control = Control::default();
        Self {
            address,
            connected: None,
            scale: None,
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
            Event::Connected(connected) => {
                self.scale = Some(Scale::new(connected.units));
                self.connected = Some(connected);
                self.lost = None;
                self.history.clear();
            }
            Event::Ticks(frames) => {
                let Some(scale) = &mut self.scale else { return Ok(()) };
                for frame in &frames {
                    let sample = scale.sample(frame);
                    each(&sample)?;
                    self.history.push(sample);
                }
            }
            Event::Status(status, discarded) => self.status = Some((status, discarded)),
            Event::ActiveParameters(parameters) => self.parameters = Some(parameters),
            Event::Description(_) | Event::Host(_) => {}
            Event::Reply(request, reply) => self.control.message = Some(reply.line(&request)),
            Event::Lost(why) => self.lost = Some(why),
        }
        Ok(())
    }
}
