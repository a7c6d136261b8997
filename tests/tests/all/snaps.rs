//! Detents with a snap point, against a model of their own in this file: the inequality of the index on
//! sequences of positions that are searched for to break it, and random passive hands.
//!
//! `SNAP_RUNS=100000 cargo test -p tests --test all snaps` searches longer.

use firmware::certificate::PassivityProblem;
use firmware::coupling::Response;
use firmware::environment::{AnyProfile, Discretize, Environment, Law, Shape};
use firmware::scene::{Coupling, Device, Latency, Scene, Timing};
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

    /// The steepest rise of all in N m/rad.
    fn rise(&self) -> f64 {
        let cell = std::f64::consts::TAU / f64::from(self.count) / KNOTS as f64;
        let next = |i: usize| (self.base[(i + 1) % KNOTS] - self.base[i]) / cell;
        let steepest = (0..KNOTS).map(next).fold(0.0, f64::max);
        steepest.max(self.ends.map_or(0.0, |[.., stiffness]| stiffness)) + self.slope()
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

    fn profile(&self) -> AnyProfile {
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
        AnyProfile::sampled(&shapes, vec![0; CELLS].leak(), self.delay).unwrap()
    }

    fn scene(&self, damping: f64) -> Scene {
        Scene {
            device: Device { inertia: 1e-5, damping, passivity: None },
            timing: Timing { period: PERIOD, worst_period: None },
            coupling: Coupling::Spring { stiffness: 2.0 * damping / PERIOD },
            environment: Environment::Profile(self.profile()),
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

/// What the sum of `F d + alpha d^2/T` comes to over a few repetitions of these angles of the device, after
/// some others, over its largest part; `None` where the environment does not come back to where it was.
fn energy(knob: &mut impl Tick, angles: &[f64], index: f64) -> Option<f64> {
    let run = |knob: &mut dyn FnMut(f64) -> (f64, f64), from: f64, cycles: usize| {
        let (mut before, mut sum, mut largest) = (from, 0.0, 0.0_f64);
        for _ in 0..cycles {
            for &angle in angles {
                let (torque, inside) = knob(angle);
                let d = inside - before;
                sum += torque * d + index / PERIOD * d * d;
                largest = largest.max((torque * d).abs());
                before = inside;
            }
        }
        (sum, largest, before)
    };
    let mut tick = |angle: f64| knob.tick(angle);
    let (_, _, from) = run(&mut tick, angles[0], 4);
    let (sum, largest, to) = run(&mut tick, from, 4);
    let (again, ..) = run(&mut tick, to, 4);
    let scale = largest.max(1e-12);
    let repeats = (to - from).abs() < 1e-9 && (sum - again).abs() < 1e-6 * scale;
    repeats.then_some(sum / scale)
}

/// Angles of the device, some of them far away, that take the least energy that a search by chance finds.
fn least_energy<T: Tick>(
    knob: &Knob,
    start: &dyn Fn() -> T,
    index: f64,
    random: &mut ChaCha8Rng,
) -> (f64, Vec<f64>) {
    let pitch = knob.pitch();
    let middle = knob.ends.map_or(0.0, |[from, to, _]| 0.5 * (from + to));
    let width = [0.3, 1.0, 3.0, 30.0][random.random_range(0..4)] * pitch;
    let length = random.random_range(2..7);
    let mut angles: Vec<f64> =
        (0..length).map(|_| middle + random.random_range(-1.0..1.0) * width).collect();
    let mut least = energy(&mut start(), &angles, index).unwrap_or(f64::INFINITY);
    for attempt in 0..120 {
        let mut other = angles.clone();
        let by = width * 0.96_f64.powi(attempt) * random.random_range(-1.0..1.0);
        let place = random.random_range(0..length);
        other[place] += by;
        let found = energy(&mut start(), &other, index).unwrap_or(f64::INFINITY);
        if found < least {
            (least, angles) = (found, other);
        }
    }
    (least, angles)
}

fn runs(ordinary: usize) -> usize {
    std::env::var("SNAP_RUNS").map_or(ordinary, |runs| runs.parse().unwrap())
}

/// Where the coupling is so soft that it shows, and stiffer than the knob is steep.
fn damping(knob: &Knob, random: &mut ChaCha8Rng) -> f64 {
    0.5 * PERIOD * knob.rise() * random.random_range(1.02..3.0)
}

#[test]
fn no_sequence_of_positions_takes_more_energy_than_the_index_says() {
    let mut random = ChaCha8Rng::seed_from_u64(23);
    let (mut shown, mut all) = (0, 0);
    for _ in 0..runs(300) {
        let knob = Knob::random(&mut random);
        let damping = damping(&knob, &mut random);
        let index = certified(&knob, damping).1;
        let start = || certified(&knob, damping).0;
        let (least, angles) = least_energy(&knob, &start, index, &mut random);
        // Places in whole parts of a cell.
        assert!(least >= -1e-4, "{least}: {knob:?} at {angles:?}");
        if knob.delay == 1 {
            let (less, _) = least_energy(&knob, &start, 0.9 * index, &mut random);
            (shown, all) = (shown + usize::from(less < -1e-3), all + 1);
        }
    }
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
        let part = knob.rise() * knob.pitch() / 65536.0 * f64::from(knob.pitches);
        for tick in 0..300 {
            let step = 10_f64.powf(random.random_range(-2.0..1.3)) * knob.pitch();
            angle += random.random_range(-1.0..1.0) * step;
            // Back within a few turns, and to its ends.
            if angle.abs() > 12.0 || knob.ends.is_some_and(|[_, to, _]| (angle - to).abs() > 6.0) {
                angle = 0.0;
            }
            let (found, expected) = (firmware.tick(angle), model.tick(angle));
            let allowed = 8.0 * part + 2e-4 * (1.0 + knob.slope() * expected.1.abs() * 1e-3);
            assert!(
                (found.0 - expected.0).abs() <= allowed,
                "tick {tick}: {found:?} {expected:?} {allowed} {knob:?}"
            );
        }
    }
}
