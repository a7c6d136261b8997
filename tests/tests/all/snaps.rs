//! Detents with a snap point, against a model of their own in this file: the inequality of the index on
//! sequences of positions that are searched for to break it, and random passive hands.
//!
//! `SNAP_RUNS=100000 cargo test -p tests --test all snaps` searches longer.

use haptic_servo::certificate::PassivityProblem;
use haptic_servo::coupling::Response;
use haptic_servo::environment::{Discretize, Law, Profile, Shape};
use haptic_servo::scene::{Coupling, Device, Latency, Scene, Timing};
use rand::Rng;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;

use super::profiles::{Hand, Held};

/// Sample period in s; all times are in proportion to it.
const PERIOD: f64 = 1e-3;
/// Knots of the base, each in the middle of straight lines to the next.
const KNOTS: usize = 8;
/// Cells of the table, so that each of up to four detents in it is shown by four.
const CELLS: usize = 64;
/// Sequences that a search tries.
const ATTEMPTS: i32 = 150;
/// Hands for each knob.
const HANDS: usize = 6;

/// Detents with a snap point beside a periodic torque, as this file computes them.
#[derive(Clone, Debug)]
struct Knob {
    /// Torques in N m of the base at equal distances.
    base: Vec<f64>,
    /// Repetitions of the base in a turn.
    count: u32,
    /// Detents in a repetition.
    pitches: u32,
    /// Torque in N m at the snap point.
    torque: f64,
    snap: f64,
    centre: f64,
    /// Lower end, upper end, stiffness.
    ends: Option<[f64; 3]>,
    /// Torque limit in N m.
    limit: Option<f64>,
    delay: usize,
}

impl Knob {
    fn random(random: &mut ChaCha8Rng) -> Self {
        let count = random.random_range(1..20_u32);
        let pitches = random.random_range(1..5_u32);
        let pitch = std::f64::consts::TAU / f64::from(count * pitches);
        let has_ends = random.random_bool(0.5);
        let limit = random.random_bool(0.5).then(|| random.random_range(0.1..1.5));
        let strength = [0.0, 0.3, 3.0][random.random_range(0..3)];
        let is_free = has_ends || limit.is_none();
        Self {
            base: base(is_free, random).into_iter().map(|torque| torque * strength).collect(),
            count,
            pitches,
            torque: 1.0,
            snap: if random.random_bool(0.3) { 0.501 } else { random.random_range(0.51..1.6) },
            centre: if is_free { random.random_range(-1.0..1.0) * pitch } else { 0.0 },
            ends: has_ends.then(|| {
                let from = random.random_range(-3.0..1.0) * pitch;
                let to = from + random.random_range(1.1..6.0) * pitch;
                [from, to, random.random_range(0.2..4.0) / pitch]
            }),
            limit,
            delay: random.random_range(0..2),
        }
    }

    fn pitch(&self) -> f64 {
        std::f64::consts::TAU / f64::from(self.count * self.pitches)
    }

    /// Slope of the branches in N m/rad.
    fn slope(&self) -> f64 {
        self.torque / (self.snap * self.pitch())
    }

    /// The steepest slopes in N m/rad, rise or fall, of the base and the end stops.
    fn steepest(&self) -> f64 {
        let cell = std::f64::consts::TAU / f64::from(self.count) / KNOTS as f64;
        let next = |i: usize| (self.base[(i + 1) % KNOTS] - self.base[i]).abs() / cell;
        let steepest = (0..KNOTS).map(next).fold(0.0, f64::max);
        steepest.max(self.ends.map_or(0.0, |[.., stiffness]| stiffness))
    }

    /// Torque in N m over a part of a cell of the table, to which places are rounded.
    fn torque_of_part(&self) -> f64 {
        let part = std::f64::consts::TAU / f64::from(self.count) / (CELLS * 16384) as f64;
        (self.steepest() + self.slope()) * part
    }

    /// Whether a hair more or less would change the branch.
    fn is_at_a_threshold(&self, branch: f64, angle: f64) -> bool {
        let detent = (angle - self.centre) / self.pitch();
        let half_way = (detent - detent.floor() - 0.5).abs();
        half_way.min(((detent - branch).abs() - self.snap).abs()) < 1e-3
    }

