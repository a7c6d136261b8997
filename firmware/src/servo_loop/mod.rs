//! The servo loop in the interrupt of every board, with the state of that interrupt and what it shares with the task
//! below it.
//!
//! ```text
//! count -> servo -> code -> DAC           in every tick, in every state
//! disarmed -> fading in -> running -> fading out -> disarmed, or settling -> fading in
//!     any of them -> faulted -> (armed again) -> fading in
//! ```
//!
//! The usual tick, running and without requests, stays in [`ServoLoop::run`]; rare work is in functions that
//! are not inlined.

mod fault_detection;
mod frames;
mod hardware;
#[cfg(not(all(test, feature = "wire")))]
mod interruption;
#[cfg(all(test, feature = "wire"))]
pub(crate) mod interruption;
mod mailbox;
mod options;
mod state;
mod state_machine;
mod swap;

pub use frames::{Frame, FrameQueue, FrameReader, FrameSink, Frames};
pub use hardware::{BEGAN_LATE, Hardware, OutputEvent, PeriodClock};
pub use mailbox::{Exchanged, Inbox, Mailbox, Requests};
pub use options::{Arming, LinkPolicy, Options, Reason};
pub use state::{Reply, State, Status};
pub use swap::longest_gap;

pub use crate::output_timing::READ_WITHIN;

use crate::dac::DacCode;
use crate::energy::EnergyMonitor;
use crate::fault::Fault;
use crate::host::BesideServo;
use crate::number::Number;
use crate::output_timing::OutputMode;
use crate::rendering::Rendering;
use crate::servo::{PreparedServo, TimingLimits};
use crate::torque::LimitReason;

/// The interrupt's end of the mailbox, with its sets.
type Incoming<'a, E, N, M> = Inbox<'a, PreparedServo<E, N, M>>;

impl<E: Rendering<N>, N: Number, M> Exchanged for PreparedServo<E, N, M> {
    type Channel = <E::Host as BesideServo>::Channel;
}

/// The action after the clamp has closed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum AfterFade {
    /// Swap the waiting set in, and render.
    Render,
    /// Switch the amplifier off.
    Release,
    /// Switch the amplifier off because of this fault.
    Stop(Fault),
}

/// The last tick that began late, and its lateness in periods.
#[derive(Clone, Copy, Debug, Default)]
struct MissedUpdates {
    tick: u32,
    part: f32,
}

/// The servo loop of a board: the servo, its state, and its fault detection.
#[derive(Clone, Debug)]
pub struct ServoLoop<E: Rendering<N>, N: Number, M> {
    rendering: PreparedServo<E, N, M>,
    energy: EnergyMonitor,
    state: State,
    after_fade: AfterFade,
    fault: Option<Fault>,
    tick: u32,
    /// Timer counts in a period.
    period: u32,
    /// Timer counts available to a tick: a period, or the time until the output of its code.
    deadline: u32,
    late: MissedUpdates,
    /// Updates missed since the start.
    missed: u32,
    /// The longest tick so far that met its deadline, in timer counts.
    longest: u32,
    /// Whether a tick missed its deadline.
    was_late: bool,
    /// Steps of the clamp per tick.
    ramp: u32,
    /// Ticks until samples have filled the memory of a new set.
    settling: u32,
    /// The last detected fault, and the ticks since then with the amplifier off.
    detected_fault: Option<Fault>,
    fault_free_ticks: u32,
    link: LinkPolicy,
    /// Ticks without a message after which the host counts as lost.
    link_timeout: u32,
    /// The tick from which on the host counts as lost.
    link_deadline: u32,
    link_lost: bool,
}

