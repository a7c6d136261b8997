//! Measured cost of a certificate, a step and a tick, beside a budget or beside a peer of the same run.
//!
//! A row of the table is a `figure::Figure`: `new` for a budget, `beside` for a peer, which needs a
//! `figure::Pair` that measures both.

pub mod at_rest;
pub(crate) mod encoder;
pub(crate) mod figure;
pub mod on_target;
mod peer;
pub(crate) mod python;
pub(crate) mod steps;

use std::hint::black_box;
use std::path::Path;
use std::process::Command;
use std::time::Instant;

use self::figure::{median, seconds};
use crate::latency_limits::{lag_of, largest_spring};
use crate::stability_map::{Family, Map, MapError};
use crate::studies::failures::setting::{PADDLE, PERIOD, rational, rigid};
use crate::studies::tradeoff::certificate::environments::multiply;
use haptic_servo::certificate::{PassivityProblem, assess};
use haptic_servo::environment::{Environment, Rational, Wall};
use haptic_servo::scene::{Coupling, Latency, Scene};

/// Instructions per second of a board's core: 170 MHz, at one cycle per instruction.
pub const CORE_CLOCK: f64 = 170e6;

/// The numbers of repetitions of the measurements on this machine, whose median is the figure.
#[derive(Clone, Copy, Debug)]
pub struct Rounds {
    /// For a time here, or in turns with plain C.
    pub own: usize,
    /// In turns with Python.
    pub python: usize,
    /// For a map.
    pub maps: usize,
    /// Compilations of each program.
    pub compilations: usize,
}

impl Rounds {
    /// For repeatable figures.
    pub const THOROUGH: Self = Self { own: 31, python: 9, maps: 5, compilations: 15 };
    /// For their order of magnitude.
    pub const QUICK: Self = Self { own: 3, python: 1, maps: 1, compilations: 1 };
}

/// Environments to judge: low and high degrees, poles near and far, delays. The coefficients are products of
/// pole pairs, so that the degree determines the amount of work.
pub fn scenes() -> Vec<Scene> {
    let mut scenes = Vec::new();
    for degree in 0..=8 {
        for (radius, delay) in [(0.0, 0), (0.3, 1), (0.7, 2), (0.95, 1), (0.99, 4)] {
            let denominator = (0..degree).fold(vec![1.0], |product, pole| {
                let sign = if pole % 2 == 0 { 1.0 } else { -1.0 };
                multiply(&product, &[1.0, -sign * radius * (1.0 - 0.05 * f64::from(pole))])
            });
            let numerator = denominator.iter().rev().map(|value| 3.0 * value).collect::<Vec<_>>();
            let environment = Rational { delay, ..rational(&numerator, &denominator) };
            scenes.push(Scene {
                coupling: Coupling::Spring { stiffness: 44.0 },
                ..rigid(PADDLE, Environment::Rational(environment))
            });
        }
    }
    scenes
}

/// Cells along a side of the measured map.
const MAP_SIDE: usize = 300;

/// Walls per second in a map of a scene's walls on all cores: both rules, and stability without a hand if
/// neither certifies. The scene is rigid in its device, as [`scenes`] are.
pub fn map_rate(scene: &Scene, rounds: usize) -> Result<f64, MapError> {
    let family = Family::rigid("the scene that is measured", scene)?;
    let (stiffness, damping) = family.usual_ranges();
    let time = median_time(rounds, || {
        black_box(Map::new(&family, stiffness.clone(), damping.clone(), MAP_SIDE, || {}));
    });
    Ok((MAP_SIDE * MAP_SIDE) as f64 / time)
}

/// Median time of some work in s. The first round fills caches and starts threads, and is discarded.
pub(super) fn median_time(rounds: usize, mut work: impl FnMut()) -> f64 {
    work();
    median((0..rounds).map(|_| seconds(&mut work)).collect())
}

/// Judges all scenes, for its time.
fn judge(scenes: &[Scene]) {
    scenes.iter().for_each(|scene| _ = black_box(assess(black_box(scene))));
}

/// Median time of one verdict on one core of this machine in microseconds.
pub fn verdict_time(scenes: &[Scene], rounds: usize) -> f64 {
    median_time(rounds, || judge(scenes)) * 1e6 / scenes.len() as f64
}

/// The same scenes with torques 10 us after their counts, through a current loop of 3 kHz.
pub fn lagging_scenes() -> Vec<Scene> {
    let latency = Latency::delayed(1e-5).with_actuator_lag(lag_of(3e3));
    scenes().into_iter().map(|scene| Scene { latency, ..scene }).collect()
}