    fn base_torque(&self, angle: f64) -> f64 {
        let period = std::f64::consts::TAU / f64::from(self.count);
        let place = (angle / period).rem_euclid(1.0) * KNOTS as f64;
        let (knot, part) = (place.floor(), place.fract());
        let at = |knot: usize| self.base[knot % KNOTS];
        at(knot as usize) * (1.0 - part) + at(knot as usize + 1) * part
    }

    /// The torque of a branch in N m at an angle in rad.
    fn torque_at(&self, branch: f64, angle: f64) -> f64 {
        let centre = self.centre + branch * self.pitch();
        let line = self.slope() * (angle - centre);
        let Some([from, to, stiffness]) = self.ends else { return self.base_torque(angle) + line };
        let within = angle.clamp(from, to);
        self.base_torque(within) + stiffness * (angle - within) + line
    }

    /// The branch after a tick at an angle in rad.
    fn snapped(&self, branch: f64, angle: f64) -> f64 {
        let away = (angle - self.centre) / self.pitch() - branch;
        if away.abs() <= self.snap { branch } else { self.nearest(angle) }
    }

    /// The branch of the nearest detent that can hold the knob.
    fn nearest(&self, angle: f64) -> f64 {
        let detent = |angle: f64| (angle - self.centre) / self.pitch();
        let nearest = detent(angle).round();
        self.ends.map_or(nearest, |[from, to, _]| {
            nearest.clamp((detent(from) - 0.01).ceil(), (detent(to) + 0.01).floor())
        })
    }

    fn profile(&self) -> Profile {
        let cell = std::f64::consts::TAU / f64::from(self.count) / KNOTS as f64;
        let knots: Vec<(f64, f64)> =
            (0..=KNOTS).map(|i| (i as f64 * cell, self.base[i % KNOTS])).collect();
        let detents = Shape::Detents {
            count: self.count * self.pitches,
            torque: self.torque,
            centre: self.centre,
        };
        let mut shapes = vec![Shape::Periodic(knots.leak()), detents.snap(self.snap)];
        shapes.extend(self.ends.map(|[from, to, stiffness]| Shape::EndStops {
            from,
            to,
            stiffness,
        }));
        Profile::sampled(&shapes, vec![0; CELLS].leak(), self.delay).unwrap()
    }

    /// Behind the standard coupling.
    fn scene(&self, damping: f64) -> Scene {
        Scene {
            device: Device { inertia: 1e-5, damping, passivity: None },
            timing: Timing { period: PERIOD, worst_period: None },
            coupling: Coupling::Spring { stiffness: 2.0 * damping / PERIOD },
            environment: self.profile().alone(),
            latency: Latency::NONE,
            torque_limit: self.limit,
        }
    }

    fn clipped(&self, torque: f64) -> f64 {
        self.limit.map_or(torque, |limit| torque.clamp(-limit, limit))
    }
}

/// Torques at equal distances of no mean; odd about the first one where they are not free.
fn base(is_free: bool, random: &mut ChaCha8Rng) -> Vec<f64> {
    let mut torques: Vec<f64> = (0..KNOTS).map(|_| random.random_range(-1.0..1.0)).collect();
    if !is_free {
        let other = torques.clone();
        (0..KNOTS).for_each(|i| torques[i] -= other[(KNOTS - i) % KNOTS]);
    }
    let mean = torques.iter().sum::<f64>() / KNOTS as f64;
    torques.iter_mut().for_each(|torque| *torque -= mean);
    torques
}

/// A knob behind its coupling: a tick with the device at an angle in rad gives the torque in N m and the
/// angle of the environment.
trait Tick {
    fn tick(&mut self, angle: f64) -> (f64, f64);
}

/// The model of this file.
struct Model<'a> {
    knob: &'a Knob,
    compliance: f64,
    branch: f64,
    due: f64,
}

impl<'a> Model<'a> {
    fn at_rest(knob: &'a Knob, compliance: f64, angle: f64) -> Self {
        let branch = knob.nearest(angle);
        Self { knob, compliance, branch, due: knob.torque_at(branch, angle) }
    }
}

impl Tick for Model<'_> {
    fn tick(&mut self, angle: f64) -> (f64, f64) {
        let wanted =
            if self.knob.delay == 0 { self.knob.torque_at(self.branch, angle) } else { self.due };
        let torque = self.knob.clipped(wanted);
        let inside = angle - self.compliance * torque;
        self.branch = self.knob.snapped(self.branch, inside);
        self.due = self.knob.torque_at(self.branch, inside);
        (torque, inside)
    }
}

