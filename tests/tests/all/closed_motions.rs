//! Closed motions of nonlinear scenes, searched for energy: the servo's own law with its torque limit never gives
//! more than the bound on its index allows (theory, equations 31, 46, 47 and 61). And a mass that arrives at a wall
//! is met with no more torque than equation 28 says.
//!
//! `CLOSED_MOTIONS=3000 cargo test -p tests --test all closed_motions` searches longer.

use std::f64::consts::TAU;

use adversary::scenes::{Choice, Kind, RandomScene, draw};
use analysis::chain::Chain;
use analysis::device::Motion;
use analysis::simulation::{Experiment, Integration, simulate};
use analysis::worst_hand::{HandImpedance, plant};
use haptic_servo::certificate::PassivityProblem;
use haptic_servo::coupling::{Contact, Coupling, Response};
use haptic_servo::environment::{Discretize, Law};
use haptic_servo::scene::Scene;
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use tests::scenes::log_uniform;

/// Closed motions that are tried on each scene.
const MOTIONS: usize = 6;
/// Changes of a motion, of which those are kept that take more energy.
const CHANGES: usize = 150;
/// Ticks after which a canceller and a filter have forgotten how a motion began.
const SETTLED: usize = 60;
/// The slowest pole of a filter, which settles in so many ticks.
const SLOWEST: f64 = 0.7;
/// Part of a profile's table to which angles are rounded: a 64th of a turn in 16384 parts, or less.
const PART: f64 = TAU / 64.0 / 16384.0;

/// No latency and no missed updates: the index alone decides.
fn choice(kind: Kind) -> Choice {
    Choice { kind: Some(kind), latency: Some(false), worst_period: Some(false), ..Choice::ANY }
}

/// A scene with its bound in N m s/rad.
struct Bounded {
    scene: Scene,
    bound: f64,
    /// Angles in rad at which its torque is of interest, and between which it changes.
    centre: f64,
    pitch: f64,
    /// Torque in N m by which a profile is off.
    rounding: f64,
    /// Compliance in rad/(N m) between the angles of a motion and the environment: a profile that is not late sees
    /// the device.
    compliance: f64,
}

impl Bounded {
    fn of(drawn: &RandomScene) -> Option<Self> {
        let scene = drawn.scene;
        let bound = PassivityProblem::of(&scene).ok()?.bound()?.hi();
        let (wall, profile) = (scene.environment.wall(), scene.environment.profile());
        // It would not settle.
        if wall.is_some_and(|wall| wall.filter().is_some_and(|pole| pole > SLOWEST)) {
            return None;
        }
        let pitch = profile.map_or(drawn.size, |profile| TAU / profile.count / 8.0);
        let rounding = profile.map_or(0.0, |profile| adversary::norm::slope(profile) * PART);
        let centre = wall.map_or(0.0, |wall| wall.face());
        let compliance = match (scene.coupling, profile) {
            (Coupling::Spring { stiffness }, Some(profile)) if profile.delay == 0 => {
                1.0 / stiffness
            }
            _ => 0.0,
        };
        Some(Self { scene, bound, centre, pitch, rounding, compliance })
    }

    /// The index in N m s/rad without which a closed motion, of these angles in turn, takes energy.
    fn needed(&self, motion: &[f64]) -> f64 {
        let law = Discretize::<f64>::law(&self.scene.environment, &self.scene.context());
        let mut law = law.expect("a certified law");
        law.rest_at(motion[0]);
        let limit = self.scene.torque_limit.unwrap_or(f64::INFINITY);
        let mut before = motion[0];
        let mut turn = || {
            let (mut work, mut squares, mut travel) = (0.0, 0.0, 0.0);
            for &angle in motion {
                let torque = torque(&law.evaluate(angle)).clamp(-limit, limit);
                let inside = angle - self.compliance * torque;
                let step = inside - before;
                work += torque * step;
                squares += step * step;
                travel += step.abs();
                law.update(inside);
                before = inside;
            }
            (work, squares, travel)
        };
        for _ in 0..SETTLED.div_ceil(motion.len()) {
            turn();
        }
        let ((first, ..), (work, squares, travel)) = (turn(), turn());
        // Rounding moves smaller values, and a law that has not settled is not in a closed motion.
        let is_closed = (work - first).abs() <= 1e-9 * (work.abs() + self.bound * squares);
        if !is_closed || squares < (1e-4 * self.pitch).powi(2) {
            return f64::MIN;
        }
        -self.scene.timing.period * (work + 2.0 * self.rounding * travel) / squares
    }