impl<E: Rendering<N>, N: Number, M: OutputMode> ServoLoop<E, N, M> {
    /// A disarmed loop with this servo.
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
        // The cast rounds down; the hardware rounds up.
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
        inbox: &mut Incoming<'_, E, N, M>,
        frames: &mut impl FrameSink,
    ) {
        // Sampling: the count and its time.
        let (passed, raw) = hardware.sample();
        let mut tick = self.tick.wrapping_add(passed);
        self.tick = tick;
        // Each condition is one branch that a usual tick does not take: conditions combined first cost three
        // or four instructions each. The calls are before the torque is computed or after the code is known,
        // because each value that is kept across a call costs an instruction or two.
        if passed != 1 {
            tick = self.check_tick_timing(passed, raw, hardware, inbox);
        }
        // Control: from the count to the code of this tick.
        let before = self.rendering.servo().low_count();
        let output = self.rendering.tick(raw, &self.energy);
        let count = self.rendering.servo().low_count();
        let step = count.wrapping_sub(before);
        let (mut code, mut limit) = (output.code, output.limit);
        // Beside the difference, whose flags it takes, and without a call, for which values would be kept.
        if step == 0 && hardware.rested(tick) {
            limit = LimitReason::NotANumber;
        }
        if self.rendering.timing_limits().is_too_far(step) {
            self.check_jump(passed, step, hardware, inbox);
        }
        if E::Host::IS_PRESENT {
            // Beside the torque with which the coupling is solved: that of the scene follows from the positions
            // alone. After the check of its step, which empties the tank where it stops the servo, and before the
            // other faults, because fewer values are kept then.
            code = code.beside(self.rendering.host_mut().begin());
            let refused = self.rendering.host_mut().refused(step);
            if refused != 0 {
                code = code.beside(-refused);
                if limit != LimitReason::NotANumber {
                    limit = LimitReason::Energy;
                }
            }
        }
        if let Some(event) = hardware.output_event() {
            self.on_output_event(event, hardware, inbox);
        }
        if limit == LimitReason::NotANumber {
            limit = self.stop_without_torque(step, hardware, inbox);
        }
        let mut pending = inbox.pending();
        if self.state != State::Running {
            code = self.unless_disarmed(code);
            pending = u32::MAX;
        }
        // Output: the timer puts the code out at the beginning of the next period, or at a phase of this
        // period.
        hardware.write(code);
        // With a phase, the deadline is checked here, because a late code must be overwritten.
        let mut slack = 0;
        if M::TIMING.is_at_phase() {
            slack = self.slack(hardware, inbox);
        }
        // Beside a host these are read again: its tank leaves no register to keep them in.
        let mut count = count;
        if E::Host::IS_PRESENT {
            (tick, count) = (self.tick, self.rendering.servo().low_count());
        }
        // Bookkeeping: energy, requests and states, watchdog, telemetry.
        self.energy.observe::<M>(step, code);
        // A host's due tick is at most the link's.
        let due = self.rendering.host().due().unwrap_or(self.link_deadline);
        if pending != 0 || tick.wrapping_sub(due).cast_signed() >= 0 {
            self.run_state_machine(hardware, inbox, frames.dropped());
        }
        hardware.feed_watchdog();
        if !M::TIMING.is_at_phase() {
            slack = self.slack(hardware, inbox);
        }
        frames.push(Frame { tick, count, code, limit, state: self.state, slack });
    }

    /// Timer counts left until the tick's deadline.
    #[inline(always)]
    fn slack(&mut self, hardware: &mut impl Hardware, inbox: &mut Incoming<'_, E, N, M>) -> u32 {
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

    /// The fault that stopped the servo, until the next arming.
    pub const fn fault(&self) -> Option<Fault> {
        self.fault
    }
}

/// Capacity of the queue of frames, a power of two: 1.6 ms at 20 kHz.
pub const FRAMES: usize = 32;

/// State of the servo's interrupt.
pub struct ServoIsr<H, E: Rendering<N> + 'static, N: Number, M: 'static> {
    /// The servo and its state.
    pub servo_loop: ServoLoop<E, N, M>,
    /// The board's registers.
    pub hardware: H,
    /// Requests from the task.
    pub inbox: Inbox<'static, PreparedServo<E, N, M>>,
    /// Frames to the task.
    pub frames: Frames<'static, FRAMES>,
}

impl<H: Hardware, E: Rendering<N>, N: Number, M: OutputMode> ServoIsr<H, E, N, M> {
    /// One tick.
    #[inline(always)]
    pub fn tick(&mut self) {
        self.servo_loop.run(&mut self.hardware, &mut self.inbox, &mut self.frames);
    }
}

/// Endpoints of interrupt and task.
pub struct Endpoints<E: Rendering<N> + 'static, N: Number, M: 'static> {
    /// The task's end of the mailbox.
    pub requests: Requests<'static, PreparedServo<E, N, M>>,
    /// The interrupt's end of the mailbox.
    pub inbox: Inbox<'static, PreparedServo<E, N, M>>,
    /// The interrupt's end of the queue of frames.
    pub frames: Frames<'static, FRAMES>,
    /// The task's end of the queue of frames.
    pub frame_reader: FrameReader<'static, FRAMES>,
}

impl<E: Rendering<N>, N: Number, M: OutputMode> Endpoints<E, N, M> {
    /// The ends of a mailbox and of a queue of frames in statics.
    pub fn of(
        mailbox: &'static mut Mailbox<PreparedServo<E, N, M>>,
        queue: &'static mut FrameQueue<FRAMES>,
    ) -> Self {
        let (requests, inbox) = mailbox.split();
        let (frames, frame_reader) = queue.split();
        Self { requests, inbox, frames, frame_reader }
    }
}

#[cfg(test)]
pub(crate) mod tests;
