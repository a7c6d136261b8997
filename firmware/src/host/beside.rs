//! The host beside a servo: its tank in the tick, and its commands and reports below the tick.

use core::fmt;
use core::sync::atomic::{Ordering, compiler_fence};

use super::channel::{HostChannel, HostWords};
use super::stream::Stream;
use super::tank::STEP_BITS;
use super::{HostError, HostResponse, HostTorque, Tank};
use crate::build_error::BuildError;
use crate::current::{HeatStep, MAY_HAVE_BRIDGE};
use crate::environment::FixedDelay;
use crate::latency::Latency;
use crate::output_timing::OutputTiming;
use crate::scene::{Scene, Timing};
use crate::servo::RenderingOptions;
use crate::torque::LimitReason;
use crate::transducers::Transducers;

/// Ticks after the amplifier was switched off in which the device's motion gives nothing back: the rest
/// of the torque is not known then.
const UNKNOWN: u32 = 10;

/// Above the state in a report: why a torque is refused, beside the energy.
const REASON: u32 = 8;
const IS_OPEN: u32 = 0;
const IS_CLOSED: u32 = 1;
const IS_HOT: u32 = 2;

/// A command in a report: the tick that took it, in the servo's units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Taken {
    /// The host's number.
    pub number: u16,
    /// The number of the tick.
    pub tick: u32,
    /// Low 32 bits of the position in counts.
    pub count: i32,
    /// Mean counts a tick since the last report.
    pub speed: f32,
    /// Level of the tank in J.
    pub energy: f32,
    /// Torque in N m that the tick gave.
    pub torque: f32,
    /// Torque in N m that was wanted and not given.
    pub refused: f32,
    /// The reason for that.
    pub limit: LimitReason,
    /// The servo's state as a number.
    pub state: usize,
    /// Commands whose torque was no finite number.
    pub invalid: u16,
}

/// What the task knows of a host: a budget that it wants, and the reports that were sent.
#[derive(Clone, Debug, Default)]
pub struct Reported {
    requested: Option<(u16, HostTorque)>,
    budget_due: bool,
    number: u32,
    tick: u32,
    count: i32,
}

/// A tick's numbers for a report.
#[derive(Clone, Copy, Debug)]
pub struct TickState {
    /// Its number.
    pub tick: u32,
    /// The position in counts.
    pub count: i32,
    /// Ticks until the scene's torque limit is open, 0 in a servo that runs; `None` if it takes no commands.
    pub opening: Option<u32>,
    /// The servo's state as a number.
    pub state: u32,
    /// The tick in which the servo looks at its link again.
    pub deadline: u32,
}

/// What a host needs of a servo.
#[derive(Clone, Copy, Debug)]
pub struct ServoNumbers<'a> {
    /// The latency of the scene.
    pub latency: &'a Latency,
    /// Its timing.
    pub timing: Timing,
    /// Its torque limit in N m, with the largest torque that opposes cogging.
    pub torque_limit: Option<f64>,
    /// The damping in N m s/rad that it leaves over without a host, as far as that is known.
    pub margin: Option<f64>,
    /// Torque of the motor in N m at full scale.
    pub full_scale: f64,
    /// Time in s in which the scene's torque limit opens and closes.
    pub fade: f64,
    /// When a torque is put out.
    pub output: OutputTiming,
    /// An encoder count in rad.
    pub radians_per_count: f64,
    /// Whether a board's own bridge drives the motor, whose supply takes no energy back.
    pub stores: bool,
}

impl<'a> ServoNumbers<'a> {
    /// Of a scene with this margin in N m s/rad, of its servo, and of the largest torque in N m that opposes
    /// cogging.
    ///
    /// # Errors
    /// If the encoder has no count.
    pub const fn of<E>(
        scene: &'a Scene<E>,
        against_cogging: f64,
        margin: Option<f64>,
        transducers: &Transducers,
        options: &RenderingOptions,
        output: OutputTiming,
    ) -> Result<Self, BuildError> {
        Ok(Self {
            latency: &scene.latency,
            timing: scene.timing,
            torque_limit: match scene.torque_limit {
                Some(limit) => Some(limit + against_cogging),
                None => None,
            },
            margin,
            full_scale: transducers.full_scale_torque,
            fade: options.fade,
            output,
            radians_per_count: ok!(transducers.radians_per_count()),
            stores: options.returned.is_some(),
        })
    }
}

