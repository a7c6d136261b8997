//! Sums of a torque profile, a wall and a canceller, computed here from their definitions: no closed motion
//! takes more energy than the bound allows, with the torque limited or not, and certified ones come to rest
//! in random passive hands.
//!
//! `COMPOSED_RUNS=20000 cargo test -p tests --test all composed` searches longer.

use haptic_servo::certificate::PassivityProblem;
use haptic_servo::environment::{Canceller, Ends, Parts, Profile, Shape, Side, Wall};
use haptic_servo::scene::{Coupling, Device, Latency, Scene, Timing};
use rand::Rng;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;

use crate::profiles::Held;

/// Sample period in s; all times are in proportion to it.
const PERIOD: f64 = 1e-3;
/// Knots of a period of the profile.
const KNOTS: usize = 8;
/// Closed motions that are tried on each sum.
const MOTIONS: usize = 6;
/// Changes of a motion, of which those are kept that take more energy.
const CHANGES: usize = 150;
/// The smallest motion in periods of the profile.
const SMALLEST: f64 = 1e-4;
/// Turns of a closed motion after which a canceller has forgotten how it began.
pub(super) const SETTLED: usize = 60;

/// A sum, by the numbers from which its torque is computed here.
#[derive(Debug)]
struct Sum {
    /// Torques in N m of the knots, at equal distances.
    torques: Vec<f64>,
    /// Length of the profile's period in rad.
    pitch: f64,
    /// Whole samples by which it is late.
    delay: usize,
    ends: Option<Ends>,
    wall: Option<Wall>,
    /// Damping in N m s/rad that is cancelled.
    cancelled: Option<f64>,
    /// Largest torque in N m.
    limit: f64,
    /// The part of a sample by which torques are late where nothing is coupled; `None`: behind the standard
    /// coupling.
    at_port: Option<f64>,
}

fn log_uniform(random: &mut ChaCha8Rng, from: f64, to: f64) -> f64 {
    (from.ln() + random.random::<f64>() * (to / from).ln()).exp()
}

impl Sum {
    fn random(random: &mut ChaCha8Rng) -> Self {
        let (has_wall, cancels) =
            [(true, false), (false, true), (true, true)][random.random_range(0..3)];
        let mut torques: Vec<f64> = (0..KNOTS).map(|_| random.random_range(-1.0..1.0)).collect();
        // Odd about the first knot, so that a limit makes no motor of it.
        for i in 0..=KNOTS / 2 {
            let odd = 0.5 * (torques[i] - torques[(KNOTS - i) % KNOTS]);
            (torques[i], torques[(KNOTS - i) % KNOTS]) = (odd, -odd);
        }
        let pitch = std::f64::consts::TAU / f64::from(random.random_range(1..40_u32));
        // About the steepest slope that there may be.
        let slope = 2.0 * KNOTS as f64 / pitch;
        let ends = (has_wall || random.random_bool(0.3)).then(|| {
            let half = pitch * random.random_range(1.0..4.0);
            Ends { from: -half, to: half, stiffness: slope * random.random_range(0.05..1.0) }
        });
        let wall = has_wall.then(|| {
            let stiffness = slope * log_uniform(random, 0.05, 2.0);
            let damping = if random.random_bool(0.5) {
                0.0
            } else {
                slope * PERIOD * log_uniform(random, 0.05, 2.0)
            };
            let delay = random.random_range(0..4);
            let face = pitch * random.random_range(-1.0..1.0);
            let side =
                if random.random_bool(0.6) { Side::Face(face) } else { Side::Displaced(face) };
            Wall { side, ..Wall::damped(stiffness, damping, delay) }
        });
        let cancelled = cancels.then(|| slope * PERIOD * log_uniform(random, 0.05, 2.0));
        let limit =
            if random.random_bool(0.6) { log_uniform(random, 0.05, 3.0) } else { f64::INFINITY };
        let delay = random.random_range(1..4);
        Self { torques, pitch, delay, ends, wall, cancelled, limit, at_port: None }
            .with_knots_of_the_table()
    }

    /// Its knots are whole numbers of units.
    fn with_knots_of_the_table(mut self) -> Self {
        let profile = self.profile();
        let full = f64::from(haptic_servo::environment::FULL_SCALE);
        let units = profile.units().iter();
        self.torques = units.map(|&unit| f64::from(unit) * profile.torque / full).collect();
        self
    }

