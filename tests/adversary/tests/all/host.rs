//! A host that wants to take more energy out than its budget, beside a certified spring, in passive hands.
//!
//! Device, hand and amplifier are linear and have no damping but the device's, so that each tick is exact; the
//! energy in mass and spring of the hand is counted, and so is all that the spring of the scene could give. A
//! part of the amplifiers is the current loop of a board's own bridge. With a debit of the tank switched off the
//! same search finds a run above the budget.

use haptic_model::host::{HostLaw, HostileHost, Reading};
use haptic_servo::environment::{VariableDelay, Wall};
use haptic_servo::host::{HostResponse, HostTorque, Sampling, Tank};
use haptic_servo::scene::{Coupling, Device, Latency, Scene, TimeRange, Timing};
use nalgebra::{SMatrix, SVector};
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;

const PERIOD: f64 = 1e-3;
const DELTA: f64 = 0.022;
const TICKS: usize = 1500;
/// Width in rad of a count whose error is small.
const FINE: f64 = 2e-5;

/// A debit of the tank.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Debit {
    Lag,
    Counts,
    Tail,
    /// The current loop's straight lines in place of a lag without updates.
    Updates,
    /// The instant after which its torque begins.
    Instant,
}

/// Position, speed, torque of the amplifier; then its command, or the slope of its torque between two updates, and
/// the torque of the scene.
type State = SVector<f64, 5>;

/// The transition over a tick, or for an amplifier with updates over the time between two of them.
fn transition(case: &Case) -> SMatrix<f64, 5, 5> {
    let &Case { inertia, stiffness, lag, .. } = case;
    let mut rates = SMatrix::<f64, 5, 5>::zeros();
    rates[(0, 1)] = 1.0;
    let of_speed = [-stiffness / inertia, -DELTA / inertia, 1.0 / inertia, 0.0, 1.0 / inertia];
    rates.set_row(1, &of_speed.into());
    if case.updates.is_some() {
        rates[(2, 3)] = 1.0;
    } else if lag > 0.0 {
        (rates[(2, 2)], rates[(2, 3)]) = (-1.0 / lag, 1.0 / lag);
    } else {
        (rates[(1, 2)], rates[(1, 3)]) = (0.0, 1.0 / inertia);
    }
    (rates * case.step()).exp()
}

/// A current loop on a board: its updates in a period, the update at which a torque begins, and whether its code
/// was put out at the next count.
#[derive(Clone, Copy, Debug)]
struct Updates {
    count: u16,
    begins: u16,
    is_latched: bool,
}

impl Updates {
    fn draw(random: &mut ChaCha8Rng, most: u16) -> Self {
        let count = random.random_range(2..=most);
        let is_latched: bool = random.random();
        // At a phase it begins later than at the first update.
        let begins = if is_latched { 1 } else { random.random_range(1..count) };
        Self { count, begins, is_latched }
    }

    fn latency(&self, lag: f64) -> Latency {
        let delay = f64::from(self.begins) * PERIOD / f64::from(self.count);
        let output_delay = TimeRange::exactly(delay);
        Latency { output_delay, ..Latency::sampled(self.count, lag, PERIOD) }
    }
}

/// The stiffness of a spring, a sample late, that certifies at the port of a device with this damping.
fn certified_spring(damping: f64, latency: Latency) -> f64 {
    let certifies = |stiffness: f64| {
        let scene = Scene {
            device: Device { inertia: 2.2e-5, damping, passivity: None },
            timing: Timing { period: PERIOD, worst_period: None },
            coupling: Coupling::Rigid,
            environment: Wall::spring(stiffness, 1).alone(),
            latency,
            torque_limit: None,
        };
        scene.certify().is_ok()
    };
    let (mut passes, mut fails) = (0.0, damping / PERIOD);
    for _ in 0..12 {
        let stiffness = 0.5 * (passes + fails);
        *(if certifies(stiffness) { &mut passes } else { &mut fails }) = stiffness;
    }
    passes
}

/// A host beside a device in a hand.
struct Case {
    host: HostTorque,
    updates: Option<Updates>,
    /// Time constant of the amplifier in s, 0 without one; and width of a count in rad.
    lag: f64,
    count: f64,
    /// Parts of a count that the tank takes for one.
    parts: i32,
    /// Stiffness of the scene's spring.
    spring: f64,
    /// Of device and hand together.
    inertia: f64,
    stiffness: f64,
}