/// The host beside a servo, or none: [`NoHost`] has no code in a tick.
pub trait BesideServo: Clone + fmt::Debug {
    /// A value in a program with a host, and no value in others.
    #[cfg(feature = "wire")]
    type IfPresent<T: serde::Serialize + serde::de::DeserializeOwned>: serde::Serialize
        + serde::de::DeserializeOwned;
    /// Its part of the mailbox.
    type Channel: HostChannel;
    /// What the task knows of it.
    type Reported: Default;
    /// What it may do.
    type Budget: Copy + fmt::Debug + PartialEq;
    /// Whether there is one.
    const IS_PRESENT: bool;

    /// A host that gives no torque.
    fn silent() -> Self;
    /// The host with a full tank.
    ///
    /// # Errors
    /// If there is no proof for it beside this servo.
    fn beside(budget: &Self::Budget, servo: &ServoNumbers<'_>) -> Result<Self, HostError>;
    /// A budget as data.
    fn host(budget: &Self::Budget) -> Option<HostTorque>;
    /// A budget from data.
    fn budget(host: HostTorque) -> Self::Budget;
    /// Begins a tick: the torque in codes of the DAC that the host wants in it.
    fn begin(&mut self) -> i32;
    /// The tick with whose end an [exchange](Self::exchange) is due; `None` without a host.
    fn due(&self) -> Option<u32>;
    /// Ends the tick before, in which the position moved by so many counts; returns the codes that the host wants
    /// and does not get.
    fn refused(&mut self, moved: i32) -> i32;
    /// A tick that is not a usual one; unless the host may give a torque in it, it wants none until the next
    /// command.
    fn wait(&mut self, may_give: bool);
    /// Fades the torque out from this tick on, like the scene's with so many steps of its limit in a tick.
    fn fade_out(&mut self, steps: u32, tick: u32);
    /// Whether the host wants no torque and gives none.
    fn is_at_rest(&self) -> bool;
    /// Whether this host may be replaced by another: no torque is under way.
    fn may_pass_to(&self, next: &Self) -> bool;
    /// Takes the level of the host before, which may pass to this one.
    fn take_over(&mut self, last: &Self);
    /// The amplifier was switched off; because of a fault, whose end of the torque no model knows, the tank
    /// is empty.
    fn cut(&mut self, by_fault: bool);
    /// The amplifier was off, and a hand may have got all of the energy before.
    fn drain(&mut self);
    /// Moves the largest torque of this tick by a step, because of the heat of the torque output; returns whether it
    /// fell. As long as it does, the scene keeps its torque.
    fn step_by_heat(&mut self, _: HeatStep, _: u32) -> bool {
        false
    }
    /// Takes the last command, if it is new, and reports the tick. It is to be called where a command waits, where
    /// it is [due](Self::due), and in each tick that is not a usual one.
    fn exchange(&mut self, channel: &Self::Channel, tick: TickState);

    /// Sends a command: for the task.
    fn send(channel: &Self::Channel, number: u16, torque: f32, ramp: u16);
    /// The next report: for the task.
    fn report(channel: &Self::Channel, reported: &mut Self::Reported) -> Option<Taken>;
    /// Requests that this budget becomes the one in force.
    fn ask(reported: &mut Self::Reported, id: u16, budget: HostTorque);
    /// The number of a request that was not taken yet.
    fn asking(reported: &Self::Reported) -> Option<u16>;
    /// Takes the request.
    fn asked(reported: &mut Self::Reported) -> Option<(u16, HostTorque)>;
    /// Requests the budget.
    fn request_budget(reported: &mut Self::Reported);
    /// Whether the budget is due.
    fn is_budget_due(reported: &mut Self::Reported) -> bool;
    /// The value in a message.
    #[cfg(feature = "wire")]
    fn present<T: serde::Serialize + serde::de::DeserializeOwned>(
        value: T,
    ) -> Option<Self::IfPresent<T>>;
    /// The value of a message.
    #[cfg(feature = "wire")]
    fn value<T: serde::Serialize + serde::de::DeserializeOwned>(value: Self::IfPresent<T>) -> T;
}

/// No host.
#[derive(Clone, Copy, Debug)]
pub struct NoHost;

/// A value that does not exist, in the messages of a program without a host.
#[cfg(feature = "wire")]
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Nothing {}

#[cfg(feature = "wire")]
impl<'de> serde::Deserialize<'de> for Nothing {
    fn deserialize<D: serde::Deserializer<'de>>(_: D) -> Result<Self, D::Error> {
        Err(serde::de::Error::custom("no host"))
    }
}

