//! One run: the servo loop on a simulated board, against device and hand, and the energy balance.
//!
//! With `W` the work of the motor and `b` the damping of the device, the energy `H` of device and
//! hand and what the hand's dampers took, `D`, are together `H(0) + W - b * integral v^2`. The
//! certificate claims that this is never above `H(0)` plus an allowance:
//!
//! - Each opening of the clamp may put in what the environment stores at its depth: the clamp's
//!   level times the environment's distance from its face, or from the other side of a profile.
//! - A torque that is off by `e` puts in at most `e` times the travel; encoder and numbers act
//!   where the environment is, whose travel is at most the device's and the coupling's.
//! - A servo that is stopped for missed updates held its torque `u` for longer than the certificate
//!   says, and that puts in at most `u^2 / 4 b` a period.

use std::marker::PhantomData;

use haptic_servo::boot::Startup;
use haptic_servo::dac::DacCode;
use haptic_servo::environment::{Discretize, Environment};
use haptic_servo::number::Number;
use haptic_servo::servo::{OutputMode, PreparedServo, Servo, SupportsTiming};
use haptic_servo::servo_loop::{
    Hardware, Inbox, Mailbox, Requests, ServoLoop, State as ServoState,
};
use haptic_servo::tuning::Tunable;

use crate::device::{AMPLIFIED, SENSED, State, Step, TORQUE};
use crate::hardware::{Board, Last};
use crate::normalized_scene::NormalizedScene;
use crate::plan::{Pattern, Plan, Readings, Request, Signs, TickTiming};
use crate::timing::{Schedule, timer_counts};

/// What became of a run.
#[derive(Clone, Copy, Debug, Default)]
pub struct Outcome {
    /// The largest energy above what was allowed, over what was allowed: above zero the certificate
    /// is wrong.
    pub score: f64,
    /// Period of that.
    pub period: u32,
    /// The same in the loop's units: energy gained, and the allowance without the energy at the
    /// start.
    pub gained: f64,
    /// See there.
    pub allowed: f64,
    /// Energy at the start.
    pub start: f64,
    /// Energy gained less that of device and allowance, in the third or the last quarter of the
    /// run, whichever is less: above zero the loop is active, also after the energy that the
    /// clamp's opening put in.
    pub rate: f64,
    /// Periods that were run.
    pub periods: u32,
    /// Openings of the clamp.
    pub openings: u32,
    /// Times that the servo was stopped.
    pub faults: u32,
    /// Energy that the simulation itself made or lost, where that was looked at.
    pub residual: f64,
    /// The servo went on although more updates were missed in a row than the certificate tolerates.
    pub went_on: bool,
    /// The largest energy of device and hand.
    pub largest: f64,
}

impl Outcome {
    /// The objective of a climb: the energy that was gained if that is above zero, else the rate.
    pub fn objective(&self) -> f64 {
        if self.score > 0.0 { 1.0 + self.score.min(1e6) } else { self.rate.min(0.99) }
    }

    /// Whether this refutes the certificate.
    pub fn is_violation(&self) -> bool {
        self.went_on || self.score > 0.0
    }
}

/// What computes the codes.
#[derive(Clone)]
pub enum Control<N: Number, M> {
    /// A booted servo loop of a board.
    Board(ServoLoop<Environment, N, M>),
    /// The servo alone: it renders scenes that no board does, and is armed from its first tick.
    Bare(Servo<Environment, N>),
}

/// A servo and the sets that may be swapped in.
pub struct Machine<N: Number, M> {
    /// The servo as it booted.
    pub control: Control<N, M>,
    /// The sets: its own and the other one.
    pub sets: Vec<PreparedServo<Environment, N, M>>,
    mode: PhantomData<M>,
}

/// Energy that was put in and taken since the start.
#[derive(Clone, Copy, Debug, Default)]
struct EnergyBalance {
    /// Work of the motor less what the device dissipated.
    gained: f64,
    /// What the device dissipated.
    dissipated: f64,
    /// What went through the motor, whichever way.
    moved: f64,
    /// What the dampers of the hand took, where that is looked at.
    taken: f64,
    /// Travel of the device in rad, or more.
    travel: f64,
    /// Sum of all changes of the torque.
    changes: f64,
    /// Farthest angle from the board's zero in rad.
    farthest: f64,
    openings: u32,
    /// What stops for missed updates allow.
    stops: f64,
    /// Periods.
    periods: u32,
}

