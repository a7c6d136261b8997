//! The servo's interrupt, on every board.
//!
//! ```text
//! count -> servo -> code -> DAC           in every tick, in every state
//! disarmed -> fading in -> running -> fading out -> disarmed, or settling -> fading in
//!     any of them -> faulted -> (armed again) -> fading in
//! ```
//!
//! The usual tick, running and without requests, goes straight through [`ServoLoop::run`]; rare
//! work is kept out of line.

mod fault_detection;
mod frame;
mod frame_queue;
mod hardware;
mod isr;
mod mailbox;
mod options;
mod period_clock;
mod state;
mod state_machine;
mod swap;

pub use frame::{Frame, FrameSink};
pub use frame_queue::{FrameQueue, FrameReader, Frames};
pub use hardware::{BEGAN_LATE, Hardware};
pub use isr::{Endpoints, FRAMES, ServoIsr};
pub use mailbox::{Inbox, Mailbox, Requests};
pub use options::{Arming, LinkPolicy, Options, Reason};
pub use period_clock::PeriodClock;
pub use state::{Notice, State, Status};
pub use swap::longest_gap;

pub use crate::output_timing::READ_WITHIN;

use crate::dac::DacCode;
use crate::energy::EnergyMonitor;
use crate::environment::Discretize;
use crate::fault::Fault;
use crate::number::Number;
use crate::output_timing::OutputMode;
use crate::servo::{PreparedServo, TimingLimits};
use crate::torque::LimitReason;

/// What becomes of the servo once its clamp is shut.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum AfterFade {
    /// It renders, with the set that waits.
    Render,
    /// The amplifier goes off.
    Release,
    /// The amplifier goes off because of this.
    Stop(Fault),
}

/// The last tick that began late, and by what part of a period.
#[derive(Clone, Copy, Debug, Default)]
struct MissedUpdates {
    tick: u32,
    part: f32,
}

/// The servo on a board: its rendering, its state, and its fault detection.
#[derive(Clone, Debug)]
pub struct ServoLoop<E: Discretize<N>, N: Number, M> {
    rendering: PreparedServo<E, N, M>,
    energy: EnergyMonitor,
    state: State,
    after_fade: AfterFade,
    fault: Option<Fault>,
    tick: u32,
    /// Timer counts in a period.
    period: u32,
    /// Timer counts that a tick has: a period, or the time until its code is put out.
    deadline: u32,
    late: MissedUpdates,
    /// Updates missed since the start.
    missed: u32,
    /// The longest tick so far that was in time, in timer counts.
    longest: u32,
    /// Whether a tick was not in time.
    was_late: bool,
    /// Steps of the clamp a tick.
    ramp: u32,
    /// Ticks until the samples of a new set have filled its memory.
    settling: u32,
    /// The last fault that was detected, and the ticks since then without amplifier.
    detected_fault: Option<Fault>,
    fault_free_ticks: u32,
    link: LinkPolicy,
    /// Ticks of silence after which the host counts as lost, if it can.
    link_timeout: u32,
    /// The tick in which the host counts as lost.
    link_deadline: u32,
    link_lost: bool,
}

impl<E: Discretize<N>, N: Number, M: OutputMode> ServoLoop<E, N, M> {
    /// A cycle around a rendering, disarmed.
    ///
    /// `period` is the number of timer counts in a period, and `previous_fault` the fault from
    /// before the last reset.
    pub fn new(
        rendering: PreparedServo<E, N, M>,
        options: &Options,
        period: u32,
        previous_fault: Option<Fault>,
    ) -> Self {
        let link_timeout = match options.link {
            LinkPolicy::Ignore => TimingLimits::LONGEST,
            LinkPolicy::Hold | LinkPolicy::Release => {
                rendering.timing_limits().ticks(options.link_timeout)
            }
        };
        let phase = M::TIMING.phase().map(|phase| phase / rendering.timing_limits().period);
        // The cast rounds down, and the hardware up.
        let deadline = phase.map_or(period, |phase| (phase * f64::from(period)) as u32);
        Self {
            rendering,
            energy: phase.map_or_else(EnergyMonitor::default, EnergyMonitor::with_phase),
            state: State::Disarmed,
            after_fade: AfterFade::Release,
            fault: previous_fault,
            tick: 0,
            period,
            deadline,
            late: MissedUpdates::default(),
            missed: 0,
            longest: 0,
            was_late: false,
            ramp: swap::ARMING,
            settling: 0,
            detected_fault: None,
            fault_free_ticks: 0,
            link: options.link,
            link_timeout,
            link_deadline: link_timeout,
            link_lost: false,
        }
    }

    /// One interrupt.
    #[inline(always)]
    pub fn run(
        &mut self,
        hardware: &mut impl Hardware,
        inbox: &mut Inbox<'_, PreparedServo<E, N, M>>,
        frames: &mut impl FrameSink,
    ) {
        // Sampling: the count and the time that belongs to it.
        let (passed, raw) = (hardware.periods_since_last(), hardware.count());
        let mut tick = self.tick.wrapping_add(passed);
        self.tick = tick;
        // One jump each, none of them taken in a usual tick: conditions that are put together first
        // cost three or four instructions each. And before there is a torque, or after there is a
        // code: what a call must not touch costs an instruction or two to be kept from it.
        if passed != 1 {
            tick = self.check_tick_timing(passed, raw, hardware, inbox);
        }
        // Control: from the count to the code of this tick.
        let before = self.rendering.servo().low_count();
        let output = self.rendering.tick(raw, &self.energy);
        let count = self.rendering.servo().low_count();
        let step = count.wrapping_sub(before);
        if self.rendering.timing_limits().is_too_far(step) {
            self.check_jump(passed, step, hardware, inbox);
        }
        if let Some(fault) = hardware.output_fault() {
            self.stop_by_output(fault, hardware, inbox);
        }
        if output.limit == LimitReason::NotANumber {
            self.stop_on_nan(hardware, inbox);
        }
        let mut pending = inbox.pending();
        let mut code = output.code;
        if self.state != State::Running {
            code = self.unless_disarmed(code);
            pending = u32::MAX;
        }
        // Output: put out by the timer, at the beginning of the next period or at a phase of this one.
        hardware.write(code);
        // Before that phase, or after it: asked here, since from a late code the hardware has to be kept.
        let mut slack = 0;
        if M::TIMING.is_at_phase() {
            slack = self.slack(hardware, inbox);
        }
        // Bookkeeping: energy, requests and states, watchdog, telemetry.
        self.energy.observe::<M>(step, code);
        let link_due = tick.wrapping_sub(self.link_deadline).cast_signed() >= 0;
        if pending != 0 || link_due {
            self.run_state_machine(hardware, inbox, frames.dropped());
        }
        hardware.feed_watchdog();
        if !M::TIMING.is_at_phase() {
            slack = self.slack(hardware, inbox);
        }
        frames.push(Frame { tick, count, code, limit: output.limit, state: self.state, slack });
    }

    /// Timer counts that are left of those that the tick has.
    #[inline(always)]
    fn slack(
        &mut self,
        hardware: &mut impl Hardware,
        inbox: &mut Inbox<'_, PreparedServo<E, N, M>>,
    ) -> u32 {
        let elapsed = hardware.time_in_period();
        if elapsed > self.longest {
            return self.check_longest_tick(elapsed, hardware, inbox);
        }
        self.deadline.wrapping_sub(elapsed)
    }

    /// The rendering.
    pub const fn rendering(&self) -> &PreparedServo<E, N, M> {
        &self.rendering
    }

    /// The servo's state.
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
