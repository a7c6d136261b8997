//! Detects faults in a tick and stops the servo. Not inlined, like all rare paths.

use super::swap::ARMING;
use super::*;
use crate::encoder::RawCount;
use crate::environment::MAX_DELAY;
use crate::fault::FaultRecord;
use crate::output_timing::OutputTiming;

/// Ticks in a row without a fault before the servo may be armed.
const FAULT_FREE_TICKS: u32 = MAX_DELAY as u32 + 2;

impl<E: Rendering<N>, N: Number, M: OutputMode> ServoLoop<E, N, M> {
    /// The code in a state other than running: mid-scale unless the servo is armed and renders.
    #[cold]
    #[inline(never)]
    pub(super) fn unless_disarmed(&self, code: DacCode) -> DacCode {
        let renders = self.state.is_armed() && self.state != State::Aligning;
        if renders { code } else { DacCode::MID_SCALE }
    }

    /// Handles missed updates and a tick that began late. Returns the number of the tick.
    #[cold]
    #[inline(never)]
    pub(super) fn check_tick_timing(
        &mut self,
        passed: u32,
        raw: RawCount,
        hardware: &mut impl Hardware,
        inbox: &mut Incoming<'_, E, N, M>,
    ) -> u32 {
        let periods = passed.max(1);
        if passed == BEGAN_LATE {
            self.tick = self.tick.wrapping_add(1);
        }
        if let Some(fault) = hardware.reading_fault() {
            self.fail(fault, hardware, inbox);
        }
        self.energy.missed::<M>(self.rendering.servo().step_to(raw));
        let missed = periods - 1;
        self.missed = self.missed.wrapping_add(missed);
        let tolerated = self.rendering.timing_limits().tolerated;
        if missed > tolerated {
            self.fail(Fault::MissedTick { missed, tolerated }, hardware, inbox);
        } else {
            match M::TIMING {
                OutputTiming::Latched => self.unless_latched_in_time(periods, hardware, inbox),
                OutputTiming::AtPhase(_) => self.unless_read_in_time(hardware, inbox),
                OutputTiming::Simultaneous => {}
            }
        }
        self.tick
    }

    /// With a fixed phase, checks the time from the count to its torque: the certificate allows it to be
    /// shorter by the scene's jitter. Whether the code is written in time is checked later.
    fn unless_read_in_time(
        &mut self,
        hardware: &mut impl Hardware,
        inbox: &mut Incoming<'_, E, N, M>,
    ) {
        let late = hardware.lateness_of_count();
        let latest = self.rendering.timing_limits().latest_at_phase();
        let allowed = (latest * self.period as f32) as u32;
        if late > allowed {
            self.fail(Fault::LateTick { late, allowed }, hardware, inbox);
        }
    }

    /// With latched torques, also checks the time from the count to the next latch: see
    /// `certificate::model::Missed`, where `T / T_j` becomes that time over the time between two counts.
    fn unless_latched_in_time(
        &mut self,
        periods: u32,
        hardware: &mut impl Hardware,
        inbox: &mut Incoming<'_, E, N, M>,
    ) {
        let period = self.period as f32;
        let late = hardware.lateness_of_count();
        let follows = self.late.tick == self.tick.wrapping_sub(periods);
        let before = if follows { self.late.part } else { 0.0 };
        let allowed = (self.rendering.timing_limits().latest(periods, before) * period) as u32;
        self.late = MissedUpdates { tick: self.tick, part: late as f32 / period };
        if late > allowed {
            self.fail(Fault::LateTick { late, allowed }, hardware, inbox);
        }
    }

    /// Checks a step that is too far for one period against the periods that have passed.
    #[cold]
    #[inline(never)]
    pub(super) fn check_jump(
        &mut self,
        passed: u32,
        step: i32,
        hardware: &mut impl Hardware,
        inbox: &mut Incoming<'_, E, N, M>,
    ) {
        let largest = self.rendering.timing_limits().largest_step.saturating_mul(passed.max(1));
        let counts = step.unsigned_abs();
        if counts > largest {
            self.fail(Fault::EncoderJump { counts, largest }, hardware, inbox);
        }
    }

    /// Stops the servo at a torque that is not a number, or at an encoder that has stopped. Returns the reason for the
    /// limit of the torque.
    #[cold]
    #[inline(never)]
    pub(super) fn stop_without_torque(
        &mut self,
        step: i32,
        hardware: &mut impl Hardware,
        inbox: &mut Incoming<'_, E, N, M>,
    ) -> LimitReason {
        let stopped = if step == 0 { hardware.stopped() } else { None };
        self.fail(stopped.unwrap_or(Fault::NotANumber), hardware, inbox);
        if stopped.is_some() { LimitReason::None } else { LimitReason::NotANumber }
    }