impl EnergyBalance {
    /// What torques and positions that are off allow.
    fn errors(&self, normalized: &NormalizedScene) -> f64 {
        let NormalizedScene { compliance, off, .. } = *normalized;
        let turns = (self.farthest / std::f64::consts::TAU).max(1.0);
        let error = normalized.error + normalized.numbers * turns;
        let travel = 2.0 * self.travel + compliance * self.changes;
        // A position that is off by `off` moves the environment by twice that from tick to tick, of which its
        // torque and its index make energy.
        let moved = travel + self.changes * (1.0 + compliance) + off * f64::from(self.periods);
        error * travel + 4.0 * off * moved
    }

    /// Moves the state on, and books what that takes and gives.
    #[inline]
    fn advance(&mut self, x: &mut State, step: &Step, damping: f64) {
        self.taken += step.taken(x);
        let (squared, work) = step.advance(x);
        let loss = squared * damping;
        self.gained += work - loss;
        self.moved += work.abs();
        self.dissipated += loss;
        self.travel += squared.max(0.0).sqrt();
    }

    fn allowed(&self, normalized: &NormalizedScene) -> f64 {
        let NormalizedScene { bound, compliance, face, stored, sides, linearity, .. } = *normalized;
        // An encoder whose error has this slope is off by at most as much, in rad, and where it reads a rad there are
        // as many more.
        let farthest = self.farthest + 2.0 * linearity;
        let opening = bound * (sides * farthest + face + compliance * bound);
        let energies = f64::from(self.openings) * opening + stored + self.errors(normalized);
        energies / (1.0 - linearity) + self.stops
    }
}

/// Share of an energy below which a climb sees nothing; a verdict does without.
const ROUNDING: f64 = 1e-10;

/// Periods between two looks at the account.
const LOOK: u32 = 32;

/// Numbers by chance, a step at a time.
fn next(seed: &mut u64) -> u64 {
    *seed ^= *seed << 13;
    *seed ^= *seed >> 7;
    *seed ^= *seed << 17;
    seed.wrapping_mul(0x2545_f491_4f6c_dd1d) >> 32
}

/// What happens to the ticks, one after the other.
fn ticks(pattern: Pattern) -> Box<dyn Iterator<Item = TickTiming>> {
    match pattern {
        Pattern::AllOnTime => Box::new(std::iter::repeat(TickTiming::OnTime)),
        Pattern::Periodic(ticks) => Box::new(ticks.into_iter().cycle()),
        Pattern::Random { mut seed, missed, late, most } => {
            let mut in_a_row = 0;
            Box::new(std::iter::repeat_with(move || {
                let number = next(&mut seed);
                let tick = match number & 0xff < u64::from(missed) {
                    true => TickTiming::Missed,
                    false if number >> 8 & 0xff < u64::from(late) => TickTiming::Late,
                    false => TickTiming::OnTime,
                };
                in_a_row = if tick == TickTiming::OnTime { 0 } else { in_a_row + 1 };
                if in_a_row > most {
                    in_a_row = 0;
                    return TickTiming::OnTime;
                }
                tick
            }))
        }
    }
}

/// What happens to the times of torques or counts, tick by tick.
fn shifts(signs: Option<Signs>) -> Box<dyn Iterator<Item = i8>> {
    match signs {
        None => Box::new(std::iter::repeat(0)),
        Some(Signs::Periodic(signs)) => Box::new(signs.into_iter().cycle()),
        Some(Signs::Random { mut seed }) => Box::new(std::iter::repeat_with(move || {
            [-1, -1, 1, 1, 0][next(&mut seed) as usize % 5]
        })),
    }
}

/// A code on its way to the motor.
#[derive(Clone, Copy, Debug)]
struct Sent {
    tick: u32,
    period: u32,
    place: usize,
    code: i16,
}

/// Codes on their way, at most.
const ON_THE_WAY: usize = 16;

/// The motor's end: codes on their way, and the code that it has.
#[derive(Clone, Copy, Debug)]
struct Motor {
    sent: [Option<Sent>; ON_THE_WAY],
    /// The tick of the code that it has.
    newest: Option<u32>,
    code: i16,
    powered: bool,
}

impl Motor {
    const OFF: Self = Self { sent: [None; ON_THE_WAY], newest: None, code: 0, powered: false };

    fn send(&mut self, sent: Sent) {
        if let Some(free) = self.sent.iter_mut().find(|slot| slot.is_none()) {
            *free = Some(sent);
        }
    }