    fn profile(&self) -> Profile {
        let cell = self.pitch / KNOTS as f64;
        let knots: Vec<(f64, f64)> =
            (0..=KNOTS).map(|i| (i as f64 * cell, self.torques[i % KNOTS])).collect();
        let mut shapes = vec![Shape::Periodic(knots.leak())];
        shapes.extend(
            self.ends.map(|Ends { from, to, stiffness }| Shape::end_stops(from, to, stiffness)),
        );
        Profile::sampled(&shapes, vec![0; KNOTS].leak(), self.delay).unwrap()
    }

    fn scene(&self, damping: f64) -> Scene {
        let canceller = self.cancelled.map(|cancelled| Canceller::to(damping - cancelled));
        Scene {
            device: Device { inertia: 1e-5, damping, passivity: None },
            timing: Timing { period: PERIOD, worst_period: None },
            coupling: match self.at_port {
                Some(_) => Coupling::Rigid,
                None => Coupling::Spring { stiffness: 2.0 * damping / PERIOD },
            },
            environment: Parts { canceller, wall: self.wall, profile: Some(self.profile()) }.sum(),
            latency: Latency::delayed(self.at_port.unwrap_or(0.0) * PERIOD),
            torque_limit: Some(self.limit).filter(|limit| limit.is_finite()),
        }
    }

    /// The least damping that is certified.
    fn least_damping(&self) -> f64 {
        let passes = |damping: f64| {
            PassivityProblem::of(&self.scene(damping)).is_ok_and(|posed| posed.is_certified())
        };
        let (mut low, mut high) = (1e-9, 1e4);
        assert!(passes(high), "{self:?}");
        while high > (1.0 + 1e-6) * low {
            let middle = (low * high).sqrt();
            if passes(middle) { high = middle } else { low = middle }
        }
        high
    }

    fn of_profile(&self, angle: f64) -> f64 {
        let within = self.ends.map_or(angle, |Ends { from, to, .. }| angle.clamp(from, to));
        let place = (within / self.pitch).rem_euclid(1.0) * KNOTS as f64;
        let (knot, part) = (place.floor(), place.fract());
        let at = |knot: usize| self.torques[knot % KNOTS];
        let inside = at(knot as usize) * (1.0 - part) + at(knot as usize + 1) * part;
        inside + self.ends.map_or(0.0, |ends| ends.stiffness * (angle - within))
    }

    fn of_wall(wall: &Wall, angle: f64, before: f64) -> f64 {
        let depth = angle - wall.face();
        let torque = wall.stiffness * depth + wall.damping() / PERIOD * (angle - before);
        match wall.is_one_sided() {
            true if depth <= 0.0 => 0.0,
            true => torque.max(0.0),
            false => torque,
        }
    }

    /// What a tick has from the ticks before it.
    fn late(&self, damping: f64, history: &History) -> Late {
        let past = |samples: usize| history.positions[samples - 1];
        let mut held = self.of_profile(past(self.delay));
        let mut wall = None;
        match self.wall {
            Some(other) if other.delay == 0 => wall = Some(other),
            Some(other) => held += Self::of_wall(&other, past(other.delay), past(other.delay + 1)),
            None => {}
        }
        let gain = self.cancelled.map_or(0.0, |be| be / PERIOD / (1.0 + be / (2.0 * damping)));
        Late { held, wall, gain, state: history.state, before: past(1), limit: self.limit }
    }

    /// Ends a tick with the environment at this angle.
    fn remember(&self, damping: f64, history: &mut History, angle: f64) {
        let rate = self.cancelled.map_or(1.0, |be| 1.0 / (1.0 + be / (2.0 * damping)));
        history.state += (angle - history.state) * rate;
        history.positions.rotate_right(1);
        history.positions[0] = angle;
    }
}

/// Positions of the environment, the latest first, and the canceller's state.
struct History {
    positions: [f64; 6],
    state: f64,
}

impl History {
    fn at_rest(angle: f64) -> Self {
        Self { positions: [angle; 6], state: angle }
    }
}

/// The torque of a tick as a function of the environment's angle.
struct Late {
    held: f64,
    wall: Option<Wall>,
    gain: f64,
    state: f64,
    before: f64,
    limit: f64,
}

impl Late {
    fn torque(&self, angle: f64) -> f64 {
        let wall = self.wall.map_or(0.0, |wall| Sum::of_wall(&wall, angle, self.before));
        let torque = self.held + wall - self.gain * (angle - self.state);
        torque.clamp(-self.limit, self.limit)
    }