/// Time of the median scene in microseconds: the cost of a verdict grows with its degree, and is many times
/// larger if poles are close to the circle.
pub fn middle_verdict_time(scenes: &[Scene], rounds: usize) -> f64 {
    let time = |scene: &[Scene]| median_time(rounds, || judge(scene));
    1e6 * median(scenes.chunks(1).map(time).collect())
}

/// Largest certified stiffness in N m/rad of an undelayed spring without coupling, at 1 kHz, for a device of
/// 0.022 N m s/rad, with a torque 5 us after its count and a current loop of 3 kHz.
pub fn lagging_spring() -> f64 {
    let early = Latency::delayed(5e-6).with_actuator_lag(lag_of(3e3));
    largest_spring(&PADDLE, PERIOD, early, 0)
}

/// The part of the device's passivity that certified springs may need behind the matched coupling, where
/// torques or counts deviate by up to a hundredth of a period from tick to tick.
pub fn spring_with_jitter() -> f64 {
    let scene = Scene {
        coupling: Coupling::Matched,
        latency: Latency { output_jitter: 1e-5, ..Latency::delayed(1e-4) },
        torque_limit: Some(1.0),
        ..rigid(PADDLE, Wall::spring(20.0, 1).alone())
    };
    let limit = PassivityProblem::of(&scene).ok().and_then(|posed| posed.limit());
    limit.map_or(0.0, |limit| limit.lo() / PADDLE.damping)
}

/// Milliseconds that a certificate adds to the compilation of a program: the difference between a program
/// with `COPIES` certified scenes and the same program without, divided by their number. The two are compiled
/// alternately, so that other load of the machine affects both.
///
/// `latency` is the varying part of the scenes: [`AT_ONCE`] or [`LAGGING`].
///
/// `library` is the built firmware library, `dependencies` the folder of its dependencies.
pub fn compile_time(
    rustc: &Path,
    library: &Path,
    dependencies: &Path,
    latency: &str,
    rounds: usize,
) -> std::io::Result<f64> {
    let folder = tempfile::tempdir()?;
    let time = |copies: usize| -> std::io::Result<f64> {
        let source = folder.path().join(format!("scene_{copies}.rs"));
        std::fs::write(&source, program(copies, latency))?;
        let start = Instant::now();
        let output = Command::new(rustc)
            .args(["--edition=2024", "--crate-type=lib", "--emit=metadata", "-o"])
            .arg(folder.path().join("scene.rmeta"))
            .arg(format!("--extern=haptic_servo={}", library.display()))
            .arg("-L")
            .arg(format!("dependency={}", dependencies.display()))
            .arg(&source)
            .output()?;
        let time = start.elapsed().as_secs_f64() * 1e3;
        if output.status.success() {
            Ok(time)
        } else {
            Err(std::io::Error::other(String::from_utf8_lossy(&output.stderr).into_owned()))
        }
    };
    let differences = (0..rounds).map(|_| Ok((time(COPIES)? - time(0)?) / COPIES as f64));
    Ok(median(differences.collect::<std::io::Result<Vec<_>>>()?))
}

/// One-sided walls without latency and with limited torque.
pub const AT_ONCE: &str = "const fn placed(wall: Wall) -> Wall { wall.behind(0.0) }
const LATENCY: Latency = Latency::NONE;
const LIMIT: Option<f64> = Some(1.0);
";
/// Linear walls behind a delay and a lag.
pub const LAGGING: &str = "const fn placed(wall: Wall) -> Wall { wall }
const LATENCY: Latency = Latency::delayed(1e-5).with_actuator_lag(53e-6);
const LIMIT: Option<f64> = None;
";

/// Certificates in the compiled program.
const COPIES: usize = 8;

fn program(copies: usize, latency: &str) -> String {
    let mut text = String::from(
        "use haptic_servo::{certificate::Certified, environment::*, scene::*};
pub const fn scene(stiffness: f64) -> Scene {
    Scene {
        device: Device { inertia: 2.2e-5, damping: 0.022, passivity: None },
        timing: Timing { period: 0.001, worst_period: None },
        coupling: Coupling::Spring { stiffness: 44.0 },
        environment: placed(Wall::damped(stiffness, 0.01, 1)).alone(),
        latency: LATENCY,
        torque_limit: LIMIT,
    }
}
",
    );
    text += latency;
    for copy in 0..copies {
        text += &format!(
            "pub const C{copy}: Certified<Scene> = scene({:?}).certified();\n",
            10.0 + copy as f64
        );
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_scene_of_the_benchmark_is_judged_to_the_end() {
        let scenes = scenes();
        assert_eq!(scenes.len(), 45);
        for scene in &scenes {
            assert!(assess(scene).alpha.is_some(), "{scene:?}");
        }
    }
}