    /// Takes the codes of an instant over. A code that a later one has overtaken is not put out, unless the motor
    /// takes them out of order.
    fn take(&mut self, period: u32, place: usize, unordered: bool) {
        for slot in &mut self.sent {
            let Some(sent) = *slot else { continue };
            if (sent.period, sent.place) != (period, place) {
                continue;
            }
            *slot = None;
            if unordered || self.newest.is_none_or(|newest| sent.tick >= newest) {
                (self.newest, self.code) = (Some(sent.tick), sent.code);
            }
        }
    }
}

/// A run as it goes on.
struct Run<'a> {
    normalized: &'a NormalizedScene,
    plan: &'a Plan,
    schedule: &'a Schedule,
    board: Board,
    motor: Motor,
    last: Last,
    x: State,
    balance: EnergyBalance,
    outcome: Outcome,
    /// The error of the encoder's angle in rad, behind its filter.
    error: f64,
    /// The angle that follows the device's behind the encoder's hysteresis.
    followed: f64,
    /// Readings dropped in a row.
    dropped: u16,
    /// Ticks skipped, ticks without a code in time, periods since the last code.
    skipped: u32,
    in_a_row: u32,
    since: u32,
    /// The largest torque in that time.
    strongest: f64,
    /// Whether the servo's torque has reached the full scale that its certificate excludes.
    saturated: bool,
}

impl<'a> Run<'a> {
    fn new(normalized: &'a NormalizedScene, plan: &'a Plan, schedule: &'a Schedule) -> Self {
        let mut board = Board::new(normalized.counts_per_radian, !plan.armed_by_boot);
        // As booting does it, with the device at the board's zero.
        board.angle = plan.zero + plan.readings.error(plan.zero);
        board.zero_encoder();
        if plan.heats {
            board = board.heating();
        }
        let mut x = plan.start;
        if schedule.lags.sensor > 0.0 {
            x[SENSED] = x[0];
            x[SENSED + 1] = 0.0;
        }
        let start = schedule.held.energy(&x);
        Self {
            normalized,
            plan,
            schedule,
            board,
            motor: Motor::OFF,
            last: Last::default(),
            x,
            balance: EnergyBalance::default(),
            outcome: Outcome { score: -1.0, start, rate: -1.0, ..Outcome::default() },
            error: plan.readings.error(plan.start[0]),
            followed: plan.start[0],
            dropped: 0,
            skipped: 0,
            in_a_row: 0,
            since: 0,
            strongest: 0.0,
            saturated: false,
        }
    }

    fn torque(&self) -> f64 {
        if !self.motor.powered {
            return 0.0;
        }
        f64::from(self.motor.code) * self.normalized.torque_per_code
    }

    /// From an instant to the next.
    #[inline]
    fn advance(&mut self, place: usize, step: &Step, target: &mut f64) {
        let torque = self.torque();
        self.strongest = self.strongest.max(torque.abs());
        self.balance.changes += (torque - *target).abs();
        *target = torque;
        let Schedule { lags, held, .. } = self.schedule;
        if lags.updates == 0 {
            self.x[TORQUE] = torque;
        } else if self.schedule.updates.contains(&place) {
            let updates = f64::from(lags.updates);
            let share = 1.0 - (-1.0 / (updates * lags.amplifier)).exp();
            self.x[TORQUE] = (torque - self.x[AMPLIFIED]) * share * updates;
        }
        let from = [self.x[0], self.x[1]];
        self.balance.advance(&mut self.x, step, held.damping);
        if lags.sensor > 0.0 && self.plan.readings.waves[1] > 0.0 {
            let path = [from, [self.x[0], self.x[1]]];
            self.error = self.plan.readings.filtered(self.error, path, step.part, lags.sensor);
        }
    }