impl Case {
    fn draw(random: &mut ChaCha8Rng, without: Option<Debit>) -> Self {
        let share = DELTA * random.random_range(0.1..0.9);
        let lags = match without {
            None => random.random(),
            Some(debit) => debit != Debit::Counts,
        };
        let of_bridge = matches!(without, Some(Debit::Updates | Debit::Instant));
        // Straight lines show most where they are long and the lag is short.
        let is_coarse = without == Some(Debit::Updates);
        let updates = (lags && (of_bridge || without.is_none() && random.random()))
            .then(|| Updates::draw(random, if is_coarse { 3 } else { 12 }));
        let counts = without.is_none() && random.random();
        let lag = 10_f64.powf(random.random_range(-1.5..if is_coarse { -1.0 } else { 0.5 }));
        let lag = if lags { PERIOD * lag } else { 0.0 };
        let count = match without {
            Some(Debit::Counts) => 10_f64.powf(random.random_range(-4.0..-2.5)),
            _ if counts => 10_f64.powf(random.random_range(-6.0..-4.0)),
            _ => FINE,
        };
        // The torque of the spring lags in the bridge alone.
        let spring = match updates {
            Some(updates) => certified_spring(DELTA - share, updates.latency(lag)),
            None if lags => 0.0,
            None => 0.999 * (DELTA - share) / (1.5 * PERIOD),
        };
        let is_held: bool = random.random();
        let has_power: bool = random.random();
        Self {
            host: HostTorque {
                energy: 10_f64.powf(random.random_range(-2.5..0.0)),
                power: if has_power { random.random_range(0.0..1.0) } else { 0.0 },
                damping: share,
                torque: if count == FINE { 20.0 } else { 0.5 },
                timeout: 0.1,
            },
            updates,
            lag,
            count,
            parts: if without == Some(Debit::Counts) { 64 } else { 1 },
            spring,
            inertia: 2.2e-5 * 10_f64.powf(random.random_range(0.0..2.5)),
            stiffness: if is_held { 10_f64.powf(random.random_range(-1.0..2.5)) } else { 0.0 },
        }
    }

    /// The tank, without a debit; `None` if the energy is less than the counts can cost.
    fn tank(&self, without: Option<Debit>) -> Option<Tank<VariableDelay<i64>, 1>> {
        let lag = if without == Some(Debit::Lag) { 0.0 } else { self.lag };
        let timing = Timing { period: PERIOD, worst_period: None };
        let latency = |updates: Updates| updates.latency(lag);
        let mut latency =
            self.updates.map_or_else(|| Latency::NONE.with_actuator_lag(lag), latency);
        match without {
            Some(Debit::Updates) => latency.actuator_updates = 0,
            Some(Debit::Instant) => latency.output_delay = TimeRange::exactly(0.0),
            _ => {}
        }
        let ticks = usize::from(self.updates.is_some_and(|updates| updates.is_latched));
        let count = self.count / f64::from(self.parts);
        let sampling = Sampling { ticks, ..Sampling::simultaneous(&timing, count, self.code()) };
        let mut response = HostResponse::of(&self.host, &latency, &sampling).ok()?;
        if without == Some(Debit::Tail) {
            // Of the cost of a command only the part within its own period.
            let (left, gone) = (response.decay, 1.0 - response.decay);
            response.price -= response.tail[0] * gone * gone;
            response.pull[0] -= response.tail[0] * gone * left;
        }
        Tank::new(&self.host, &response).ok()
    }

    /// Time in s of a step in which the amplifier does not change what it does.
    fn step(&self) -> f64 {
        self.updates.map_or(PERIOD, |updates| PERIOD / f64::from(updates.count))
    }

    /// N m of a code of the DAC.
    fn code(&self) -> f64 {
        self.host.torque / 1791.0
    }

    fn counted(&self, x: f64) -> i32 {
        (x / self.count).floor() as i32
    }
}

/// What a host wants.
enum Wish {
    Law(HostileHost),
    /// The hand's resonance, in rad per period.
    Resonance {
        size: f64,
        omega: f64,
    },
    /// A damper below zero.
    Damper {
        size: f64,
    },
}

