//! The host beside a servo: its tank in the tick, and its commands and reports below the tick.

use core::fmt;

use super::channel::{HostChannel, HostWords};
use super::stream::Stream;
use super::{HostError, HostResponse, HostTorque, Sampling, Tank};
use crate::environment::FixedDelay;
use crate::latency::Latency;
use crate::number::{Format, Number};
use crate::output_timing::{OutputTiming, READ_WITHIN};
use crate::scene::Timing;

/// Ticks after the amplifier was switched off in which the device's motion gives nothing back: the rest
/// of the torque is not known then.
const UNKNOWN: u32 = 10;

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
    /// The servo's state as a number.
    pub state: usize,
    /// Commands whose torque was no finite number.
    pub invalid: u16,
}

/// The reports that the task has sent.
#[derive(Clone, Debug, Default)]
pub struct Reported {
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
    /// Whether the servo runs: in any other state it gives no torque of the host.
    pub is_running: bool,
    /// The servo's state as a number.
    pub state: u32,
}

/// What a host needs of a servo.
#[derive(Clone, Copy, Debug)]
pub struct ServoNumbers<'a> {
    /// The latency of the scene.
    pub latency: &'a Latency,
    /// Its timing.
    pub timing: Timing,
    /// When a torque is put out.
    pub output: OutputTiming,
    /// An encoder count in rad.
    pub radians_per_count: f64,
    /// The servo's number format.
    pub format: Format,
    /// Whether a bridge drives the motor.
    pub has_bridge: bool,
}

/// The host beside a servo, or none: [`NoHost`] has no code in a tick.
pub trait BesideServo: Clone + fmt::Debug {
    /// A value in a program with a host, and no value in others.
    #[cfg(feature = "wire")]
    type IfPresent<T: serde::Serialize + serde::de::DeserializeOwned>: serde::Serialize
        + serde::de::DeserializeOwned;
    /// Its part of the mailbox.
    type Channel: HostChannel;
    /// What the task has sent of its reports.
    type Reported: Default;
    /// Whether there is one.
    const IS_PRESENT: bool;