    /// The tick of this period. `tick`: what happens to it; `shift`: when its torque begins.
    fn tick<N: Number, M: OutputMode>(
        &mut self,
        control: &mut Control<N, M>,
        inbox: &mut Inbox<'_, PreparedServo<Environment, N, M>>,
        requests: &mut Requests<'_, PreparedServo<Environment, N, M>>,
        (period, timing, shift, (drop, noise)): (u32, TickTiming, i8, (bool, i8)),
    ) -> Option<bool>
    where
        Environment: Tunable<N> + SupportsTiming<M>,
    {
        let normalized = self.normalized;
        let is_late = timing == TickTiming::Late;
        let delayed = timing == TickTiming::Delayed && self.plan.delay > normalized.in_time;
        self.dropped = if drop && self.dropped < normalized.dropped { self.dropped + 1 } else { 0 };
        if self.dropped == 0 {
            let Readings { noise: (peak, _), .. } = self.plan.readings;
            let angle = match self.schedule.lags.sensor > 0.0 {
                true => self.x[SENSED] + self.error,
                false => self.x[0] + self.plan.readings.error(self.x[0]),
            };
            let play = normalized.hysteresis / 2.0;
            self.followed = self.followed.clamp(angle - play, angle + play);
            self.board.angle = self.followed + f64::from(noise) * peak;
        }
        self.board.passed = self.skipped + 1;
        self.board.late = is_late && !normalized.unreported;
        self.board.delay = if delayed { timer_counts(self.plan.delay) } else { 0 };
        self.skipped = 0;
        let was = self.last.state;
        match control {
            Control::Board(servo_loop) => {
                servo_loop.run(&mut self.board, inbox, &mut self.last);
                self.balance.openings += u32::from(self.board.heat());
            }
            Control::Bare(servo) => {
                let count = self.board.count();
                let mut code = servo.tick(count).code;
                if normalized.ahead {
                    // That of a late environment, whatever the next count is.
                    code = servo.clone().tick(count).code;
                }
                self.board.write(code);
                self.board.amplifier = true;
                let full = DacCode::CODES_TO_FULL_SCALE.cast_signed();
                self.saturated |= normalized.unlimited && self.board.offset.abs() >= full;
            }
        }
        let (wait, place) = self.schedule.torque(shift);
        let sent = period + wait + u32::from(is_late);
        self.motor.send(Sent { tick: period, period: sent, place, code: self.board.offset });
        // The amplifier of a late tick is switched when that ends.
        let mut overdue = None;
        if is_late {
            self.in_a_row += 1;
            overdue = Some(self.board.amplifier);
        } else {
            self.motor.powered = self.board.amplifier;
        }
        if self.last.state != was {
            self.changed_from(was);
        }
        let went_on = self.in_a_row > normalized.tolerated
            && self.last.state.is_armed()
            && was.is_armed()
            && !normalized.unreported;
        self.outcome.went_on |= went_on;
        if !is_late {
            (self.in_a_row, self.since, self.strongest) = (0, 0, 0.0);
        }
        if self.plan.again && self.last.state == ServoState::Faulted && period % 16 == 0 {
            requests.arm();
        }
        overdue
    }

    fn changed_from(&mut self, was: ServoState) {
        match self.last.state {
            ServoState::FadingIn => self.balance.openings += 1,
            // A clamp that opens within a tick.
            ServoState::Running if was != ServoState::FadingIn => self.balance.openings += 1,
            ServoState::Faulted => {
                self.outcome.faults += 1;
                let damping = self.schedule.held.damping.max(f64::MIN_POSITIVE);
                let longest = f64::from(self.since.max(1) + 1);
                self.balance.stops += longest * self.strongest * self.strongest / (4.0 * damping);
            }
            _ => {}
        }
    }

    /// The energy balance at the end of a period.
    fn look(&mut self, period: u32, audited: bool) {
        let (balance, outcome) = (&self.balance, &mut self.outcome);
        let allowed = balance.allowed(self.normalized);
        let all = outcome.start + allowed;
        let score = (balance.gained - allowed) / all.max(f64::MIN_POSITIVE);
        if score > outcome.score || score.is_nan() {
            (outcome.score, outcome.period) = (score, period);
            (outcome.gained, outcome.allowed) = (balance.gained, allowed);
        }
        let largest = outcome.start + balance.gained;
        outcome.largest = outcome.largest.max(largest);
        outcome.openings = balance.openings;
        if audited {
            let residual = self.schedule.held.energy(&self.x) + balance.taken - largest;
            outcome.residual = outcome.residual.max(residual.abs());
        }
        outcome.periods = period + 1;
    }

    /// Whether the run cannot go on.
    fn is_over(&self) -> bool {
        let Outcome { largest, start, allowed, .. } = self.outcome;
        // Beyond all numbers; faster than the transducers exclude, so that the counter might wrap unseen.
        let beyond = largest > 1e12 * (start + allowed) || largest.is_nan();
        beyond || self.saturated || self.x[1].abs() > self.normalized.fastest
    }
}

/// The rate of gain over the windows of a run.
struct Rate {
    window: u32,
    before: EnergyBalance,
    last: f64,
}