/// The law that runs.
struct Firmware<'a, L> {
    knob: &'a Knob,
    compliance: f64,
    law: L,
}

impl<L: Law<f64>> Tick for Firmware<'_, L> {
    fn tick(&mut self, angle: f64) -> (f64, f64) {
        let Response::Held(wanted) = self.law.evaluate(angle) else { panic!("not held") };
        let torque = self.knob.clipped(wanted);
        let inside = angle - self.compliance * torque;
        self.law.update(inside);
        (torque, inside)
    }
}

/// The law of a knob in a scene, and the bound on its index in N m s/rad.
fn certified<'a>(knob: &'a Knob, damping: f64) -> (Firmware<'a, impl Law<f64> + use<>>, f64) {
    let scene = knob.scene(damping);
    let posed = PassivityProblem::of(&scene).unwrap_or_else(|error| panic!("{knob:?}: {error}"));
    let law = Discretize::<f64>::law(&scene.environment, &scene.context()).unwrap();
    let bound = posed.bound().unwrap_or_else(|| panic!("{knob:?}: no bound")).hi();
    (Firmware { knob, compliance: PERIOD / (2.0 * damping), law }, bound)
}

/// Angles of the device in rad that repeat, each time so many rad further on.
#[derive(Clone, Debug)]
struct Path {
    angles: Vec<f64>,
    on: f64,
}

impl Path {
    /// Back and forth, now and then in steps of many detents.
    fn there_and_back(knob: &Knob, width: f64, random: &mut ChaCha8Rng) -> Self {
        let [from, to] =
            knob.ends.map_or([-2.0 * knob.pitch(), 2.0 * knob.pitch()], |[from, to, _]| [from, to]);
        let middle = random.random_range(from..to);
        let length = random.random_range(2..7);
        let angles = (0..length).map(|_| middle + random.random_range(-1.0..1.0) * width).collect();
        Self { angles, on: 0.0 }
    }

    /// On and on by a repetition of the base.
    fn turning(knob: &Knob, random: &mut ChaCha8Rng) -> Self {
        let sign = if random.random_bool(0.5) { 1.0 } else { -1.0 };
        let on = sign * std::f64::consts::TAU / f64::from(knob.count);
        // In small steps, too, which cost little: a motor would show.
        let length = if random.random_bool(0.5) { 4..60 } else { 200..600 };
        let length = random.random_range(length);
        let start = random.random_range(-1.0..1.0) * on;
        let angles = (0..length).map(|i| start + on * f64::from(i) / f64::from(length)).collect();
        Self { angles, on }
    }
}

/// What a few repetitions of a path come to.
#[derive(Clone, Copy, Debug)]
struct Energy {
    /// Sum of `F d + alpha d^2/T` in J.
    sum: f64,
    /// Its largest part.
    largest: f64,
    /// Sum of all steps in rad, of the device and of the environment: where these are nearly the same, a
    /// torque that is off moves the environment.
    travel: f64,
}

impl Energy {
    /// Of some repetitions, after some others; `None` where the environment is not as far on as the device.
    fn of(knob: &mut impl Tick, path: &Path, index: f64) -> Option<Self> {
        const REPETITIONS: i32 = 4;
        let (mut before, mut device) = (path.angles[0], path.angles[0]);
        let mut run = |from: i32| {
            let mut out = Self { sum: 0.0, largest: 1e-12, travel: 0.0 };
            for repetition in from..from + REPETITIONS {
                for angle in &path.angles {
                    let angle = angle + f64::from(repetition) * path.on;
                    let (torque, inside) = knob.tick(angle);
                    let d = inside - before;
                    out.sum += torque * d + index / PERIOD * d * d;
                    out.largest = out.largest.max((torque * d).abs());
                    out.travel += d.abs() + (angle - device).abs();
                    (before, device) = (inside, angle);
                }
            }
            (out, before - f64::from(from + REPETITIONS) * path.on)
        };
        let ((_, from), (found, to), (again, _)) = (run(0), run(REPETITIONS), run(2 * REPETITIONS));
        let is_periodic = (to - from).abs() < 1e-6 * (from.abs() + path.on.abs())
            && (found.sum - again.sum).abs() < 1e-3 * found.largest;
        is_periodic.then_some(found)
    }