impl Wish {
    fn draw(random: &mut ChaCha8Rng, omega: f64) -> Self {
        let kind = random.random_range(0..7);
        let size = 10_f64.powf(random.random_range(-1.0..2.0));
        let length = f64::from(random.random_range(1..40));
        match kind {
            5 => Self::Resonance { size, omega },
            6 => Self::Damper { size },
            // The fifth is a square wave that alternates each tick.
            _ => {
                let law = HostLaw::ALL.get(kind).copied().unwrap_or(HostLaw::Square);
                let half_period = PERIOD * if kind == 4 { 1.0 } else { length };
                let mut host = HostileHost::new(law, size);
                host.half_period = half_period;
                Self::Law(host)
            }
        }
    }

    fn torque(&mut self, tick: usize, position: f64, moved: f64) -> f64 {
        let (time, velocity) = (tick as f64 * PERIOD, moved / PERIOD);
        match self {
            Self::Law(host) => host.torque(&Reading { position, velocity, time }),
            Self::Resonance { size, omega } => *size * (*omega * tick as f64).sin(),
            Self::Damper { size } => 0.03 * *size * velocity,
        }
    }
}

/// The commands on their way to a bridge.
#[derive(Default)]
struct Bridge {
    /// What the current follows.
    command: f64,
    /// The host's last command, and the last torque of the spring.
    host: f64,
    spring: f64,
}

impl Bridge {
    /// The host's command that begins in this tick, which gives another.
    fn due(&mut self, updates: &Updates, command: f64) -> f64 {
        let last = std::mem::replace(&mut self.host, command);
        if updates.is_latched { last } else { command }
    }
}

/// The largest energy that a run gives, over its budget.
fn run(random: &mut ChaCha8Rng, without: Option<Debit>) -> f64 {
    let case = Case::draw(random, without);
    let Some(mut tank) = case.tank(without) else { return 0.0 };
    let Case { inertia, stiffness, .. } = case;
    let motion = transition(&case);
    let mut wish = Wish::draw(random, (stiffness / inertia).sqrt() * PERIOD);
    let (mut state, mut before, mut most) = (State::zeros(), 0, 0.0_f64);
    let mut bridge = Bridge::default();
    for tick in 0..TICKS {
        let count = case.counted(state[0]);
        let steps = count - before;
        if tick > 0 {
            tank.book(steps * case.parts);
        }
        let [x, moved] = [count, steps].map(|counts| f64::from(counts) * case.count);
        let command = tank.allowed(tank.in_range(wish.torque(tick, x, moved) as f32));
        tank.give(command);
        before = count;
        let command = f64::from(command) * case.code();
        let spring = -case.spring * state[0];
        if let Some(updates) = &case.updates {
            // The torque of the spring is that of the count before, and the host's may be, too.
            let (sum, step) = (bridge.due(updates, command) + bridge.spring, case.step());
            for update in 0..updates.count {
                if update == updates.begins {
                    bridge.command = sum;
                }
                let left = (-step / case.lag).exp();
                state[3] = (bridge.command - state[2]) * (1.0 - left) / step;
                state = motion * state;
            }
            bridge.spring = spring;
        } else {
            state[3] = command;
            state = motion * state;
            state[4] = spring;
        }
        let stored = 0.5 * (inertia * state[1] * state[1] + stiffness * state[0] * state[0]);
        let budget = case.host.energy + case.host.power * PERIOD * (tick + 1) as f64;
        most = most.max(stored / budget);
    }
    most
}

fn most(runs: u64, without: Option<Debit>) -> f64 {
    let one = |seed| run(&mut ChaCha8Rng::seed_from_u64(seed), without);
    (0..runs).map(one).fold(0.0, f64::max)
}

#[test]
fn no_host_gives_more_than_its_budget() {
    let most = most(super::FEW, None);
    println!("most of the budget: {most}");
    assert!(most <= 1.0, "{most}");
    assert!(most > 0.3, "the search is weak: {most}");
}

#[test]
fn a_debit_that_is_switched_off_is_found() {
    for debit in [Debit::Lag, Debit::Counts, Debit::Tail, Debit::Updates, Debit::Instant] {
        let most = most(super::FEW, Some(debit));
        println!("without {debit:?}: {most}");
        assert!(most > 1.0, "without {debit:?}: {most}");
    }
}