#[cfg(feature = "wire")]
impl serde::Serialize for Nothing {
    fn serialize<S: serde::Serializer>(&self, _: S) -> Result<S::Ok, S::Error> {
        match *self {}
    }
}

impl BesideServo for NoHost {
    #[cfg(feature = "wire")]
    type IfPresent<T: serde::Serialize + serde::de::DeserializeOwned> = Nothing;
    type Channel = ();
    type Reported = ();
    type Budget = ();
    const IS_PRESENT: bool = false;

    #[inline(always)]
    fn silent() -> Self {
        Self
    }

    fn beside((): &(), _: &ServoNumbers<'_>) -> Result<Self, HostError> {
        Ok(Self)
    }

    #[inline(always)]
    fn host((): &()) -> Option<HostTorque> {
        None
    }

    #[inline(always)]
    fn budget(_: HostTorque) {}

    #[inline(always)]
    fn begin(&mut self) -> i32 {
        0
    }

    #[inline(always)]
    fn due(&self) -> Option<u32> {
        None
    }

    #[inline(always)]
    fn refused(&mut self, _: i32) -> i32 {
        0
    }

    #[inline(always)]
    fn wait(&mut self, _: bool) {}

    #[inline(always)]
    fn fade_out(&mut self, _: u32, _: u32) {}

    #[inline(always)]
    fn is_at_rest(&self) -> bool {
        true
    }

    #[inline(always)]
    fn may_pass_to(&self, _: &Self) -> bool {
        true
    }

    #[inline(always)]
    fn take_over(&mut self, _: &Self) {}

    #[inline(always)]
    fn cut(&mut self, _: bool) {}

    #[inline(always)]
    fn drain(&mut self) {}

    #[inline(always)]
    fn exchange(&mut self, (): &(), _: TickState) {}

    #[inline(always)]
    fn send((): &(), _: u16, _: f32, _: u16) {}

    #[inline(always)]
    fn report((): &(), (): &mut ()) -> Option<Taken> {
        None
    }

    #[inline(always)]
    fn ask((): &mut (), _: u16, _: HostTorque) {}

    #[inline(always)]
    fn asking((): &()) -> Option<u16> {
        None
    }

    #[inline(always)]
    fn asked((): &mut ()) -> Option<(u16, HostTorque)> {
        None
    }

    #[inline(always)]
    fn request_budget((): &mut ()) {}

    #[inline(always)]
    fn is_budget_due((): &mut ()) -> bool {
        false
    }

    #[cfg(feature = "wire")]
    #[inline(always)]
    fn present<T: serde::Serialize + serde::de::DeserializeOwned>(_: T) -> Option<Nothing> {
        None
    }

    #[cfg(feature = "wire")]
    fn value<T: serde::Serialize + serde::de::DeserializeOwned>(value: Nothing) -> T {
        match value {}
    }
}

/// When a host's command acts on the board of a scene. The host is refused where it does not.
#[derive(Clone, Copy, Debug)]
pub struct HostTimes {
    /// Whole ticks after its count: 1 where a torque is put out at the next count.
    pub ticks: usize,
    /// Whether it acts in one tick only.
    pub is_plain: bool,
}

impl HostTimes {
    /// Of a scene with this latency and this period in s.
    pub const fn of(latency: &Latency, period: f64) -> Self {
        // The emulated board puts a torque out at the instant of its count.
        let is_latched = latency.code_delay(period) == 0.0
            && !cfg!(all(target_os = "none", feature = "board-qemu"));
        let is_whole = latency.output_delay.is_zero();
        Self { ticks: is_latched as usize, is_plain: is_whole && latency.actuator_lag.is_zero() }
    }
}

/// A host with its tank. A command acts `TICKS` whole ticks after its count, and in one tick only unless there are
/// `LAGS`.
#[derive(Clone, Debug)]
pub struct Hosted<const TICKS: usize, const LAGS: usize> {
    tank: Tank<FixedDelay<i64, TICKS>, LAGS>,
    stream: Stream,
    due: u32,
    /// Ticks per code in which the torque fades out at one step of the scene's limit in a tick.
    fade: f32,
    /// The number of the last command.
    taken: u32,
    /// Its codes beyond the host's largest.
    beyond: i32,
    invalid: u16,
    /// Ticks until motion gives energy back again.
    unknown: u32,
    /// In programs for a bridge.
    heat: [HeatLevel; MAY_HAVE_BRIDGE as usize],
}

/// The largest torque beside a bridge, in steps as the [`Stream`].
#[derive(Clone, Copy, Debug)]
struct HeatLevel {
    /// At its present heat.
    now: i32,
    /// While it is cold.
    cold: i32,
}