    fn relative(&self) -> f64 {
        self.sum / self.largest
    }
}

/// The least energy that a search by chance finds from a path, and where.
fn least_energy<T: Tick>(
    start: &dyn Fn() -> T,
    path: Path,
    width: f64,
    index: f64,
    random: &mut ChaCha8Rng,
) -> (Option<Energy>, Path) {
    let mut best = path;
    let mut least = Energy::of(&mut start(), &best, index);
    for attempt in 0..ATTEMPTS {
        let mut other = best.clone();
        let by = width * 0.97_f64.powi(attempt) * random.random_range(-1.0..1.0);
        let place = random.random_range(0..other.angles.len());
        other.angles[place] += by;
        let Some(found) = Energy::of(&mut start(), &other, index) else { continue };
        if least.is_none_or(|least| found.relative() < least.relative()) {
            (least, best) = (Some(found), other);
        }
    }
    (least, best)
}

fn runs(ordinary: usize) -> usize {
    std::env::var("SNAP_RUNS").map_or(ordinary, |runs| runs.parse().unwrap())
}

/// Where the coupling is so soft that it shows, and stiffer than the knob is steep.
fn damping(knob: &Knob, random: &mut ChaCha8Rng) -> f64 {
    0.5 * PERIOD * (knob.steepest() + knob.slope()) * random.random_range(1.02..3.0)
}

#[test]
fn no_sequence_of_positions_takes_more_energy_than_the_index_says() {
    let mut random = ChaCha8Rng::seed_from_u64(23);
    let (mut shown, mut all, mut found) = (0, 0, 0);
    let runs = runs(600);
    for _ in 0..runs {
        let knob = Knob::random(&mut random);
        let damping = damping(&knob, &mut random);
        let index = certified(&knob, damping).1;
        let start = || certified(&knob, damping).0;
        let is_turning = knob.ends.is_none() && random.random_bool(0.5);
        let (path, width) = if is_turning {
            (Path::turning(&knob, &mut random), 0.3 * knob.pitch())
        } else {
            let width = [0.3, 1.0, 3.0, 30.0][random.random_range(0..4)] * knob.pitch();
            (Path::there_and_back(&knob, width, &mut random), width)
        };
        let (least, path) = least_energy(&start, path, width, index, &mut random);
        let Some(least) = least else { continue };
        found += 1;
        let rounding = 2.0 * knob.torque_of_part() * least.travel;
        assert!(least.sum >= -rounding, "{least:?}, {rounding}: {knob:?} at {path:?}");
        if knob.delay == 1 {
            let is_shown = (0..8).any(|_| {
                let width = [0.01, 0.1, 0.3][random.random_range(0..3)] * knob.pitch();
                let path = Path::there_and_back(&knob, width, &mut random);
                let (less, _) = least_energy(&start, path, width, 0.9 * index, &mut random);
                less.is_some_and(|less| less.relative() < -1e-3)
            });
            (shown, all) = (shown + usize::from(is_shown), all + 1);
        }
    }
    assert!(10 * found >= 9 * runs, "{found} of {runs}");
    println!("shown to take more than 0.9 of the index: {shown} of {all}");
    assert!(3 * shown >= all, "{shown} of {all}");
}

/// Random walks, in steps from a part of a detent to many.
#[test]
fn what_runs_is_the_model() {
    let mut random = ChaCha8Rng::seed_from_u64(29);
    for _ in 0..runs(300) {
        let knob = Knob::random(&mut random);
        let damping = damping(&knob, &mut random);
        let mut firmware = certified(&knob, damping).0;
        let mut angle = 0.3 * knob.pitch();
        firmware.law.rest_at(angle);
        let mut model = Model::at_rest(&knob, firmware.compliance, angle);
        for tick in 0..300 {
            let step = 10_f64.powf(random.random_range(-2.0..1.3)) * knob.pitch();
            angle += random.random_range(-1.0..1.0) * step;
            // Back within a few turns, and to its ends.
            if angle.abs() > 12.0 || knob.ends.is_some_and(|[_, to, _]| (angle - to).abs() > 6.0) {
                angle = 0.0;
            }
            let branch = model.branch;
            let (found, expected) = (firmware.tick(angle), model.tick(angle));
            // Knots are rounded to units, and a torque that is off moves the environment.
            let unit =
                knob.base.iter().fold(1.0, |most: f64, torque| most.max(torque.abs())) / 16383.0;
            let allowed = 100.0 * (knob.torque_of_part() + unit);
            assert!(
                (found.0 - expected.0).abs() <= allowed,
                "tick {tick}: {found:?} {expected:?} {allowed} {knob:?}"
            );
            if knob.is_at_a_threshold(branch, expected.1) {
                firmware.law.rest_at(0.2 * knob.pitch() + knob.centre);
                model =
                    Model::at_rest(&knob, firmware.compliance, 0.2 * knob.pitch() + knob.centre);
            }
        }
    }
}

