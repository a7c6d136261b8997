//! One run: the servo loop on a simulated board, against device and hand, and the energy balance.
//!
//! With `W` the work of the motor and `b` the damping of the device, the energy `H` of device and
//! hand and what the hand's dampers took, `D`, are together `H(0) + W - b * integral v^2`. The
//! certificate claims that this is never above `H(0)` plus an allowance:
//!
//! - Each opening of the clamp may put in what the environment stores at its depth: the clamp's
//!   level times the environment's distance from its face.
//! - A torque that is off by `e` puts in at most `e` times the travel; encoder and numbers act
//!   where the environment is, whose travel is at most the device's and the coupling's.
//! - A servo that is stopped for missed updates held its torque `u` for longer than the certificate
//!   says, and that puts in at most `u^2 / 4 b` a period.

use std::marker::PhantomData;

use haptic_servo::environment::{Discretize, Environment};
use haptic_servo::number::Number;
use haptic_servo::servo::{OutputMode, OutputTiming, PreparedServo, SupportsTiming};
use haptic_servo::servo_loop::{Mailbox, ServoLoop, State as ServoState};
use haptic_servo::tuning::Tunable;

use crate::device::{HeldDevice, State, Step, TORQUE};
use crate::hardware::{Board, Last, PERIOD};
use crate::normalized_scene::NormalizedScene;
use crate::plan::{Pattern, Plan, Request, TickTiming};

/// When a code reaches the motor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Output {
    /// At the beginning of the next period.
    Latched,
    /// At its own count.
    Simultaneous,
    /// This part of a period after its count: not what any scene is certified for.
    Early(f64),
}

impl Output {
    /// That of a mode.
    pub const fn of<M: OutputMode>() -> Self {
        match M::TIMING {
            OutputTiming::Simultaneous => Self::Simultaneous,
            _ => Self::Latched,
        }
    }
}

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
    /// Ticks whose torque was limited, by reason.
    pub limits: [u32; 6],
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

/// A booted servo and the sets that may be swapped in.
pub struct Machine<N: Number, M> {
    /// The servo as it booted.
    pub servo_loop: ServoLoop<Environment, N, M>,
    /// The sets: its own and the other one.
    pub sets: Vec<PreparedServo<Environment, N, M>>,
    /// When its codes reach the motor.
    pub output: Output,
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
}

impl EnergyBalance {
    /// What torques that are off allow.
    fn errors(&self, normalized: &NormalizedScene) -> f64 {
        let turns = (self.farthest / std::f64::consts::TAU).max(1.0);
        let error = normalized.error + normalized.numbers * turns;
        error * (2.0 * self.travel + normalized.compliance * self.changes)
    }

    /// Moves the state on with this torque, and books what that takes and gives.
    #[inline]
    fn advance(&mut self, x: &mut State, step: &Step, torque: f64, damping: f64) {
        self.changes += (torque - x[TORQUE]).abs();
        x[TORQUE] = torque;
        let start = x[0];
        self.taken += step.taken(x);
        let squared = step.advance(x);
        let loss = squared * damping;
        let work = torque * (x[0] - start);
        self.gained += work - loss;
        self.moved += work.abs();
        self.dissipated += loss;
        self.travel += squared.max(0.0).sqrt();
    }