impl<const TICKS: usize, const LAGS: usize> Hosted<TICKS, LAGS> {
    /// Level of the tank in J.
    pub(super) fn energy(&self) -> f64 {
        self.tank.energy()
    }

    fn take_command(&mut self, channel: &HostWords, tick: TickState) {
        let (sent, [torque, rest]) = channel.command();
        if sent == self.taken {
            return;
        }
        self.taken = sent;
        let wanted = f32::from_bits(torque);
        let [torque, beyond] = self.tank.codes(wanted).unwrap_or_else(|| {
            self.invalid = self.invalid.saturating_add(1);
            [0; 2]
        });
        let is_hot = self.heat.iter().any(|heat| heat.now < heat.cold);
        let reason = match tick.opening {
            Some(0) if is_hot => IS_HOT,
            Some(0) => IS_OPEN,
            _ => IS_CLOSED,
        };
        let wanted = if reason == IS_OPEN { self.stream.wanted() } else { torque };
        let before = core::mem::replace(&mut self.beyond, beyond);
        // On the way to the largest torque, and from there, the wanted torque is within it.
        let beyond = if wanted.abs() == self.tank.largest() { before } else { 0 };
        let [wanted, given, beyond] = [wanted, self.tank.given(), beyond].map(i32::cast_unsigned);
        channel.publish(
            sent,
            [
                rest & 0xffff | u32::from(self.invalid) << 16,
                tick.tick,
                tick.count.cast_unsigned(),
                self.tank.rounded_energy().to_bits(),
                self.tank.code().to_bits(),
                wanted,
                given,
                beyond,
                tick.state | reason << REASON,
            ],
        );
        if let Some(opening) = tick.opening {
            let codes = |heat: &HeatLevel| heat.now >> STEP_BITS;
            let limited = |torque: i32, most: i32| torque.clamp(-most, most);
            let torque = self.heat.iter().map(codes).fold(torque, limited);
            self.stream.take(torque, (rest >> 16) as u16, opening, tick.tick);
        }
    }
}

impl<const TICKS: usize, const LAGS: usize> BesideServo for Hosted<TICKS, LAGS> {
    #[cfg(feature = "wire")]
    type IfPresent<T: serde::Serialize + serde::de::DeserializeOwned> = T;
    type Channel = HostWords;
    type Reported = Reported;
    type Budget = HostTorque;
    const IS_PRESENT: bool = true;

    fn silent() -> Self {
        let nothing =
            HostTorque { energy: 0.0, power: 0.0, damping: 0.0, torque: 0.0, timeout: 0.0 };
        Self {
            tank: Tank::empty(FixedDelay::full_of(0)),
            stream: Stream::new(&nothing, 1.0),
            due: 0,
            fade: 0.0,
            taken: 0,
            beyond: 0,
            invalid: 0,
            unknown: 0,
            heat: [HeatLevel { now: 0, cold: 0 }; MAY_HAVE_BRIDGE as usize],
        }
    }

    fn beside(host: &HostTorque, servo: &ServoNumbers<'_>) -> Result<Self, HostError> {
        let times = HostTimes { ticks: TICKS, is_plain: LAGS == 0 };
        let response = HostResponse::beside(host, servo, times)?;
        let period = response.period;
        let fade = (servo.fade / period * response.code / host.torque) as f32;
        let tank = Tank::new(host, &response)?;
        let cold = tank.largest() << STEP_BITS;
        let heat = [HeatLevel { now: cold, cold }; MAY_HAVE_BRIDGE as usize];
        Ok(Self { tank, stream: Stream::new(host, period), fade, heat, ..Self::silent() })
    }

    fn host(budget: &HostTorque) -> Option<HostTorque> {
        Some(*budget)
    }

    fn budget(host: HostTorque) -> HostTorque {
        host
    }

    #[inline(always)]
    fn begin(&mut self) -> i32 {
        self.stream.advance();
        self.stream.wanted()
    }

    #[inline(always)]
    fn due(&self) -> Option<u32> {
        Some(self.due)
    }

    #[inline(always)]
    fn refused(&mut self, moved: i32) -> i32 {
        let missing = self.tank.booked(moved);
        // Without it the compiler reads the stream before, and keeps more values at a time than there are registers:
        // a tick has six instructions more.
        compiler_fence(Ordering::SeqCst);
        self.tank.refused(missing, self.stream.wanted())
    }