    /// That of coupling and environment together, by a search: a deeper device is a deeper environment.
    fn solved(&self, x: f64, compliance: f64) -> f64 {
        let (mut low, mut high) = (x - 1e3, x + 1e3);
        for _ in 0..70 {
            let middle = 0.5 * (low + high);
            if middle + compliance * self.torque(middle) < x { low = middle } else { high = middle }
        }
        (x - 0.5 * (low + high)) / compliance
    }
}

/// The index in N m s/rad without which a closed motion, of these angles in turn, takes energy.
fn needed(sum: &Sum, damping: f64, motion: &[f64]) -> f64 {
    let mut history = History::at_rest(motion[0]);
    let turns = SETTLED.div_ceil(motion.len());
    let (mut work, mut squares) = (0.0, 0.0);
    for _ in 0..=turns {
        (work, squares) = (0.0, 0.0);
        for &angle in motion {
            let step = angle - history.positions[0];
            work += sum.late(damping, &history).torque(angle) * step;
            squares += step * step;
            sum.remember(damping, &mut history, angle);
        }
    }
    // Rounding moves smaller values.
    if squares < (SMALLEST * sum.pitch).powi(2) {
        return f64::MIN;
    }
    -PERIOD * work / squares
}

/// The part of the work of damping that a closed motion takes from a controller at the port of a device that
/// has just that: by the work of the mean torque of each tick, and by its ripple.
fn taken_at_port(sum: &Sum, damping: f64, motion: &[f64]) -> f64 {
    let late = sum.at_port.unwrap_or(0.0);
    let mut history = History::at_rest(motion[0]);
    let (mut given, mut squares, mut before) = (0.0, 0.0, 0.0);
    for _ in 0..SETTLED.div_ceil(motion.len()) {
        (given, squares) = (0.0, 0.0);
        for (i, &angle) in motion.iter().enumerate() {
            let step = motion[(i + 1) % motion.len()] - angle;
            let torque = sum.late(damping, &history).torque(angle);
            let ripple = PERIOD * late * (1.0 - late) * (torque - before).powi(2);
            given += ((1.0 - late) * torque + late * before) * step - ripple / (4.0 * damping);
            squares += step * step;
            before = torque;
            sum.remember(damping, &mut history, angle);
        }
    }
    if squares < (SMALLEST * sum.pitch).powi(2) {
        return f64::MIN;
    }
    -PERIOD * given / (damping * squares)
}

/// A closed motion that needs much: changed at random as long as that makes it need more. Slow ones, to which
/// a canceller and a delay give the most, begin as a circle.
///
/// `pitch` is the size in rad of the largest.
pub(super) fn worst(pitch: f64, random: &mut ChaCha8Rng, needed: impl Fn(&[f64]) -> f64) -> f64 {
    let length = [2, 2, 3, 4, 6, 12, 24, 48][random.random_range(0..8)];
    let size = pitch * log_uniform(random, 1e-3, 1.0);
    let middle = pitch * random.random_range(-2.0..2.0);
    let phase = std::f64::consts::TAU / length as f64;
    let mut motion: Vec<f64> =
        (0..length).map(|i| middle + size * (phase * f64::from(i)).cos()).collect();
    let mut worst = needed(&motion);
    for change in 0..CHANGES {
        let before = motion.clone();
        let size = size * 0.97_f64.powi(change as i32 % 100);
        match random.random_range(0..4) {
            0 => {
                // All of it moves to another place.
                let by = pitch * log_uniform(random, 1e-3, 1.0) * random.random_range(-1.0..1.0);
                motion.iter_mut().for_each(|angle| *angle += by);
            }
            1 => {
                let (centre, by) = (motion[0], log_uniform(random, 0.5, 2.0));
                motion.iter_mut().for_each(|angle| *angle = centre + by * (*angle - centre));
            }
            _ => {
                let which = random.random_range(0..motion.len());
                motion[which] += size * random.random_range(-1.0..1.0);
            }
        }
        let found = needed(&motion);
        if found > worst { worst = found } else { motion = before }
    }
    worst
}

fn runs(usual: usize) -> usize {
    std::env::var("COMPOSED_RUNS").map_or(usual, |runs| runs.parse().unwrap())
}

