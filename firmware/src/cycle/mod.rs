//! What one interrupt of the servo's timer does, on every board.
//!
//! ```text
//! count -> servo -> code -> converter     in every tick, whatever else is the matter
//! disarmed -> fading in -> running -> fading out -> disarmed, or settling -> fading in
//!     any of them -> faulted -> (armed again) -> fading in
//! ```
//!
//! The usual tick, running and with nothing asked for, goes straight through [`Cycle::run`];
//! everything that is rare is kept out of its way.

mod attend;
mod frame;
mod hardware;
mod mailbox;
mod options;
mod state;
mod trouble;

pub use frame::{Frame, FrameQueue, FrameSink, Frames};
pub use hardware::Hardware;
pub use mailbox::{Inbox, Mailbox, Requests};
pub use options::{LinkPolicy, Options};
pub use state::{Notice, State, Status};

use crate::dac::DacCode;
use crate::energy::EnergyMonitor;
use crate::environment::Renderable;
use crate::fault::Fault;
use crate::number::Number;
use crate::servo::{OutputMode, Rendering};
use crate::torque::LimitReason;
use trouble::{Behind, Found};

/// What becomes of the servo once its clamp is shut.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Goal {
    /// It renders, with the set that waits.
    Render,
    /// The amplifier goes off.
    Release,
    /// The amplifier goes off because of this.
    Stop(Fault),
}

/// The servo on a board: its rendering, what it is doing, and what it watches.
#[derive(Clone, Debug)]
pub struct Cycle<E: Renderable<N>, N: Number, M> {
    rendering: Rendering<E, N, M>,
    energy: EnergyMonitor,
    state: State,
    goal: Goal,
    fault: Option<Fault>,
    tick: u32,
    /// Timer counts in a period.
    period: u32,
    behind: Behind,
    /// Updates missed since the start.
    missed: u32,
    worst_slack: u32,
    /// Ticks until the samples of a new set have filled its memory.
    settling: u32,
    /// What was last found that stops a servo, and the ticks since then without amplifier.
    trouble: Option<Fault>,
    calm: u32,
    link: LinkPolicy,
    /// Ticks of silence after which the host counts as lost.
    link_timeout: u32,
}

impl<E: Renderable<N>, N: Number, M: OutputMode> Cycle<E, N, M> {
    /// A cycle around a rendering, disarmed.
    ///
    /// `period` is the number of timer counts in a period, and `left` the fault that was left from
    /// before the last reset.
    pub fn new(
        rendering: Rendering<E, N, M>,
        options: &Options,
        period: u32,
        left: Option<Fault>,
    ) -> Self {
        let link_timeout = rendering.pace().ticks(options.link_timeout);
        Self {
            rendering,
            energy: EnergyMonitor::default(),
            state: State::Disarmed,
            goal: Goal::Release,
            fault: left,
            tick: 0,
            period,
            behind: Behind::default(),
            missed: 0,
            worst_slack: u32::MAX,
            settling: 0,
            trouble: None,
            calm: 0,
            link: options.link,
            link_timeout,
        }
    }

    /// One interrupt.
    #[inline(always)]
    pub fn run(
        &mut self,
        hardware: &mut impl Hardware,
        inbox: &mut Inbox<'_, Rendering<E, N, M>>,
        frames: &mut impl FrameSink,
    ) {
        let (passed, underrun) = (hardware.passed(), hardware.underrun());
        let before = self.rendering.servo().low_count();
        let output = self.rendering.tick(hardware.count(), self.energy.is_deficit());
        let count = self.rendering.servo().low_count();
        let step = count.wrapping_sub(before);
        self.tick = self.tick.wrapping_add(passed);
        let not_a_number = output.limit == LimitReason::NotANumber;
        let too_far = step.unsigned_abs() > self.rendering.pace().largest_step;
        if passed != 1 || too_far || not_a_number || underrun {
            self.examine(Found { passed, step, not_a_number, underrun }, hardware, inbox);
        }
        // Whatever the rest of the program thinks: without being armed there is no torque.
        let code = if self.state.is_armed() { output.code } else { DacCode::MID_SCALE };
        hardware.write(code);
        self.energy.observe::<M>(step, code);
        if self.state != State::Running || inbox.is_asked() {
            self.attend(hardware, inbox, frames.dropped());
        }
        if inbox.silence() == self.link_timeout {
            self.lose_link();
        }
        hardware.feed();
        let slack = self.period.saturating_sub(hardware.elapsed());
        if slack <= self.worst_slack {
            self.short(slack, hardware, inbox);
        }
        frames.push(Frame {
            tick: self.tick,
            count,
            code,
            limit: output.limit,
            state: self.state,
            slack,
        });
    }

    /// The rendering.
    pub const fn rendering(&self) -> &Rendering<E, N, M> {
        &self.rendering
    }

    /// What the servo is doing.
    pub const fn state(&self) -> State {
        self.state
    }

    /// The fault that stopped it, until it is armed again.
    pub const fn fault(&self) -> Option<Fault> {
        self.fault
    }
}

#[cfg(test)]
mod tests;
