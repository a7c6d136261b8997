//! A host whose budget and times are known at run time, as those of a scene file are.

use super::{BesideServo, HostError, HostTimes, HostTorque, HostWords, Hosted, Reported};
use super::{ServoNumbers, Taken, TickState};
use crate::current::HeatStep;
use crate::output_timing::OutputTiming;

/// A host beside a servo, of any of the types that [`Hosted`] has in programs, to the bit.
#[derive(Clone, Debug)]
pub enum AnyHosted {
    /// A torque is put out at its count.
    Prompt(Hosted<0, 0>),
    /// The same with a delay or a lag.
    PromptLagging(Hosted<0, 1>),
    /// A torque is put out at the next count.
    Latched(Hosted<1, 0>),
    /// The same with a lag.
    LatchedLagging(Hosted<1, 1>),
}

macro_rules! each {
    ($any:expr, $hosted:ident => $value:expr) => {
        match $any {
            AnyHosted::Prompt($hosted) => $value,
            AnyHosted::PromptLagging($hosted) => $value,
            AnyHosted::Latched($hosted) => $value,
            AnyHosted::LatchedLagging($hosted) => $value,
        }
    };
}

impl AnyHosted {
    /// Level of the tank in J.
    pub fn energy(&self) -> f64 {
        each!(self, hosted => hosted.energy())
    }
}

impl BesideServo for AnyHosted {
    #[cfg(feature = "wire")]
    type IfPresent<T: serde::Serialize + serde::de::DeserializeOwned> = T;
    type Channel = HostWords;
    type Reported = Reported;
    type Budget = HostTorque;
    const IS_PRESENT: bool = true;

    fn silent() -> Self {
        Self::Prompt(Hosted::silent())
    }

    fn beside(host: &HostTorque, servo: &ServoNumbers<'_>) -> Result<Self, HostError> {
        let is_latched = servo.output == OutputTiming::Latched;
        Ok(match (is_latched, HostTimes::of(servo.latency, servo.timing.period).is_plain) {
            (false, true) => Self::Prompt(Hosted::beside(host, servo)?),
            (false, false) => Self::PromptLagging(Hosted::beside(host, servo)?),
            (true, true) => Self::Latched(Hosted::beside(host, servo)?),
            (true, false) => Self::LatchedLagging(Hosted::beside(host, servo)?),
        })
    }

    fn begin(&mut self) -> i32 {
        each!(self, hosted => hosted.begin())
    }

    fn due(&self) -> Option<u32> {
        each!(self, hosted => hosted.due())
    }

    fn refused(&mut self, moved: i32) -> i32 {
        each!(self, hosted => hosted.refused(moved))
    }

    fn host(budget: &HostTorque) -> Option<HostTorque> {
        Some(*budget)
    }

    fn budget(host: HostTorque) -> HostTorque {
        host
    }

    fn wait(&mut self, may_give: bool) {
        each!(self, hosted => hosted.wait(may_give));
    }

    fn fade_out(&mut self, steps: u32, tick: u32) {
        each!(self, hosted => hosted.fade_out(steps, tick));
    }

    fn is_at_rest(&self) -> bool {
        each!(self, hosted => hosted.is_at_rest())
    }

    fn may_pass_to(&self, next: &Self) -> bool {
        match (self, next) {
            (Self::Prompt(last), Self::Prompt(next)) => last.may_pass_to(next),
            (Self::PromptLagging(last), Self::PromptLagging(next)) => last.may_pass_to(next),
            (Self::Latched(last), Self::Latched(next)) => last.may_pass_to(next),
            (Self::LatchedLagging(last), Self::LatchedLagging(next)) => last.may_pass_to(next),
            _ => false,
        }
    }

    fn take_over(&mut self, last: &Self) {
        match (self, last) {
            (Self::Prompt(next), Self::Prompt(last)) => next.take_over(last),
            (Self::PromptLagging(next), Self::PromptLagging(last)) => next.take_over(last),
            (Self::Latched(next), Self::Latched(last)) => next.take_over(last),
            (Self::LatchedLagging(next), Self::LatchedLagging(last)) => next.take_over(last),
            // It may not pass to a host of another type.
            _ => {}
        }
    }

    fn cut(&mut self, by_fault: bool) {
        each!(self, hosted => hosted.cut(by_fault));
    }

    fn drain(&mut self) {
        each!(self, hosted => hosted.drain());
    }

    fn step_by_heat(&mut self, step: HeatStep, tick: u32) -> bool {
        each!(self, hosted => hosted.step_by_heat(step, tick))
    }

    fn exchange(&mut self, channel: &HostWords, tick: TickState) {
        each!(self, hosted => hosted.exchange(channel, tick));
    }

    fn send(channel: &HostWords, number: u16, torque: f32, ramp: u16) {
        Hosted::<0, 0>::send(channel, number, torque, ramp);
    }

    fn report(channel: &HostWords, reported: &mut Reported) -> Option<Taken> {
        Hosted::<0, 0>::report(channel, reported)
    }

    fn ask(reported: &mut Reported, id: u16, budget: HostTorque) {
        Hosted::<0, 0>::ask(reported, id, budget);
    }

    fn asking(reported: &Reported) -> Option<u16> {
        Hosted::<0, 0>::asking(reported)
    }

    fn asked(reported: &mut Reported) -> Option<(u16, HostTorque)> {
        Hosted::<0, 0>::asked(reported)
    }

    fn request_budget(reported: &mut Reported) {
        Hosted::<0, 0>::request_budget(reported);
    }

    fn is_budget_due(reported: &mut Reported) -> bool {
        Hosted::<0, 0>::is_budget_due(reported)
    }

    #[cfg(feature = "wire")]
    fn present<T: serde::Serialize + serde::de::DeserializeOwned>(value: T) -> Option<T> {
        Some(value)
    }

    #[cfg(feature = "wire")]
    fn value<T: serde::Serialize + serde::de::DeserializeOwned>(value: T) -> T {
        value
    }
}