#[test]
fn no_closed_motion_takes_more_energy_than_the_bound_allows() {
    let mut random = ChaCha8Rng::seed_from_u64(23);
    let (runs, mut shares) = (runs(300), Vec::new());
    for _ in 0..runs {
        let sum = Sum::random(&mut random);
        let damping = 1.01 * sum.least_damping();
        let bound = PassivityProblem::of(&sum.scene(damping)).unwrap().bound().unwrap().hi();
        let of_sum = |motion: &[f64]| needed(&sum, damping, motion);
        let worst = (0..MOTIONS).map(|_| worst(sum.pitch, &mut random, of_sum));
        let worst = worst.fold(f64::MIN, f64::max);
        assert!(worst <= bound * (1.0 + 1e-9), "{worst} of {bound}: {sum:?}");
        shares.push(worst / bound);
    }
    shares.sort_by(f64::total_cmp);
    let share = |part: f64| shares[(part * (runs - 1) as f64) as usize];
    let [quarter, half, most, all] = [0.25, 0.5, 0.9, 1.0].map(share);
    println!(
        "{runs} sums: a quarter takes up to {quarter:.3} of the bound, half up to {half:.3}, nine of ten up \
         to {most:.3}, all up to {all:.3}"
    );
    assert!(half > 0.5 && most > 0.9, "{half} {most}");
}

/// Equation 48 with the slopes of wall and profile, of whatever delays and limit.
#[test]
fn no_closed_motion_at_the_port_takes_more_than_the_damping() {
    let mut random = ChaCha8Rng::seed_from_u64(31);
    let (runs, mut shares) = (runs(200), Vec::new());
    while shares.len() < runs {
        let mut sum = Sum { cancelled: None, ..Sum::random(&mut random) };
        let Some(wall) = &mut sum.wall else { continue };
        wall.damper = None;
        sum.at_port = Some(if random.random_bool(0.3) { 0.0 } else { random.random() });
        let damping = sum.least_damping();
        let taken = |motion: &[f64]| taken_at_port(&sum, damping, motion);
        let worst = (0..MOTIONS).map(|_| worst(sum.pitch, &mut random, taken));
        let worst = worst.fold(f64::MIN, f64::max);
        assert!(worst <= 1.0 + 1e-9, "{worst}: {sum:?}");
        shares.push(worst);
    }
    shares.sort_by(f64::total_cmp);
    let (half, all) = (shares[runs / 2], shares[runs - 1]);
    println!("{runs} sums at the port: half takes up to {half:.3}, all up to {all:.3}");
    assert!(half > 0.2 && all > 0.9, "{half} {all}");
}

#[test]
fn certified_sums_come_to_rest_in_passive_hands() {
    let mut random = ChaCha8Rng::seed_from_u64(29);
    for _ in 0..runs(300) {
        let sum = Sum::random(&mut random);
        let damping = 1.01 * sum.least_damping();
        let hand = Hand::random(&sum, damping, &mut random);
        assert!(!keeps_moving(&sum, damping, &hand), "{sum:?} in {hand:?}");
    }
}

/// An undamped hand, and how the device starts in it.
#[derive(Debug)]
struct Hand {
    /// Of hand and device in kg m^2.
    mass: f64,
    /// Stiffness of the hand's spring in N m/rad; 0: free.
    spring: f64,
    /// Where that is at rest, in rad.
    grip: f64,
    /// Angle in rad and speed in rad/s.
    start: (f64, f64),
}

impl Hand {
    fn random(sum: &Sum, damping: f64, random: &mut ChaCha8Rng) -> Self {
        let mass = log_uniform(random, 0.03, 10.0) * damping * PERIOD;
        let swing = if random.random_bool(0.2) { 0.0 } else { random.random_range(0.0..3.1) };
        let grip = sum.pitch * random.random_range(-1.0..1.0);
        let speed = sum.pitch / PERIOD * log_uniform(random, 3e-3, 0.4);
        Self { mass, spring: mass * (swing / PERIOD).powi(2), grip, start: (grip, speed) }
    }
}

/// Whether the device goes on moving in this hand.
fn keeps_moving(sum: &Sum, damping: f64, hand: &Hand) -> bool {
    let Hand { mass, spring, grip, start } = *hand;
    let tick = Held::over(PERIOD, mass, damping, spring);
    let compliance = PERIOD / (2.0 * damping);
    let (mut x, mut v) = start;
    let mut history = History::at_rest(x);
    // A hundredth of the damping is over: as many time constants as bring it to rest.
    let window = (4_000.0 * mass / (damping * PERIOD)) as usize + 2_000;
    for _ in 0..6 {
        let mut fastest = 0.0_f64;
        for _ in 0..window {
            let late = sum.late(damping, &history);
            let torque = late.solved(x, compliance);
            sum.remember(damping, &mut history, x - compliance * torque);
            (x, v) = tick.step(x, v, torque - spring * grip);
            fastest = fastest.max(v.abs());
        }
        if fastest * PERIOD < 1e-6 * sum.pitch {
            return false;
        }
    }
    true
}
