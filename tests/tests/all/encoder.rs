//! Closed motions of springs that an encoder reads, searched for energy: with readings of any age in the scene's
//! range, dropped ones, and through an angle's error of the scene's slope, none takes more than the index allows
//! (theory, section 18). An index without the age, or without the nonlinearity, is found out.

use std::f64::consts::{PI, TAU};

use haptic_servo::certificate::assess;
use haptic_servo::environment::{Knots, Parts, Profile, Shape, Wall};
use haptic_servo::scene::{Coupling, Device, EncoderReading, Latency, Scene, TimeRange};
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;

const SCENES: usize = 150;
const MOTIONS: usize = 3;
const CHANGES: usize = 300;

/// The scene of a spring with the period 1 s and the passivity 1 N m s/rad.
fn draw(rng: &mut ChaCha8Rng) -> Scene {
    let [mut least, mut most] = [0; 2].map(|_| rng.random_range(0.0..1.5));
    if most < least {
        (least, most) = (most, least);
    }
    let encoder = EncoderReading {
        age: TimeRange::between(least, most.max(0.3)),
        linearity: rng.random_range(0.1..0.4),
        dropped: rng.random_range(0..2),
        ..EncoderReading::IDEAL
    };
    let stiffness = rng.random_range(0.1..1.0);
    let spring = Wall::spring(stiffness, rng.random_range(1..3));
    let is_one_sided = rng.random();
    Scene {
        latency: Latency::NONE.read_by(Box::leak(Box::new(encoder))),
        torque_limit: rng.random::<bool>().then_some(0.02 * stiffness),
        ..Scene::of(
            Device::damped(1.0, 1.0),
            1.0,
            if is_one_sided { spring.behind(0.0) } else { spring }.alone(),
        )
    }
}

/// The index in N m s/rad of a scene of this encoder.
fn index(scene: &Scene, encoder: EncoderReading) -> f64 {
    let read = Scene { latency: Latency::NONE.read_by(Box::leak(Box::new(encoder))), ..*scene };
    assess(&read).bound.expect("it is static").hi()
}

/// A closed motion: a position at each node, and the age of the reading of each tick.
#[derive(Clone)]
struct Motion {
    positions: Vec<f64>,
    ages: Vec<usize>,
}

/// How a scene reads a motion, with nodes where a torque may begin or a position be read.
struct Reader<'s> {
    scene: &'s Scene,
    /// Times of the nodes of a tick, from 0 on.
    nodes: Vec<f64>,
    /// Ages of a reading in nodes before the torque's begin.
    ages: Vec<usize>,
    /// Periods of the angle's error in a turn, and its phase.
    error: (f64, f64),
}

impl<'s> Reader<'s> {
    fn new(scene: &'s Scene, error: (f64, f64)) -> Self {
        let EncoderReading { age, dropped, .. } = *scene.latency.encoder;
        let late = scene.environment.delay() as f64;
        let oldest = [age.least, age.most, age.most + f64::from(dropped)].map(|age| age + late);
        let time_in_tick = |age: f64| (-age).rem_euclid(1.0);
        let mut nodes = vec![0.0];
        nodes.extend(oldest.map(time_in_tick));
        nodes.sort_by(f64::total_cmp);
        nodes.dedup_by(|a, b| (*a - *b).abs() < 1e-9);
        let before = |age: f64| {
            let node = nodes.iter().position(|node| (node - time_in_tick(age)).abs() < 1e-9);
            age.ceil() as usize * nodes.len() - node.expect("it is a node")
        };
        let ages = oldest.map(before).to_vec();
        Self { scene, nodes, ages, error }
    }

    /// The torque of a reading at a position.
    fn torque(&self, position: f64) -> f64 {
        let eta = self.scene.latency.encoder.linearity;
        let (periods, phase) = self.error;
        let angle = position + eta / periods * (periods * position + phase).sin();
        let wall = self.scene.environment.wall().expect("a spring");
        let depth = if wall.is_one_sided() { angle.max(0.0) } else { angle };
        let limit = self.scene.torque_limit.unwrap_or(f64::INFINITY);
        (wall.stiffness * depth).clamp(-limit, limit)
    }

    /// The passivity in N m s/rad without which the motion takes energy.
    fn needed(&self, Motion { positions, ages }: &Motion) -> f64 {
        let (per_tick, count) = (self.nodes.len(), positions.len());
        let position = |node: usize| positions[node % count];
        let squares: f64 = (0..count)
            .map(|node| {
                let end = self.nodes.get(node % per_tick + 1).copied().unwrap_or(1.0);
                (position(node + 1) - position(node)).powi(2) / (end - self.nodes[node % per_tick])
            })
            .sum();
        let work: f64 = ages
            .iter()
            .enumerate()
            .map(|(tick, age)| {
                let begin = tick * per_tick;
                let read = position(begin + 8 * count - self.ages[*age]);
                self.torque(read) * (position(begin + per_tick) - position(begin))
            })
            .sum();
        if squares < 1e-12 { f64::MIN } else { -work / squares }
    }

