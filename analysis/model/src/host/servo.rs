//! A servo with a host beside it, tick by tick as on a board.

use std::f64::consts::TAU;

use haptic_servo::dac::DacCode;
use haptic_servo::host::{
    AnyHosted, BesideServo, HostChannel, HostError, HostTorque, HostWords, ServoNumbers, TickState,
};
use haptic_servo::number::{Format, OutOfRange};
use haptic_servo::scene::Scene;
use haptic_servo::servo::{OutputTiming, RenderingOptions, Transducers};
use haptic_servo::servo_loop::State;
use haptic_servo::torque::LimitReason;

use super::law::HostSender;
use crate::controller::{Controller, Tick};

/// A host without a budget, beside a servo with this period in s: the same, with the energy of ten times its largest
/// torque, and a supply that fills the tank in each tick.
pub fn unlimited(host: &HostTorque, period: f64) -> HostTorque {
    let HostTorque { energy, torque, damping, .. } = *host;
    let enough = 100.0 * torque * torque * period / (4.0 * damping);
    HostTorque { energy: energy.max(enough), power: 1e12, ..*host }
}

/// What the host did in a tick.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HostTick {
    /// Torque in N m that it wanted, within its largest.
    pub wanted: f64,
    /// Torque in N m that it got.
    pub given: f64,
    /// Level of its tank in J after that.
    pub level: f64,
}

/// A servo with a host beside it: the codes of both together. The host's commands come from a
/// [`HostSender`], or by [`HostedServo::send`].
pub struct HostedServo<'a> {
    servo: Box<dyn Controller + 'a>,
    host: AnyHosted,
    channel: HostWords,
    sender: Option<HostSender>,
    /// The torque in codes that acts from the next count on, if torques are latched.
    held: Option<i32>,
    /// N m of a code.
    code: f64,
    count: i32,
    /// Ticks so far.
    number: u32,
    tick: HostTick,
}

impl<'a> HostedServo<'a> {
    /// A full tank beside the servo of a scene in this format, with torques that are put out at the next count or
    /// at their own, and whether the supply of a board's own bridge takes no energy back.
    ///
    /// # Errors
    /// If there is no proof for the host beside this servo, or its torque and the scene's are together above full
    /// scale.
    pub fn new(
        servo: Box<dyn Controller + 'a>,
        host: &HostTorque,
        scene: &Scene,
        transducers: &Transducers,
        output: OutputTiming,
        (format, stores): (Format, bool),
    ) -> Result<Self, HostError> {
        // A scene that does not certify has no margin.
        let certified = scene.certify_in(format).ok();
        let margin = certified.and_then(|it| it.assessment().margin_injecting(it.as_data(), 0.0));
        let numbers = ServoNumbers {
            latency: &scene.latency,
            timing: scene.timing,
            torque_limit: scene
                .torque_limit
                .map(|limit| limit + scene.environment.parts().against_cogging()),
            margin,
            full_scale: transducers.full_scale_torque,
            fade: RenderingOptions::DEFAULT.fade,
            output,
            radians_per_count: TAU / transducers.counts_per_turn,
            stores,
        };
        Self::beside(servo, host, &numbers)
    }

    /// The same by the servo's numbers.
    pub(super) fn beside(
        servo: Box<dyn Controller + 'a>,
        host: &HostTorque,
        numbers: &ServoNumbers<'_>,
    ) -> Result<Self, HostError> {
        let host = AnyHosted::beside(host, numbers)?;
        let level = host.energy();
        Ok(Self {
            servo,
            host,
            channel: HostWords::EMPTY,
            sender: None,
            held: (numbers.output == OutputTiming::Latched).then_some(0),
            code: numbers.full_scale / f64::from(DacCode::CODES_TO_FULL_SCALE),
            count: 0,
            number: 0,
            tick: HostTick { wanted: 0.0, given: 0.0, level },
        })
    }

    /// The same with the commands of a sender, each of which the servo takes in the tick after.
    pub fn driven_by(self, sender: HostSender) -> Self {
        Self { sender: Some(sender), ..self }
    }

    /// The same beside a servo that stands at this count.
    pub fn standing_at(self, count: i32) -> Self {
        Self { count, ..self }
    }

    /// What the host did in the last tick.
    pub const fn last(&self) -> HostTick {
        self.tick
    }

    /// Ticks without a motion and a command, as before a run.
    pub fn rest(&mut self, ticks: u32) {
        self.follow(&vec![(self.count, false); ticks as usize]);
    }

    /// Ticks without a command, as before a run, by their counts, and whether an alignment moved the handle in each.
    pub fn follow(&mut self, ticks: &[(i32, bool)]) {
        for &(count, is_aligning) in ticks {
            let moved = count.wrapping_sub(std::mem::replace(&mut self.count, count));
            self.host.begin();
            self.host.refused(moved);
            self.host.wait(false);
            if is_aligning {
                self.host.cut(false);
            }
        }
        self.number = ticks.len() as u32;
    }

    /// Sends a command, which the next tick takes and the tick after that begins to give: a torque in N m, to
    /// which the servo moves over so many ticks.
    pub fn send(&self, torque: f32, ramp: u16) {
        AnyHosted::send(&self.channel, 0, torque, ramp);
    }
}

impl Controller for HostedServo<'_> {
    fn tick(&mut self, raw: i32) -> Tick {
        let mut tick = self.servo.tick(raw);
        let count = tick.count as i32;
        let moved = count.wrapping_sub(std::mem::replace(&mut self.count, count));
        let (wanted, refused) = (self.host.begin(), self.host.refused(moved));
        let given = wanted - refused;
        let acting = self.held.as_mut().map_or(given, |held| std::mem::replace(held, given));
        tick.code = DacCode::new(tick.code).map_or(tick.code, |code| code.beside(acting).get());
        if refused != 0 {
            tick.limit = LimitReason::Energy;
        }
        let [wanted, given] = [wanted, given].map(|codes| f64::from(codes) * self.code);
        self.tick = HostTick { wanted, given, level: self.host.energy() };
        let (state, deadline) = (State::Running as u32, self.number.wrapping_add(1));
        let taken = TickState { tick: self.number, count, opening: Some(0), state, deadline };
        self.host.exchange(&self.channel, taken);
        if let Some(torque) = self.sender.as_mut().and_then(|sender| sender.after(count)) {
            self.send(torque, 0);
        }
        self.number = self.number.wrapping_add(1);
        tick
    }

    fn tick_at(&mut self, angle: f64) -> Result<f64, OutOfRange> {
        self.servo.tick_at(angle)
    }
}