impl Rate {
    fn look(&mut self, period: u32, run: &mut Run<'_>) {
        if period % self.window < self.window - LOOK {
            return;
        }
        let (balance, before, normalized) = (&run.balance, &self.before, run.normalized);
        let errors = balance.errors(normalized) - before.errors(normalized);
        // With what rounds away, so that rest is no gain.
        let rounded = ROUNDING * (balance.moved + balance.dissipated + run.outcome.start);
        let took = (balance.dissipated - before.dissipated).max(0.0) + errors + rounded;
        let gained = balance.gained - before.gained - errors - rounded;
        let rate = gained / took.max(f64::MIN_POSITIVE);
        run.outcome.rate = self.last.min(rate);
        self.last = rate;
        self.before = *balance;
    }
}

impl<N: Number, M: OutputMode> Machine<N, M>
where
    Environment: Tunable<N> + SupportsTiming<M>,
    <Environment as Discretize<N>>::Law: Clone,
{
    /// A servo and its sets.
    pub fn new(control: Control<N, M>, sets: Vec<PreparedServo<Environment, N, M>>) -> Self {
        Self { control, sets, mode: PhantomData }
    }

    /// Runs a plan. `audited`: with the energy of device and hand beside the account.
    pub fn run(&self, normalized: &NormalizedScene, plan: &Plan, audited: bool) -> Outcome {
        let NormalizedScene { damping, timing, .. } = normalized;
        let schedule = Schedule::new(plan, *damping, timing, audited);
        let mut mailbox = Mailbox::new();
        let (mut requests, mut inbox) = mailbox.split();
        if plan.armed_by_boot {
            requests.arm();
        }
        let mut control = self.control.clone();
        let mut run = Run::new(normalized, plan, &schedule);
        if matches!(control, Control::Bare(_)) {
            // What the environment stores where it is.
            run.last.state = ServoState::Running;
        }
        let window = (plan.periods / 4).max(LOOK);
        let mut rate = Rate { window, before: EnergyBalance::default(), last: -1.0 };
        let dropped = shifts(plan.readings.dropped.clone()).map(|sign| sign > 0);
        let readings = dropped.zip(shifts(plan.readings.noise.1.clone()));
        let shifts = shifts(plan.jitter.torques.clone()).zip(shifts(plan.jitter.counts.clone()));
        let (mut overdue, mut target) = (None, 0.0);
        let mut next_request = plan.next_request(0);
        let ticks = ticks(plan.pattern.clone()).zip(shifts).zip(readings);
        for (period, ((tick, (shift, count)), drop)) in (0..plan.periods).zip(ticks) {
            if let Some(on) = overdue.take() {
                run.motor.powered = on;
            }
            if period >= next_request {
                self.submit(&mut requests, plan, period);
                next_request = plan.next_request(period + 1);
            }
            run.since += 1;
            run.balance.periods += 1;
            let (_, mut at) = schedule.count(count);
            match tick {
                TickTiming::Delayed => at = schedule.delayed.1,
                TickTiming::Missed => {
                    run.skipped += 1;
                    run.in_a_row += 1;
                    at = usize::MAX;
                }
                TickTiming::OnTime | TickTiming::Late => {}
            }
            for (place, step) in schedule.steps.iter().enumerate() {
                if place == at {
                    let timed = (period, tick, shift, drop);
                    overdue = run.tick(&mut control, &mut inbox, &mut requests, timed);
                }
                run.motor.take(period, place, normalized.unordered);
                run.advance(place, step, &mut target);
            }
            let balance = &mut run.balance;
            balance.farthest = balance.farthest.max((run.x[0] - plan.zero).abs());
            if period % LOOK == LOOK - 1 {
                run.look(period, audited);
                rate.look(period, &mut run);
                if run.is_over() {
                    break;
                }
            }
            if run.saturated || run.x[1].abs() > normalized.fastest {
                break;
            }
        }
        run.outcome
    }

    /// Makes the requests of a period.
    fn submit(
        &self,
        requests: &mut Requests<'_, PreparedServo<Environment, N, M>>,
        plan: &Plan,
        period: u32,
    ) {
        for (_, request) in plan.requests.iter().flatten().filter(|(at, _)| *at == period) {
            match *request {
                Request::Arm => _ = requests.arm(),
                Request::Disarm => _ = requests.disarm(),
                Request::Submit(set) => {
                    if let Some(set) = self.sets.get(set) {
                        let _ = requests.submit(set.clone());
                    }
                }
            }
        }
    }
}