    /// A host that gives no torque.
    fn silent() -> Self;
    /// The host with a full tank.
    ///
    /// # Errors
    /// If there is no proof for it beside this servo.
    fn beside(host: &HostTorque, servo: &ServoNumbers<'_>) -> Result<Self, HostError>;
    /// Ends a tick in which the position moved by so many counts; returns the host's torque in N m, and
    /// whether it is less than wanted.
    fn tick<N: Number>(&mut self, moved: i32) -> (N, bool);
    /// Wants no torque until the next command to a running servo.
    fn rest(&mut self);
    /// The amplifier was switched off; because of a fault, whose end of the torque no model knows, the tank
    /// is empty.
    fn cut(&mut self, by_fault: bool);
    /// Takes the last command, if it is new, and reports the tick.
    fn exchange(&mut self, channel: &Self::Channel, tick: TickState);

    /// Sends a command: for the task.
    fn send(channel: &Self::Channel, number: u16, torque: f32, ramp: u16);
    /// The next report: for the task.
    fn report(channel: &Self::Channel, reported: &mut Self::Reported) -> Option<Taken>;
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
    const IS_PRESENT: bool = false;

    #[inline(always)]
    fn silent() -> Self {
        Self
    }

    fn beside(_: &HostTorque, _: &ServoNumbers<'_>) -> Result<Self, HostError> {
        Ok(Self)
    }

    #[inline(always)]
    fn tick<N: Number>(&mut self, _: i32) -> (N, bool) {
        (N::ZERO, false)
    }

    #[inline(always)]
    fn rest(&mut self) {}

    #[inline(always)]
    fn cut(&mut self, _: bool) {}

    #[inline(always)]
    fn exchange(&mut self, (): &(), _: TickState) {}

    #[inline(always)]
    fn send((): &(), _: u16, _: f32, _: u16) {}

    #[inline(always)]
    fn report((): &(), (): &mut ()) -> Option<Taken> {
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
    /// Of a scene with this latency.
    pub const fn of(latency: &Latency) -> Self {
        let is_whole = latency.output_delay.is_zero();
        // The emulated board puts a torque out at the instant of its count.
        let is_latched = is_whole && !cfg!(all(target_os = "none", feature = "board-qemu"));
        Self { ticks: is_latched as usize, is_plain: is_whole && latency.actuator_lag.is_zero() }
    }
}

/// A host with a tank in `f32`. A command acts `TICKS` whole ticks after its count; if `IS_PLAIN`, it acts
/// in one tick only.
#[derive(Clone, Debug)]
pub struct Hosted<const TICKS: usize, const IS_PLAIN: bool> {
    tank: Tank<f32, FixedDelay<f32, TICKS>, IS_PLAIN>,
    stream: Stream,
    given: f32,
    /// J for a level of 1.
    joules: f32,
    reserve: f32,
    /// The number of the last command.
    taken: u32,
    invalid: u16,
    /// Ticks until motion gives energy back again.
    unknown: u32,
}

impl<const TICKS: usize, const IS_PLAIN: bool> Hosted<TICKS, IS_PLAIN> {
    /// Torque in N m that the host wants in the present tick.
    pub(super) const fn wanted(&self) -> f32 {
        self.stream.wanted
    }

    /// Level of the tank in J.
    pub(super) fn energy(&self) -> f64 {
        self.tank.energy()
    }
}

impl<const TICKS: usize, const IS_PLAIN: bool> BesideServo for Hosted<TICKS, IS_PLAIN> {
    #[cfg(feature = "wire")]
    type IfPresent<T: serde::Serialize + serde::de::DeserializeOwned> = T;
    type Channel = HostWords;
    type Reported = Reported;
    const IS_PRESENT: bool = true;

    fn silent() -> Self {
        let nothing =
            HostTorque { energy: 0.0, power: 0.0, damping: 0.0, torque: 0.0, timeout: 0.0 };
        Self {
            tank: Tank::empty(FixedDelay::full_of(0.0), FixedDelay::full_of(0.0)),
            stream: Stream::new(&nothing, 1.0),
            given: 0.0,
            joules: 0.0,
            reserve: 0.0,
            taken: 0,
            invalid: 0,
            unknown: 0,
        }
    }

    fn beside(host: &HostTorque, servo: &ServoNumbers<'_>) -> Result<Self, HostError> {
        let not_covered = |time| Err(HostError::NotCovered { time });
        if !matches!(servo.format, Format::F32 | Format::F64) {
            return not_covered("a servo in a fixed-point format");
        }
        if servo.has_bridge || servo.latency.actuator_updates > 0 {
            return not_covered("the heat and the supply of a board's own bridge");
        }
        let Timing { period, worst_period } = servo.timing;
        if host.timeout < 2.0 * period {
            return Err(HostError::Timeout { timeout: host.timeout, least: 2.0 * period });
        }
        let (ticks, reading) = match servo.output {
            OutputTiming::Simultaneous => (0, 0.0),
            OutputTiming::Latched => (1, READ_WITHIN),
            OutputTiming::AtPhase(_) => (0, READ_WITHIN),
        };
        let count = servo.radians_per_count;
        let sampling = Sampling { period, worst_period, count, ticks, reading };
        let mut response = HostResponse::of(host, servo.latency, &sampling)?;
        if IS_PLAIN {
            response = response.without_memory(host)?;
        }
        if response.whole != TICKS || response.is_plain != IS_PLAIN {
            return not_covered("an output at another time than that of the program's board");
        }
        let tank = Tank::new(host, &response, count, [count, 1.0])?;
        let [joules, reserve] = tank.joules().map(|number| number as f32);
        let stream = Stream::new(host, period);
        Ok(Self { tank, stream, joules, reserve, ..Self::silent() })
    }

    #[inline(always)]
    fn tick<N: Number>(&mut self, moved: i32) -> (N, bool) {
        self.tank.book(moved as f32);
        let wanted = self.stream.next();
        let given = self.tank.allowed(wanted);
        self.tank.give(given);
        self.given = given;
        (N::of_single(given), given != wanted)
    }

    fn rest(&mut self) {
        self.stream.rest();
        if self.unknown > 0 {
            self.unknown -= 1;
            self.tank.give_back(self.unknown == 0);
        }
    }

    #[cold]
    #[inline(never)]
    fn cut(&mut self, by_fault: bool) {
        self.stream.rest();
        self.given = 0.0;
        self.unknown = UNKNOWN;
        self.tank.give_back(false);
        self.tank.forget(FixedDelay::full_of(0.0), by_fault);
    }

    fn exchange(&mut self, channel: &HostWords, tick: TickState) {
        let (sent, [torque, rest]) = channel.command();
        if sent == self.taken {
            return;
        }
        self.taken = sent;
        let wanted = f32::from_bits(torque);
        let torque = self.tank.in_range(wanted);
        if !wanted.is_finite() {
            self.invalid = self.invalid.saturating_add(1);
        }
        let refused = if tick.is_running { self.stream.wanted - self.given } else { torque };
        channel.publish(
            sent,
            [
                rest & 0xffff,
                tick.tick,
                tick.count.cast_unsigned(),
                (self.tank.level() * self.joules + self.reserve).to_bits(),
                self.given.to_bits(),
                refused.to_bits(),
                tick.state,
                u32::from(self.invalid),
            ],
        );
        if tick.is_running {
            self.stream.take(torque, (rest >> 16) as u16);
        }
    }

    fn send(channel: &HostWords, number: u16, torque: f32, ramp: u16) {
        channel.send([torque.to_bits(), u32::from(ramp) << 16 | u32::from(number)]);
    }

    fn report(channel: &HostWords, reported: &mut Reported) -> Option<Taken> {
        let (command, words) = channel.report_after(reported.number)?;
        let [number, tick, count, energy, torque, refused, state, invalid] = words;
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
            torque: f32::from_bits(torque),
            refused: f32::from_bits(refused),
            state: state as usize,
            invalid: invalid as u16,
        })
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