    /// A closed motion that needs much: changed at random as long as that makes it need more. Slow ones, to
    /// which a canceller and a delay give the most, begin as a circle.
    fn worst(&self, rng: &mut ChaCha8Rng) -> f64 {
        let length = [2, 2, 3, 4, 6, 12, 24, 48][rng.random_range(0..8)];
        let size = self.pitch * log_uniform(rng, 1e-3, 1.0);
        let middle = self.centre + self.pitch * rng.random_range(-2.0..2.0);
        let phase = TAU / f64::from(length);
        let mut motion: Vec<f64> =
            (0..length).map(|i| middle + size * (phase * f64::from(i)).cos()).collect();
        let mut worst = self.needed(&motion);
        for change in 0..CHANGES {
            let before = motion.clone();
            match rng.random_range(0..4) {
                0 => {
                    // All of it moves to another place.
                    let by = self.pitch * log_uniform(rng, 1e-3, 1.0) * rng.random_range(-1.0..1.0);
                    motion.iter_mut().for_each(|angle| *angle += by);
                }
                1 => {
                    let (centre, by) = (motion[0], log_uniform(rng, 0.5, 2.0));
                    motion.iter_mut().for_each(|angle| *angle = centre + by * (*angle - centre));
                }
                _ => {
                    let which = rng.random_range(0..motion.len());
                    let size = size * 0.97_f64.powi(change as i32 % 100);
                    motion[which] += size * rng.random_range(-1.0..1.0);
                }
            }
            let found = self.needed(&motion);
            if found > worst { worst = found } else { motion = before }
        }
        worst
    }
}

/// The torque of a response in N m, where the environment is where it was evaluated.
fn torque(response: &Response<f64>) -> f64 {
    let pushes =
        |contact: &Contact<f64>| if contact.depth > 0.0 { contact.torque.max(0.0) } else { 0.0 };
    match response {
        Response::Held(torque) | Response::Line(torque) => *torque,
        Response::Wall(contact) => pushes(contact),
        Response::LineAndWall(line, contact) => line + pushes(contact),
    }
}

/// Of each kind so many, of which a bound of nine tenths would be broken in at least a quarter.
#[test]
fn no_closed_motion_takes_more_energy_than_the_bound_allows() {
    for kind in [Kind::Wall, Kind::FreeModeWall, Kind::Profile, Kind::Sum] {
        let rng = &mut ChaCha8Rng::seed_from_u64(23);
        let (mut judged, mut near) = (0, 0);
        while judged < tests::number("CLOSED_MOTIONS").unwrap_or(200) {
            let Some(drawn) = draw(rng, &choice(kind)) else { continue };
            // Without a torque limit, a wall on both sides is judged as a linear loop, by another bound.
            if kind == Kind::Wall && drawn.scene.torque_limit.is_none() {
                continue;
            }
            let Some(bounded) = Bounded::of(&drawn) else { continue };
            judged += 1;
            let worst = (0..MOTIONS).map(|_| bounded.worst(rng)).fold(f64::MIN, f64::max);
            let (bound, scene) = (bounded.bound, &bounded.scene);
            let error = 1e-9 * (bound + scene.device.passivity());
            assert!(worst <= bound + error, "{worst} of {bound}: {scene:?}");
            near += u64::from(worst > 0.9 * bound);
        }
        println!("{kind:?}: {near} of {judged} need more than 0.9 of their bound");
        assert!(4 * near > judged, "{kind:?}: {near} of {judged}");
    }
}

/// Half of the largest torque of equation 28 is reached.
#[test]
fn a_mass_that_arrives_at_a_wall_is_met_with_no_more_torque_than_its_energy_allows() {
    let rng = &mut ChaCha8Rng::seed_from_u64(28);
    let choice = Choice { bare: Some(true), ..choice(Kind::Wall) };
    let (mut met, mut largest) = (0, 0.0_f64);
    while met < 60 {
        let Some(RandomScene { mut scene, .. }) = draw(rng, &choice) else { continue };
        let wall = scene.environment.wall_mut().expect("a wall is drawn");
        *wall = wall.behind(0.0);
        scene.torque_limit = None;
        let Coupling::Spring { .. } = scene.coupling else { continue };
        if scene.certify().is_err() {
            continue;
        }
        met += 1;
        let (delta, period) = (scene.device.passivity(), scene.timing.period);
        scene.device.inertia = delta * period * log_uniform(rng, 0.3, 300.0);
        let chain = Chain::rigid(scene.device.inertia, scene.device.damping).expect("one mass");
        let experiment = Experiment {
            plant: plant(&chain, 1.0, &HandImpedance::default()),
            start: Motion { position: 0.0, velocity: 1.0 },
            samples: 500,
            ..Experiment::still(&scene)
        };
        let motion = simulate(&experiment, Integration::default()).expect("it runs");
        let most = motion.torque.iter().fold(0.0, |most: f64, torque| most.max(torque.abs()));
        let allowed = (2.0 * scene.device.inertia * delta / period).sqrt();
        assert!(most <= allowed * (1.0 + 1e-9), "{most} of {allowed}: {scene:?}");
        largest = largest.max(most / allowed);
    }
    assert!(largest > 0.5, "{largest}");
}