    /// A motion that needs much: a slow circle with the oldest readings, changed as long as it needs more.
    fn worst(&self, rng: &mut ChaCha8Rng) -> f64 {
        let (ticks, per_tick) = ([4, 12, 60][rng.random_range(0..3)], self.nodes.len());
        let (size, centre) = (0.01, [0.0, 0.011][rng.random_range(0..2)]);
        let angle = |node: usize| {
            let time = (node / per_tick) as f64 + self.nodes[node % per_tick];
            centre + size * (TAU * time / f64::from(ticks)).cos()
        };
        let mut motion = Motion {
            positions: (0..ticks as usize * per_tick).map(angle).collect(),
            ages: vec![self.ages.len() - 1; ticks as usize],
        };
        let mut worst = self.needed(&motion);
        for change in 0..CHANGES {
            let before = motion.clone();
            let node = rng.random_range(0..motion.positions.len());
            motion.positions[node] +=
                size * 0.98_f64.powi(change as i32) * rng.random_range(-1.0..1.0);
            if rng.random_range(0..8) == 0 {
                let tick = rng.random_range(0..motion.ages.len());
                motion.ages[tick] = rng.random_range(0..self.ages.len());
            }
            let found = self.needed(&motion);
            if found > worst { worst = found } else { motion = before }
        }
        worst
    }
}

#[test]
fn no_reading_of_a_closed_motion_takes_more_energy_than_the_index_allows() {
    let rng = &mut ChaCha8Rng::seed_from_u64(37);
    let (mut near, mut without_age, mut without_inl) = (0, 0, 0);
    for _ in 0..SCENES {
        let scene = draw(rng);
        let encoder = *scene.latency.encoder;
        // Most errors are the steepest at 0, where the motions are.
        let phase = [0.0, rng.random_range(0.0..TAU)][rng.random_range(0..2)];
        let reader = Reader::new(&scene, (f64::from(rng.random_range(1..4)), phase));
        let worst = (0..MOTIONS).map(|_| reader.worst(rng)).fold(f64::MIN, f64::max);
        let bound = index(&scene, encoder);
        assert!(worst <= bound * (1.0 + 1e-9), "{worst} of {bound}: {scene:?}");
        near += usize::from(worst > 0.95 * bound);
        let young = EncoderReading { age: TimeRange::ZERO, dropped: 0, ..encoder };
        without_age += usize::from(worst > index(&scene, young));
        without_inl +=
            usize::from(worst > index(&scene, EncoderReading { linearity: 0.0, ..encoder }));
    }
    println!(
        "{near} near, {without_age} without age, {without_inl} without nonlinearity of {SCENES}"
    );
    assert!(8 * near > SCENES, "{near}");
    assert!(4 * without_age > SCENES && 6 * without_inl > SCENES, "{without_age} {without_inl}");
}

/// The mean of a detent's torque through random errors of the angle, beside the bound of equation 68.
#[test]
fn the_mean_torque_of_an_endless_profile_is_within_its_bound() {
    let rng = &mut ChaCha8Rng::seed_from_u64(68);
    let mut largest = 0.0_f64;
    for _ in 0..400 {
        let detents = f64::from(rng.random_range(1..5));
        // Triangles of slope `M` with the largest torque 1.
        let torque = |angle: f64| (detents * angle).sin().asin() * 2.0 / PI;
        let slope = detents * 2.0 / PI;
        let harmonics: Vec<_> = (1..5)
            .map(|harmonic| {
                (f64::from(harmonic), rng.random_range(0.0..0.1), rng.random_range(0.0..TAU))
            })
            .collect();
        let eta: f64 = harmonics.iter().map(|(_, slope, _)| slope).sum();
        let error = |angle: f64| -> f64 {
            harmonics.iter().map(|(n, slope, phase)| slope / n * (n * angle + phase).sin()).sum()
        };
        let count = 4096;
        let sum: f64 = (0..count)
            .map(|i| TAU * f64::from(i) / f64::from(count))
            .map(|angle| torque(angle + error(angle)))
            .sum();
        let mean = (sum / f64::from(count)).abs();
        let bound = (slope * eta * PI / 4.0).min(eta / (1.0 - eta));
        assert!(mean <= bound, "{mean} {bound}");
        largest = largest.max(mean / bound);
    }
    assert!(largest > 0.1, "{largest}");
}

static KNOB: Knots<64> = Knots::of(&[Shape::detents(6, 0.02), Shape::end_stops(-1.0, 1.5, 0.1)]);
static SKEWED: EncoderReading = EncoderReading { linearity: 0.02, ..EncoderReading::IDEAL };

/// A coupling in front of a wall that is not late is a static law with it; a late part beside the wall is a memory,
/// which lets the device oscillate behind such an encoder.
#[test]
fn parts_behind_a_coupling_are_a_static_law_if_none_is_late() {
    let late = Profile::of(&KNOB, 1);
    for profile in [None, Some(late)] {
        let wall = Some(Wall::spring(0.01, 0).behind(0.0));
        let scene = Scene {
            latency: Latency::NONE.read_by(&SKEWED),
            coupling: Coupling::Spring { stiffness: 0.2 },
            torque_limit: Some(0.3),
            ..Scene::of(Device::damped(1.0, 1.0), 1.0, Parts { wall, profile, ..Parts::NONE }.sum())
        };
        let refused = scene.certify().err().map(|refused| refused.to_string());
        assert_eq!(refused.is_some(), profile.is_some(), "{refused:?}");
    }
}