    /// Stops the servo after the torque output reported a fault and has taken the torque away, or moves a host's
    /// largest torque, or the torque limit of a running servo. The clamp of the other states moves by itself.
    #[cold]
    #[inline(never)]
    pub(super) fn on_output_event(
        &mut self,
        event: OutputEvent,
        hardware: &mut impl Hardware,
        inbox: &mut Incoming<'_, E, N, M>,
    ) {
        match event {
            OutputEvent::Fault(fault) => self.fail(fault, hardware, inbox),
            OutputEvent::Heat(step) => {
                let is_lower = self.rendering.host_mut().step_by_heat(step, self.tick);
                if self.state == State::Running && !is_lower {
                    self.rendering.servo_mut().step_by_heat(step);
                }
            }
        }
    }

    /// Handles a tick that took longer than any before, and returns its slack. With a slack of zero the code
    /// missed its update, and the motor has a torque that differs from the environment's state: no worst
    /// period covers that.
    ///
    /// With a fixed phase that code is not yet at the output, and mid-scale is written over it: the motor
    /// keeps the torque of the tick before until the amplifier is off or the next phase comes.
    #[cold]
    #[inline(never)]
    pub(super) fn check_longest_tick(
        &mut self,
        elapsed: u32,
        hardware: &mut impl Hardware,
        inbox: &mut Incoming<'_, E, N, M>,
    ) -> u32 {
        let allowed = self.deadline;
        if elapsed < allowed {
            self.longest = elapsed;
            return allowed.wrapping_sub(elapsed);
        }
        self.was_late = true;
        self.missed = self.missed.wrapping_add(1);
        let fault = if M::TIMING.is_at_phase() {
            Fault::LateTick { late: elapsed, allowed }
        } else {
            Fault::MissedTick { missed: 1, tolerated: 0 }
        };
        self.fail(fault, hardware, inbox);
        0
    }

    /// Restarts the time after which the host counts as lost.
    pub(super) fn on_host_message(&mut self) {
        self.link_lost = false;
        self.link_deadline = self.tick.wrapping_add(self.link_timeout);
    }

    /// Detects a host that is silent for too long, and fades the torque out under [`LinkPolicy::Release`].
    pub(super) fn check_link(&mut self) {
        if self.tick.wrapping_sub(self.link_deadline).cast_signed() < 0 {
            return;
        }
        // Without a new deadline every later tick would call this function, too.
        self.link_deadline = self.tick.wrapping_add(TimingLimits::LONGEST);
        if self.link == LinkPolicy::Ignore {
            return;
        }
        self.link_lost = true;
        if self.link == LinkPolicy::Release && self.state.is_armed() {
            self.ramp = ARMING;
            self.begin_fading_out(AfterFade::Stop(self.link_lost_fault()));
        }
    }

    fn link_lost_fault(&self) -> Fault {
        Fault::LinkLost { allowed: self.link_timeout }
    }

    /// Records a fault, and stops the servo if the amplifier is on.
    #[cold]
    #[inline(never)]
    pub(super) fn fail(
        &mut self,
        fault: Fault,
        hardware: &mut impl Hardware,
        inbox: &mut Incoming<'_, E, N, M>,
    ) {
        self.detected_fault = Some(fault);
        self.fault_free_ticks = 0;
        // Also disarmed: a step over missed ticks must not count as one of a tick.
        self.rendering.host_mut().cut(true);
        if self.state.is_armed() {
            self.stop(fault, hardware, inbox);
        }
    }

    /// Sets the torque to zero, switches the amplifier off, and records the fault.
    pub(super) fn stop(
        &mut self,
        fault: Fault,
        hardware: &mut impl Hardware,
        inbox: &mut Incoming<'_, E, N, M>,
    ) {
        hardware.write(DacCode::MID_SCALE);
        hardware.amplifier(false);
        self.rendering.host_mut().cut(true);
        self.rendering.servo_mut().clamp().shut();
        self.state = State::Faulted;
        self.fault = Some(fault);
        let count = self.rendering.servo().low_count();
        hardware.store_fault(&FaultRecord { fault, tick: self.tick, count }.encode());
        // A stopped servo is disarmed, as requested.
        inbox.off();
    }

    /// The present fault that would stop the servo immediately after arming.
    pub(super) fn persistent_fault(&self) -> Option<Fault> {
        if self.link == LinkPolicy::Release && self.link_lost {
            return Some(self.link_lost_fault());
        }
        self.detected_fault.filter(|_| self.fault_free_ticks < FAULT_FREE_TICKS)
    }
}