    fn allowed(&self, normalized: &NormalizedScene) -> f64 {
        let NormalizedScene { bound, compliance, face, .. } = *normalized;
        let opening = bound * (self.farthest + face + compliance * bound);
        f64::from(self.openings) * opening + self.errors(normalized) + self.stops
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
struct Ticks {
    pattern: Pattern,
    at: usize,
    in_a_row: u32,
}

impl Ticks {
    #[inline]
    fn next(&mut self) -> TickTiming {
        match &mut self.pattern {
            Pattern::AllOnTime => TickTiming::OnTime,
            Pattern::Periodic(ticks, length) => {
                let tick = ticks[self.at];
                self.at = (self.at + 1) % *length;
                tick
            }
            Pattern::Random { seed, missed, late, most } => {
                let number = next(seed);
                let tick = if number & 0xff < u64::from(*missed) {
                    TickTiming::Missed
                } else if number >> 8 & 0xff < u64::from(*late) {
                    TickTiming::Late
                } else {
                    TickTiming::OnTime
                };
                self.in_a_row = if tick == TickTiming::OnTime { 0 } else { self.in_a_row + 1 };
                if self.in_a_row > *most {
                    self.in_a_row = 0;
                    return TickTiming::OnTime;
                }
                tick
            }
        }
    }
}

impl<N: Number, M: OutputMode> Machine<N, M>
where
    Environment: Tunable<N> + SupportsTiming<M>,
    <Environment as Discretize<N>>::Law: Clone,
{
    /// A booted servo and its sets.
    pub fn new(
        servo_loop: ServoLoop<Environment, N, M>,
        sets: Vec<PreparedServo<Environment, N, M>>,
        output: Output,
    ) -> Self {
        Self { servo_loop, sets, output, mode: PhantomData }
    }

    /// Runs a plan. `audited`: with the energy of device and hand beside the account.
    pub fn run(&self, normalized: &NormalizedScene, plan: &Plan, audited: bool) -> Outcome {
        let held = HeldDevice::new(&plan.hand, normalized.damping);
        let step = |part: f64| if audited { held.audited(part) } else { held.step(part) };
        let parts = match self.output {
            Output::Early(part) => [Some(step(part)), Some(step(1.0 - part))],
            _ => [None, Some(step(1.0))],
        };
        self.play(normalized, plan, &held, &parts, audited)
    }

    fn play(
        &self,
        normalized: &NormalizedScene,
        plan: &Plan,
        held: &HeldDevice,
        parts: &[Option<Step>; 2],
        audited: bool,
    ) -> Outcome {
        let mut mailbox = Mailbox::new();
        let (mut requests, mut inbox) = mailbox.split();
        let mut servo_loop = self.servo_loop.clone();
        let mut board = Board::new(normalized.counts_per_radian, !plan.armed_by_boot);
        // As booting does it, with the device at the board's zero.
        board.angle = plan.zero;
        haptic_servo::boot::Startup::zero_encoder(&mut board);
        if plan.armed_by_boot {
            requests.arm();
        }
        let mut x = plan.start;
        let mut balance = EnergyBalance::default();
        let mut outcome =
            Outcome { score: -1.0, start: held.energy(&x), rate: -1.0, ..Outcome::default() };
        let mut last = Last::default();
        let (mut before, mut last_rate) = (EnergyBalance::default(), -1.0_f64);
        let window = (plan.periods / 4).max(LOOK);
        let mut ticks = Ticks { pattern: plan.pattern, at: 0, in_a_row: 0 };
        // Codes above mid-scale: what the motor has, and what waits for the next period.
        let (mut motor, mut waiting) = (0_i16, 0_i16);
        let mut overdue = None;
        let (mut skipped, mut in_a_row, mut since) = (0_u32, 0_u32, 0_u32);
        let mut strongest = 0.0_f64;
        let latched = self.output == Output::Latched;
        let mut powered = false;
        let torque = |motor: i16, powered: bool| {
            if powered { f64::from(motor) * normalized.torque_per_code } else { 0.0 }
        };
        let split = |part: f64| [part, 1.0 - part].map(|part| held.audited(part));
        let overrun = (latched && normalized.overrun > 0.0).then(|| split(normalized.overrun));
        let delayed = plan.pattern.delays().then(|| split(plan.delay));
        let mut was_late = false;
        let first = plan.requests.iter().flatten().map(|(period, _)| *period).min();
        let mut next_request = first.unwrap_or(u32::MAX);
        for period in 0..plan.periods {
            motor = if latched { waiting } else { motor };
            if let Some((code, on)) = overdue.take() {
                waiting = code;
                powered = on;
                motor = if latched { motor } else { waiting };
            }
            if period >= next_request {
                next_request = u32::MAX;
                for (at, request) in plan.requests.iter().flatten() {
                    if *at == period {
                        match *request {
                            Request::Arm => _ = requests.arm(),
                            Request::Disarm => _ = requests.disarm(),
                            Request::Submit(set) => {
                                if let Some(set) = self.sets.get(set) {
                                    let _ = requests.submit(set.clone());
                                }
                            }
                        }
                    } else if *at > period {
                        next_request = next_request.min(*at);
                    }
                }
            }
            since += 1;
            let tick = ticks.next();
            let mut switched = false;
            // A tick that has to wait for the one before it reads its count when that has ended.
            let waits = if tick == TickTiming::Delayed {
                delayed.as_ref()
            } else {
                overrun.as_ref().filter(|_| was_late && tick != TickTiming::Missed)
            };
            was_late = tick == TickTiming::Late;
            if let Some([first, _]) = waits {
                balance.advance(&mut x, first, torque(motor, powered), held.damping());
            }
            if tick == TickTiming::Missed {
                skipped += 1;
                in_a_row += 1;
            } else {
                let was = last.state;
                board.angle = x[0];
                board.passed = skipped + 1;
                board.late = tick == TickTiming::Late;
                board.delay = if tick == TickTiming::Delayed && plan.delay > normalized.in_time {
                    (plan.delay * f64::from(PERIOD)) as u32
                } else {
                    0
                };
                skipped = 0;
                servo_loop.run(&mut board, &mut inbox, &mut last);
                if board.late {
                    in_a_row += 1;
                    overdue = Some((board.offset, board.amplifier));
                } else {
                    waiting = board.offset;
                    powered = board.amplifier;
                    switched = true;
                }
                if last.state != was {
                    match last.state {
                        ServoState::FadingIn => balance.openings += 1,
                        // A clamp that opens within a tick.
                        ServoState::Running if was != ServoState::FadingIn => balance.openings += 1,
                        ServoState::Faulted => {
                            outcome.faults += 1;
                            let damping = held.damping().max(f64::MIN_POSITIVE);
                            let longest = f64::from(since.max(1) + 1);
                            balance.stops += longest * strongest * strongest / (4.0 * damping);
                        }
                        _ => {}
                    }
                }
                if in_a_row > normalized.tolerated && last.state.is_armed() && was.is_armed() {
                    outcome.went_on = true;
                }
                if !board.late {
                    in_a_row = 0;
                    since = 0;
                    strongest = 0.0;
                }
                if plan.again && last.state == ServoState::Faulted && period % 16 == 0 {
                    requests.arm();
                }
            }
            for (i, part) in parts.iter().enumerate() {
                let Some(part) = part else { continue };
                let part = waits.map_or(part, |[_, rest]| rest);
                if i == 1 && !latched && switched {
                    motor = waiting;
                }
                let torque = torque(motor, powered);
                strongest = strongest.max(torque.abs());
                balance.advance(&mut x, part, torque, held.damping());
            }
            balance.farthest = balance.farthest.max((x[0] - plan.zero).abs());
            if period % LOOK == LOOK - 1 {
                let allowed = balance.allowed(normalized);
                let all = outcome.start + allowed;
                let score = (balance.gained - allowed) / all.max(f64::MIN_POSITIVE);
                if score > outcome.score || score.is_nan() {
                    (outcome.score, outcome.period) = (score, period);
                    (outcome.gained, outcome.allowed) = (balance.gained, allowed);
                }
                let largest = outcome.start + balance.gained;
                outcome.largest = outcome.largest.max(largest);
                outcome.openings = balance.openings;
                outcome.limits = last.limits;
                if audited {
                    let residual = held.energy(&x) + balance.taken - largest;
                    outcome.residual = outcome.residual.max(residual.abs());
                }
                if period % window >= window - LOOK {
                    let errors = balance.errors(normalized) - before.errors(normalized);
                    // With what rounds away, so that rest is no gain.
                    let rounded = ROUNDING * (balance.moved + balance.dissipated + outcome.start);
                    let took = (balance.dissipated - before.dissipated).max(0.0) + errors + rounded;
                    let rate = (balance.gained - before.gained - errors - rounded)
                        / took.max(f64::MIN_POSITIVE);
                    outcome.rate = last_rate.min(rate);
                    last_rate = rate;
                    before = balance;
                }
                outcome.periods = period + 1;
                // Beyond all numbers.
                if outcome.largest > 1e12 * all || outcome.largest.is_nan() {
                    break;
                }
            }
            // The transducers exclude that; in a fraction of it the counter cannot wrap unseen.
            if x[1].abs() > normalized.fastest {
                break;
            }
        }
        outcome
    }
}
