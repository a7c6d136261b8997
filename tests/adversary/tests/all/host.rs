//! A host that wants to take more energy out than its budget, beside a certified spring, in passive hands.
//!
//! Device, hand and amplifier are linear and have no damping but the device's, so that each tick is exact; the
//! energy in mass and spring of the hand is counted, and so is all that the spring of the scene could give. With
//! a debit of the tank switched off the same search finds a run above the budget.

use haptic_model::host::{HostLaw, HostileHost, Reading};
use haptic_servo::environment::VariableDelay;
use haptic_servo::host::{HostResponse, HostTorque, Sampling, Tank};
use haptic_servo::scene::{Latency, Timing};
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
}

/// Position, speed, torque of the amplifier; then its command, and the torque of the scene.
type State = [f64; 5];

/// The transition over a tick, by the series of the exponential over a small part of it, squared.
fn transition(inertia: f64, stiffness: f64, lag: f64) -> [State; 5] {
    let mut rates = [[0.0; 5]; 5];
    rates[0][1] = 1.0;
    rates[1] = [-stiffness / inertia, -DELTA / inertia, 1.0 / inertia, 0.0, 1.0 / inertia];
    if lag > 0.0 {
        rates[2] = [0.0, 0.0, -1.0 / lag, 1.0 / lag, 0.0];
    } else {
        (rates[1][2], rates[1][3]) = (0.0, 1.0 / inertia);
    }
    let part = PERIOD / f64::from(1 << 16);
    let mut sum = product(&[[0.0; 5]; 5], &rates);
    for (i, row) in sum.iter_mut().enumerate() {
        row[i] = 1.0;
    }
    let mut term = sum;
    for power in 1..8 {
        term = product(&term, &rates).map(|row| row.map(|it| it * part / f64::from(power)));
        for (row, more) in sum.iter_mut().zip(&term) {
            row.iter_mut().zip(more).for_each(|(sum, more)| *sum += more);
        }
    }
    for _ in 0..16 {
        sum = product(&sum, &sum);
    }
    sum
}

fn product(a: &[State; 5], b: &[State; 5]) -> [State; 5] {
    let entry = |i: usize, j: usize| (0..5).map(|k| a[i][k] * b[k][j]).sum();
    std::array::from_fn(|i| std::array::from_fn(|j| entry(i, j)))
}

/// A host beside a device in a hand.
struct Case {
    host: HostTorque,
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
        let counts = without.is_none() && random.random();
        let lag = if lags { PERIOD * 10_f64.powf(random.random_range(-1.5..0.5)) } else { 0.0 };
        let count = match without {
            Some(Debit::Counts) => 10_f64.powf(random.random_range(-4.0..-2.5)),
            _ if counts => 10_f64.powf(random.random_range(-6.0..-4.0)),
            _ => FINE,
        };
        // The torque of the spring does not lag, so beside a lag there is none.
        let spring = if lags { 0.0 } else { 0.999 * (DELTA - share) / (1.5 * PERIOD) };
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
        let latency = Latency::NONE.with_actuator_lag(lag);
        let sampling =
            Sampling::simultaneous(&timing, self.count / f64::from(self.parts), self.code());
        let mut response = HostResponse::of(&self.host, &latency, &sampling).ok()?;
        if without == Some(Debit::Tail) {
            // Of the cost of a command only the part within its own period.
            let (left, gone) = (response.decay, 1.0 - response.decay);
            response.price -= response.tail[0] * gone * gone;
            response.pull[0] -= response.tail[0] * gone * left;
        }
        Tank::new(&self.host, &response).ok()
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

/// The largest energy that a run gives, over its budget.
fn run(random: &mut ChaCha8Rng, without: Option<Debit>) -> f64 {
    let case = Case::draw(random, without);
    let Some(mut tank) = case.tank(without) else { return 0.0 };
    let Case { inertia, stiffness, .. } = case;
    let motion = transition(inertia, stiffness, case.lag);
    let mut wish = Wish::draw(random, (stiffness / inertia).sqrt() * PERIOD);
    let (mut state, mut before, mut most) = ([0.0; 5], 0, 0.0_f64);
    for tick in 0..TICKS {
        let count = case.counted(state[0]);
        let steps = count - before;
        if tick > 0 {
            tank.book(steps * case.parts);
        }
        let [x, moved] = [count, steps].map(|counts| f64::from(counts) * case.count);
        let command = tank.allowed(tank.in_range(wish.torque(tick, x, moved) as f32));
        tank.give(command);
        (before, state[3]) = (count, f64::from(command) * case.code());
        let next: State = std::array::from_fn(|i| (0..5).map(|j| motion[i][j] * state[j]).sum());
        state = [next[0], next[1], next[2], 0.0, -case.spring * state[0]];
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
    for debit in [Debit::Lag, Debit::Counts, Debit::Tail] {
        let most = most(super::FEW, Some(debit));
        println!("without {debit:?}: {most}");
        assert!(most > 1.0, "without {debit:?}: {most}");
    }
}