/// Behind the matched coupling, with every torque late by a part of a period; 0: the standard coupling.
fn behind(knob: &Knob, late: f64, damping: f64) -> Scene {
    let scene = knob.scene(damping);
    if late == 0.0 {
        return scene;
    }
    Scene { coupling: Coupling::Matched, latency: Latency::delayed(late * PERIOD), ..scene }
}

/// The least damping that is certified.
fn least_damping(knob: &Knob, late: f64) -> f64 {
    let passes = |damping: f64| {
        PassivityProblem::of(&behind(knob, late, damping)).is_ok_and(|posed| posed.is_certified())
    };
    let (mut low, mut high) = (1e-9, 1e3);
    assert!(passes(high), "{knob:?}");
    while high > (1.0 + 1e-9) * low {
        let middle = (low * high).sqrt();
        if passes(middle) { high = middle } else { low = middle }
    }
    high
}

fn hand(knob: &Knob, limit: f64, random: &mut ChaCha8Rng) -> Hand {
    let [from, to] =
        knob.ends.map_or([0.0, knob.pitch() * f64::from(knob.pitches)], |[from, to, _]| [from, to]);
    let speed = knob.pitch() / PERIOD * 10_f64.powf(random.random_range(-2.5..0.0));
    Hand {
        mass: 10_f64.powf(random.random_range(-1.5..1.0)) * limit * PERIOD,
        swing: if random.random_bool(0.2) { 0.0 } else { random.random_range(0.0..3.1) },
        grip: random.random_range(from..to),
        start: (random.random_range(from..to), speed),
    }
}

/// Whether the device goes on moving in this hand.
fn keeps_moving(knob: &Knob, late: f64, damping: f64, hand: &Hand) -> bool {
    let Hand { mass, swing, grip, start } = *hand;
    let spring = mass * (swing / PERIOD).powi(2);
    let at_first = Held::over(late * PERIOD, mass, damping, spring);
    let then = Held::over((1.0 - late) * PERIOD, mass, damping, spring);
    let compliance = PERIOD / (2.0 * damping);
    let pull = spring * grip;
    let (mut x, mut v) = start;
    let mut knob_behind = Model::at_rest(knob, compliance, x);
    let mut before = knob.clipped(knob_behind.due);
    // A hundredth of the damping is over: as many time constants as bring it to rest.
    let window = (4_000.0 * mass / (damping * PERIOD)) as usize + 2_000;
    for _ in 0..8 {
        let mut fastest = 0.0_f64;
        for _ in 0..window {
            // The part of the last torque that is still to come.
            let (torque, _) = knob_behind.tick(x - late * compliance * before);
            (x, v) = at_first.step(x, v, before - pull);
            (x, v) = then.step(x, v, torque - pull);
            before = torque;
            fastest = fastest.max(v.abs());
        }
        if fastest * PERIOD < 1e-6 * knob.pitch() {
            return false;
        }
    }
    true
}

/// With a hundredth of the damping to spare, behind the standard and the matched coupling.
#[test]
fn certified_knobs_come_to_rest() {
    let mut random = ChaCha8Rng::seed_from_u64(31);
    for _ in 0..runs(600).div_ceil(HANDS) {
        let knob = Knob::random(&mut random);
        let late = if random.random_bool(0.5) { 0.0 } else { random.random_range(0.05..0.95) };
        let limit = least_damping(&knob, late);
        for _ in 0..HANDS {
            let hand = hand(&knob, limit, &mut random);
            assert!(!keeps_moving(&knob, late, 1.01 * limit, &hand), "{late} {knob:?} in {hand:?}");
        }
    }
}
