//! The search finds a fault where there is one.

use std::f64::consts::PI;

use adversary::mode::Actual;
use adversary::normalized_scene::NormalizedScene;
use adversary::plan::{Jitter, Pattern, Plan, REQUESTS};
use adversary::refuted_scenes::{self, RefutedScene};
use adversary::run::{Machine, Outcome};
use adversary::scenes::{Choice, Kind, Mode, Numbers, RandomScene};
use adversary::search::{Effort, Search, Task, booted};
use haptic_servo::environment::{Environment, Wall};
use haptic_servo::number::Number;
use haptic_servo::scene::{Coupling, Device, Latency, Scene, Timing};
use haptic_servo::servo::{OutputMode, SupportsTiming};
use haptic_servo::tuning::Tunable;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use tests::hands::Hand;

/// Runs one plan.
struct Once {
    plan: Plan,
}

impl Task for Once {
    type Result = Outcome;

    fn with<N: Number, M: OutputMode>(
        self,
        machine: Machine<N, M>,
        normalized: NormalizedScene,
    ) -> Outcome
    where
        Environment: Tunable<N> + SupportsTiming<M>,
    {
        machine.run(&normalized, &self.plan, true)
    }
}

/// The wall of the README.
const WALL: Wall = Wall::damped(22.0, 0.01, 1);

fn readme(wall: Wall, torque_limit: Option<f64>) -> Scene {
    Scene {
        device: Device { inertia: 2.2e-5, damping: 0.022, passivity: None },
        timing: Timing { period: 0.001, worst_period: None },
        coupling: Coupling::Spring { stiffness: 44.0 },
        environment: wall.alone(),
        latency: Latency::NONE,
        torque_limit,
    }
}

/// A finger that is a spring, on a device of 2.2e-5 kg m^2 that starts 10 degrees from where that
/// spring is at rest, which is a little inside of a wall at the servo's zero.
fn springy(stiffness: f64) -> Plan {
    // In units of the device's damping and the period.
    let (damping, period) = (0.022, 0.001);
    let (unit, inertia) = (damping / period, 2.2e-5 / (damping * period));
    let hand = Hand { inertia, damping: 0.05, stiffness: stiffness / unit, segments: Vec::new() };
    let mut start = [0.0; 8];
    start[0] = PI / 18.0;
    Plan {
        hand,
        zero: -0.03,
        start,
        armed_by_boot: true,
        pattern: Pattern::AllOnTime,
        delay: 0.0,
        jitter: Jitter::default(),
        within: [0.0; 2],
        requests: [None; REQUESTS],
        heats: false,
        again: false,
        periods: 65_536,
    }
}

/// A servo computes a torque from positions that are a whole sample old, and counts on the motor
/// having it no sooner: near the line the loop of coupling and environment has a pole near -1, which
/// only a whole sample makes passive. Put out 5 microseconds after its count, where it was certified
/// for the next one, the same torque makes the loop need twenty times the damping that the device
/// has. That an earlier torque is a better one holds of a wall alone, not of one behind a coupling.
#[test]
fn a_torque_that_comes_early_shakes_a_springy_finger() {
    for (wall, torque_limit) in [(WALL, None), (WALL, Some(1.0)), (WALL.behind(0.0), Some(1.0))] {
        let scene = readme(wall, torque_limit);
        let mut drawn = RandomScene::of(Kind::Wall, scene, Numbers::F32, Mode::Latched, 0.1);
        // The device is as it was declared.
        drawn.taken = 0.0;
        let mut shakes = 0;
        for stiffness in [20.0, 35.0, 60.0, 100.0, 150.0, 205.0] {
            let plan = springy(stiffness);
            let run = |delay| {
                let actual = Actual { delay, ..Actual::default() };
                let drawn = RandomScene { actual, ..drawn.clone() };
                booted(&drawn, Once { plan: plan.clone() }).unwrap()
            };
            let (early, latched) = (run(Some(0.005)), run(None));
            assert!(!latched.is_violation(), "{stiffness} N m/rad, as certified: {latched:?}");
            shakes += u32::from(early.score > 0.0);
            println!("{stiffness} N m/rad: {:.3e}, latched {:.3e}", early.score, latched.score);
        }
        assert!(shakes > 0, "{wall:?}, limit {torque_limit:?}: nothing shook");
    }
}

/// A device with a twentieth less damping than its scene needs, by the certificate's own account,
/// gives energy away: the certificate does not ask for more than it must.
#[test]
fn a_device_with_less_damping_than_its_scene_needs_gives_energy_away() {
    // Of how many scenes at least it finds that, in a hundred: the hand that takes the least is
    // harder to find the more poles there are.
    let kinds =
        [(Kind::Wall, 20), (Kind::FreeMode, 10), (Kind::FreeModeWall, 15), (Kind::Rational, 2)];
    for (kind, percent) in kinds {
        let search = Search {
            seed: 2,
            scenes: 400,
            time: None,
            choice: Choice {
                kind: Some(kind),
                worst_period: Some(false),
                latency: Some(false),
                // No board renders a rational environment.
                bare: Some(kind == Kind::Rational),
                weakened: Some(0.95),
                saturates: false,
                ..Choice::ANY
            },
            enough: usize::MAX,
            effort: Effort::USUAL,
        };
        let found = search.run();
        println!("{kind}: {found} counterexamples={}", found.counterexamples.len());
        assert!(found.accepted > 0, "{kind}");
        assert!(found.counterexamples.len() as u64 * 100 >= found.accepted * percent, "{kind}");
    }
}

/// What becomes of a scene that shook once: refused, or not to be shaken.
fn judge(refuted: &RefutedScene, format: Numbers, mode: Mode) -> Result<&'static str, String> {
    let scene = refuted.scene;
    let search = Search {
        seed: 3,
        scenes: 1,
        time: None,
        choice: Choice::ANY,
        enough: 1,
        effort: Effort { drawn: 200, climbed: 200, ..Effort::USUAL },
    };
    // Against the torque of a DAC that saturates rarely, sometimes and nearly always.
    for full_scale in [4.0, 1.0, 20.0] {
        let mut drawn = RandomScene::of(Kind::Wall, scene, format, mode, 0.1);
        drawn.judged_as = refuted.judged_as;
        if scene.torque_limit.is_none() {
            drawn.transducers.full_scale_torque *= 0.25 * full_scale;
        }
        let found = search.climb(0, &drawn, ChaCha8Rng::seed_from_u64(search.seed));
        match (found.accepted, found.counterexamples.first()) {
            (0, _) if found.unbounded > 0 => return Err("cannot be judged".to_owned()),
            (0, _) => return Ok("refused"),
            (_, None) => {}
            (_, Some(counterexample)) => return Err(counterexample.to_string()),
        }
    }
    Ok("comes to rest")
}

#[test]
fn scenes_that_shook_once_are_refused_or_come_to_rest() {
    let mut shook = Vec::new();
    for refuted in refuted_scenes::all() {
        for format in [Numbers::F32, Numbers::F64, Numbers::Q24] {
            for mode in [Mode::Simultaneous, Mode::Latched, Mode::Bare] {
                let judged = judge(&refuted, format, mode);
                let text = judged.as_ref().map_or("SHAKES", |text| text);
                println!("{}, {format:?}, {}: {text}", refuted.name, mode.name());
                shook.extend(judged.err().map(|why| format!("{}: {why}", refuted.name)));
            }
        }
    }
    assert!(shook.is_empty(), "{} of them shake:\n{}", shook.len(), shook.join("\n\n"));
}
