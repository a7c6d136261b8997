//! The rare work of a tick: requests, ramps and swaps. Not inlined, so that it costs the usual tick nothing.

use super::swap::{ARMING, SETTLING};
use super::*;
use crate::current::{MAY_HAVE_BRIDGE, PowerFault};
use crate::fault::FaultRecord;
use crate::host::TickState;

impl<E: Rendering<N>, N: Number, M: OutputMode> ServoLoop<E, N, M> {
    /// Called in every tick except that of a running servo without requests.
    #[cold]
    #[inline(never)]
    pub(super) fn run_state_machine(
        &mut self,
        hardware: &mut impl Hardware,
        inbox: &mut Incoming<'_, E, N, M>,
        dropped: u32,
    ) {
        let requests = inbox.take();
        if requests.host_alive {
            self.on_host_message();
        }
        self.check_link();
        if let Some(number) = requests.arm {
            let reply = self.arm(hardware);
            inbox.reply_to_arm(number, reply);
        }
        if let Some(number) = requests.align {
            let reply = self.align(hardware);
            inbox.reply_to_align(number, reply);
        }
        if requests.disarm {
            self.disarm(hardware, inbox);
        }
        match self.state {
            State::Running => self.begin_swap(inbox),
            State::FadingIn => self.fade_in(inbox),
            State::FadingOut => self.fade_out(hardware, inbox),
            State::Settling => self.settle(inbox),
            State::Disarmed | State::Faulted => self.idle(inbox),
            State::Aligning => self.wait_for_alignment(hardware, inbox),
        }
        if E::Host::IS_PRESENT {
            self.serve_host(inbox);
        }
        if let Some(number) = requests.status {
            inbox.reply_with_status(number, &self.status(dropped));
        }
    }

    /// The work for a host beside the servo.
    fn serve_host(&mut self, inbox: &Incoming<'_, E, N, M>) {
        let opening = match self.state {
            State::Running => Some(0),
            State::FadingIn => {
                let steps = self.rendering.servo_mut().clamp().steps_to_open();
                Some(steps.div_ceil(self.ramp))
            }
            _ => None,
        };
        let (tick, deadline) = (self.tick, self.link_deadline);
        let count = self.rendering.servo().low_count();
        let tick = TickState { tick, count, opening, state: self.state as u32, deadline };
        let host = self.rendering.host_mut();
        host.wait(opening.is_some() || self.state == State::FadingOut);
        // What an alignment moves gives nothing back, nor do the pulses of a bridge that starts up.
        let is_starting = self.state == State::Settling && self.ramp == ARMING;
        if MAY_HAVE_BRIDGE && (is_starting || self.state == State::Aligning) {
            host.cut(false);
        }
        host.exchange(inbox.host(), tick);
    }

    fn arm(&mut self, hardware: &mut impl Hardware) -> Reply {
        if self.state == State::Aligning {
            return Reply::Fault(Fault::Power(PowerFault::NotAligned { by_index: false }));
        }
        if !self.state.is_armed() {
            if let Some(fault) = self.persistent_fault() {
                return Reply::Fault(fault);
            }
            self.fault = None;
            hardware.store_fault(&FaultRecord::NOTHING);
            self.energy.reset();
            // After a fault the environment's state does not match the motor's torque.
            self.rendering.rest_here();
            hardware.amplifier(true);
            self.ramp = ARMING;
            self.begin_settling(hardware.start_up_ticks());
        }
        match (self.state, self.after_fade) {
            (State::FadingOut, AfterFade::Stop(fault)) => return Reply::Fault(fault),
            (State::FadingOut, AfterFade::Release) => self.state = State::FadingIn,
            _ => {}
        }
        self.after_fade = AfterFade::Render;
        Reply::Done
    }

    /// Begins to align a brushless motor: its field turns the handle, and no scene is rendered.
    fn align(&mut self, hardware: &mut impl Hardware) -> Reply {
        if self.state.is_armed() && self.state != State::Aligning {
            return Reply::Armed;
        }
        if let Some(fault) = self.persistent_fault() {
            return Reply::Fault(fault);
        }
        if let Err(fault) = hardware.align() {
            return Reply::Fault(fault);
        }
        self.fault = None;
        hardware.store_fault(&FaultRecord::NOTHING);
        self.rendering.servo_mut().clamp().shut();
        self.state = State::Aligning;
        Reply::Done
    }

    /// Waits for the end of an alignment; a fault has stopped the servo before this call. A set is swapped
    /// meanwhile, because nothing is rendered.
    fn wait_for_alignment(
        &mut self,
        hardware: &mut impl Hardware,
        inbox: &mut Incoming<'_, E, N, M>,
    ) {
        self.swap(inbox);
        if !hardware.is_aligning() {
            hardware.amplifier(false);
            self.state = State::Disarmed;
        }
    }

    fn disarm(&mut self, hardware: &mut impl Hardware, inbox: &mut Incoming<'_, E, N, M>) {
        if self.state == State::Aligning {
            hardware.amplifier(false);
            self.state = State::Disarmed;
        }
        if self.state.is_armed() {
            self.ramp = ARMING;
            self.begin_fading_out(AfterFade::Release);
        } else {
            inbox.off();
        }
    }

    /// Closes the clamp from the present torque on, so that the torque decreases at once.
    pub(super) fn begin_fading_out(&mut self, after_fade: AfterFade) {
        self.after_fade = after_fade;
        self.state = State::FadingOut;
        self.rendering.servo_mut().clamp_to_held_torque();
        self.rendering.host_mut().fade_out(self.ramp, self.tick);
    }

    fn fade_in(&mut self, inbox: &Incoming<'_, E, N, M>) {
        if inbox.has_set() {
            return self.begin_fading_out(AfterFade::Render);
        }
        for _ in 0..self.ramp {
            if self.rendering.servo_mut().clamp().open() {
                self.state = State::Running;
            }
        }
    }

    fn fade_out(&mut self, hardware: &mut impl Hardware, inbox: &mut Incoming<'_, E, N, M>) {
        // The clamp was shut before this tick, so this tick's code was mid-scale, or a host's torque alone,
        // which fades as fast.
        if !self.rendering.servo_mut().clamp().is_shut() {
            for _ in 0..self.ramp {
                self.rendering.servo_mut().clamp().close();
            }
            return;
        }
        if !self.rendering.host().is_at_rest() {
            return;
        }
        match self.after_fade {
            AfterFade::Render => {
                if self.waits_for_host(inbox) {
                    return;
                }
                self.swap(inbox);
                self.begin_settling(SETTLING);
            }
            AfterFade::Release => {
                hardware.amplifier(false);
                self.rendering.host_mut().cut(false);
                self.state = State::Disarmed;
                inbox.off();
            }
            AfterFade::Stop(fault) => self.stop(fault, hardware, inbox),
        }
    }

    /// A tick with the amplifier off.
    fn idle(&mut self, inbox: &mut Incoming<'_, E, N, M>) {
        self.swap(inbox);
        self.fault_free_ticks = self.fault_free_ticks.saturating_add(1);
    }

    fn status(&self, dropped: u32) -> Status {
        Status {
            state: self.state,
            fault: self.fault,
            tick: self.tick,
            count: self.rendering.servo().count(),
            period: self.period,
            worst_slack: if self.was_late { 0 } else { self.deadline.wrapping_sub(self.longest) },
            missed: self.missed,
            dropped,
            energy: self.energy.net(),
            worst_deficit: self.energy.worst(),
            link_lost: self.link_lost,
        }
    }
}
