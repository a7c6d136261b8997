//! A certified scene is a stable loop, and a stable loop a motion that ends: scene files with every
//! environment and coupling through the certificate, the eigenvalues and the simulation.
//!
//! A certificate that believed a number of the file that the device does not have would be caught by the
//! first step, and a simulation of another scene than the judged scene by the second.

use analysis::chain::{Chain, Link, Mass};
use analysis::file::simulation::{HandTorque, Simulation};
use analysis::file::{Format, Purpose, SceneFile, parse, parse_for, write};
use analysis::missed::Missed;
use analysis::simulation::{Experiment, Integration, Trajectory, simulate};
use analysis::stability::{StabilityVerdict, judge};
use analysis::verdict;
use haptic_servo::certificate::LoopTransfers;
use haptic_servo::environment::{Environment, Parts, Wall};
use haptic_servo::scene::{Coupling, Scene};
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use tests::scenes::{self, Poles, log_uniform, short};

const SCENES: u64 = 4_000;
const SAMPLES: usize = 4_000;

/// A scene of any environment and coupling, some one-sided or limited, with a longest period, a
/// passivity that may exceed the damping, or a chain for a device.
pub(super) fn drawn(rng: &mut ChaCha8Rng) -> SceneFile {
    let mut scene = match rng.random_range(0..5) {
        0 | 1 => scenes::wall(rng),
        2 | 3 => scenes::free(rng),
        _ => scenes::rational(rng, Poles { count: 3, nearest: 0.02, delay: 2 }),
    }
    .scene;
    let (damping, period) = (scene.device.damping, scene.timing.period);
    // It loses its speed in that many ticks, and swings several times before the end.
    scene.device.inertia = damping * period * log_uniform(rng, 3.0, 100.0);
    if rng.random_bool(0.3) {
        scene.torque_limit = Some(0.1);
        scene.coupling = Coupling::Spring { stiffness: short(2.0 * damping / period, 20) };
    }
    if let Some(wall) = scene.environment.wall_mut()
        && wall.damper.is_some()
        && rng.random_bool(0.3)
    {
        *wall = wall.behind(0.0);
    }
    if rng.random_bool(0.1) {
        scene.timing.worst_period = Some(1.25 * period);
    }
    if rng.random_bool(0.4) {
        scene.device.passivity = Some(damping * log_uniform(rng, 0.5, 20.0));
    }
    let mut chain = Chain::rigid(scene.device.inertia, damping).expect("one mass");
    if rng.random_bool(0.1) {
        let parts = [0.7, 0.3].map(|part| (part * scene.device.inertia, part * damping));
        let masses = parts.map(|(inertia, damping)| Mass { inertia, damping });
        let link = Link { stiffness: 0.1 * damping / period, damping: 0.2 * damping };
        chain = Chain::new(masses.to_vec(), vec![link]).expect("two masses");
        scene.device.passivity = None;
    }
    let simulation = Simulation {
        samples: SAMPLES,
        position: 0.01,
        velocity: 1.0,
        torque: HandTorque::Free,
        friction: 0.0,
        latency: 0.0,
        missed: Missed::None,
    };
    SceneFile {
        name: "drawn".to_owned(),
        scene,
        chain,
        simulation: Some(simulation),
        hand: None,
        encoder_step: None,
        full_scale: None,
        friction: None,
        supply: None,
        shapes: None,
    }
}

/// Whether nothing pulls a device anywhere that is displaced and at rest: the only certified loops
/// that are not asymptotically stable are these, and theirs is the eigenvalue 1 of the position.
pub(super) fn stays_anywhere(scene: &Scene) -> bool {
    match scene.environment {
        Environment::Parts(Parts { wall, profile: None, .. }) => {
            wall.is_none_or(|wall| wall.stiffness == 0.0)
        }
        Environment::Rational(rational) => rational.unit_zeros > 0,
        Environment::Parts(_) | Environment::Stated(_) => false,
    }
}

/// Largest magnitude among some samples.
pub(super) fn largest(samples: &[f64]) -> f64 {
    samples.iter().fold(0.0, |largest: f64, sample| largest.max(sample.abs()))
}

/// Whether there is a number for every sample, and neither speed nor torque is larger after half of
/// the time than before it, as they are in a motion that grows.
fn is_bounded(scene: &Scene, motion: &Trajectory) -> bool {
    /// What samples see of two swings that are equal.
    const SAMPLED: f64 = 1.05;
    /// Speed in rad/s of what has come to rest, but for rounding.
    const STILL: f64 = 1e-9;
    let rests = |samples: &[f64], still: f64| {
        let (before, after) = samples.split_at(SAMPLES / 2);
        largest(after) <= SAMPLED * largest(before) + still
    };
    motion.samples() == SAMPLES
        && rests(&motion.velocity, STILL)
        && rests(&motion.torque, STILL * scene.device.damping)
}

#[test]
fn a_certified_scene_is_stable_and_its_motion_ends() {
    let (mut certified, mut marginal, mut refused, mut grew, mut passive) = ([0; 5], 0, 0, 0, 0);
    for seed in 0..SCENES {
        let file = drawn(&mut ChaCha8Rng::seed_from_u64(seed));
        let text = write::toml(&file);
        let read = parse("drawn.toml", Format::Toml, &text);
        let device = file.scene.device;
        if device.passivity.is_some_and(|passivity| passivity > device.damping) {
            let refusal = read.expect_err("no device has more passivity than damping").to_string();
            assert!(refusal.contains("`device.passivity`"), "seed {seed}: {refusal}");
            let report = verdict::judge("drawn", &file.scene);
            assert_ne!(report.verdict, verdict::Verdict::Certified, "seed {seed}: {text}");
            passive += 1;
            continue;
        }
        let file = read.unwrap_or_else(|error| panic!("seed {seed}: {error}\n{text}"));
        assert_eq!(Ok(&file), parse_for(Purpose::Simulate, "", Format::Toml, &text).as_ref());
        let experiment = Experiment::of(&file, ".".as_ref()).expect("no other file is read");
        let (scene, integration) = (&file.scene, Integration::default());
        if verdict::judge("drawn", scene).verdict != verdict::Verdict::Certified {
            refused += 1;
            let motion = simulate(&experiment, integration);
            grew += u32::from(!motion.is_ok_and(|motion| is_bounded(scene, &motion)));
            continue;
        }
        let stability =
            judge(&experiment, integration).unwrap_or_else(|why| panic!("{seed}: {why}"));
        match stability.verdict {
            StabilityVerdict::Stable => {}
            StabilityVerdict::Marginal if stays_anywhere(scene) => marginal += 1,
            _ => panic!("seed {seed}: certified, and {stability:?}\n{text}"),
        }
        let motion =
            simulate(&experiment, integration).unwrap_or_else(|why| panic!("{seed}: {why}"));
        assert!(is_bounded(scene, &motion), "seed {seed}: certified, and moves on\n{text}");
        assert!(LoopTransfers::of(scene).is_ok(), "seed {seed}");
        certified[match (scene.environment.canceller(), scene.environment.wall()) {
            (None, Some(Wall { damper: None, .. })) => 0,
            (None, Some(_)) => 1,
            (Some(_), None) => 2,
            (Some(_), Some(_)) => 3,
            (None, None) => 4,
        }] += 1;
    }
    println!(
        "certified={certified:?} marginal={marginal} refused={refused} of them grew={grew} \
         passive={passive}"
    );
    assert!(certified.iter().all(|&count| count > 100), "{certified:?}");
    assert!(marginal > 50 && grew > 300 && passive > 500, "{marginal} {grew} {passive}");
}
