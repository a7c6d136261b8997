//! What a step of the exact method costs, against a loop that is written for its scene by hand.
//!
//! `cargo bench -p analysis --bench simulation`; the reciprocal of a time is in steps a second.

use std::hint::black_box;

use analysis::device::Motion;
use analysis::simulation::{Experiment, Simulator, Stride, Trajectory};
use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use firmware::environment::{Environment, Wall};
use firmware::scene::{Coupling, Device, Scene, Timing};

const STEPS: usize = 10_000;
/// So near the standard coupling's limit that the motion lasts through all steps.
const STIFFNESS: f64 = 43.999;

fn experiment(damping: f64, delay: usize, torque_limit: Option<f64>) -> Experiment {
    let stiffness = STIFFNESS - 2.0 * damping / 1e-3;
    let wall = Wall { stiffness, damping, filter: None, delay, face: 0.0, one_sided: false };
    let scene = Scene {
        device: Device { inertia: 2.2e-5, damping: 0.022, passivity: None },
        timing: Timing { period: 1e-3, worst_period: None },
        coupling: Coupling::Spring { stiffness: 44.0 },
        environment: Environment::DamperWall(wall),
        torque_limit,
    };
    let start = Motion { position: 1e-3, velocity: 0.0 };
    Experiment { samples: STEPS, start, ..Experiment::still(&scene) }
}

/// Mass-damper and delayed spring, states in variables, samples recorded.
fn by_hand(out: &mut Trajectory) {
    let (m, b, t, k, coupling) = (2.2e-5, 0.022, 1e-3, STIFFNESS, 44.0);
    let decay = f64::exp(-b * t / m);
    let slide = (1.0 - decay) * m / b;
    let (to_position, to_velocity) = ((t - slide) / b, (1.0 - decay) / b);
    let (mut x, mut v, mut due) = (1e-3, 0.0, 0.0);
    let samples = out.position.iter_mut().zip(&mut out.velocity).zip(&mut out.torque);
    for ((position, velocity), torque) in samples {
        (*position, *velocity, *torque) = (x, v, due);
        let next = k * (x - due / coupling);
        (x, v) = (x + slide * v - to_position * due, decay * v - to_velocity * due);
        due = next;
    }
}

fn steps(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("step");
    group.throughput(Throughput::Elements(STEPS as u64));
    let mut out = Trajectory::of_length(STEPS);
    group.bench_function("written by hand, degree 1", |bencher| {
        bencher.iter(|| by_hand(black_box(&mut out)));
    });
    for (name, experiment) in [
        ("exact, wall of degree 1", experiment(0.0, 1, None)),
        ("exact, undelayed damper wall", experiment(0.01, 0, None)),
        ("exact, delayed damper wall", experiment(0.01, 1, None)),
        ("exact, with torque limit", experiment(0.01, 1, Some(1.0))),
    ] {
        let mut simulator = Simulator::new(&experiment, Stride::default()).expect("has a law");
        group.bench_function(name, |bencher| {
            bencher.iter(|| simulator.fill(black_box(&mut out)));
        });
    }
    group.finish();
}

criterion_group!(benches, steps);
criterion_main!(benches);