    fn wait(&mut self, may_give: bool) {
        if !may_give {
            self.stream.rest();
        }
        if self.unknown > 0 {
            self.unknown -= 1;
            self.tank.give_back(self.unknown == 0);
        }
    }

    fn fade_out(&mut self, steps: u32, tick: u32) {
        let ticks = self.stream.wanted().abs() as f32 * self.fade / steps as f32;
        // The cast saturates.
        self.stream.fade((ticks as u32).saturating_add(1), tick);
    }

    fn is_at_rest(&self) -> bool {
        self.stream.is_at_rest() && self.tank.given() == 0
    }

    fn may_pass_to(&self, _: &Self) -> bool {
        // Of an amplifier that was just switched off no tail is known.
        self.unknown == 0 && self.tank.is_over()
    }

    #[inline(never)]
    fn take_over(&mut self, last: &Self) {
        self.tank.take_over(&last.tank);
        (self.taken, self.invalid) = (last.taken, last.invalid);
        for (heat, last) in self.heat.iter_mut().zip(&last.heat) {
            let cold = i64::from(last.cold).max(1);
            heat.now = (i64::from(last.now) * i64::from(heat.cold) / cold) as i32;
        }
    }

    #[cold]
    #[inline(never)]
    fn cut(&mut self, by_fault: bool) {
        self.stream.rest();
        self.unknown = UNKNOWN;
        self.tank.give_back(false);
        self.tank.forget(FixedDelay::full_of(0), by_fault);
    }

    fn drain(&mut self) {
        self.cut(true);
        self.tank.drain();
    }

    fn step_by_heat(&mut self, step: HeatStep, tick: u32) -> bool {
        let Some(heat) = self.heat.first_mut() else { return false };
        // As many ticks from end to end as the scene's limit takes; down from the present torque, so that each acts.
        let most = heat.now.min(self.stream.largest());
        // Of a fade at once, too: the cast saturates.
        let change = ((1 << STEP_BITS) as f32 / self.fade) as i32;
        let change = change.clamp(1, heat.cold.max(1));
        heat.now = match step {
            HeatStep::Lower => (most - change).max(0),
            HeatStep::Raise => (heat.now + change).min(heat.cold),
        };
        self.stream.limit(heat.now, tick);
        heat.now < most
    }

    fn exchange(&mut self, channel: &HostWords, tick: TickState) {
        self.take_command(channel, tick);
        self.due = self.stream.next(tick.tick, tick.deadline);
    }

    fn send(channel: &HostWords, number: u16, torque: f32, ramp: u16) {
        channel.send([torque.to_bits(), u32::from(ramp) << 16 | u32::from(number)]);
    }

    fn report(channel: &HostWords, reported: &mut Reported) -> Option<Taken> {
        let (command, words) = channel.report_after(reported.number)?;
        let [number, tick, count, energy, code, wanted, given, beyond, state] = words;
        let [wanted, given, beyond] = [wanted, given, beyond].map(u32::cast_signed);
        let torque = |codes: i32| codes as f32 * f32::from_bits(code);
        let count = count.cast_signed();
        let ticks = tick.wrapping_sub(reported.tick);
        let moved = count.wrapping_sub(reported.count) as f32;
        let is_first = reported.number == 0;
        let speed = if is_first || ticks == 0 { 0.0 } else { moved / ticks as f32 };
        (reported.number, reported.tick, reported.count) = (command, tick, count);
        Some(Taken {
            number: number as u16,
            tick,
            count,
            speed,
            energy: f32::from_bits(energy),
            torque: torque(given),
            refused: torque((wanted - given).saturating_add(beyond)),
            limit: match state >> REASON {
                _ if wanted == given && beyond == 0 => LimitReason::None,
                _ if wanted == given => LimitReason::Torque,
                IS_OPEN => LimitReason::Energy,
                IS_CLOSED => LimitReason::Ramp,
                _ => LimitReason::Heat,
            },
            state: (state % (1 << REASON)) as usize,
            invalid: (number >> 16) as u16,
        })
    }

    fn ask(reported: &mut Reported, id: u16, budget: HostTorque) {
        reported.requested = Some((id, budget));
    }

    fn asking(reported: &Reported) -> Option<u16> {
        reported.requested.map(|(id, _)| id)
    }

    fn asked(reported: &mut Reported) -> Option<(u16, HostTorque)> {
        reported.requested.take()
    }

    fn request_budget(reported: &mut Reported) {
        reported.budget_due = true;
    }

    fn is_budget_due(reported: &mut Reported) -> bool {
        core::mem::take(&mut reported.budget_due)
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
