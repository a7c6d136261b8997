//! `cargo bench -p analysis --bench simulation`; the reciprocal of a time is in steps a second.

use std::hint::black_box;

use analysis::simulation::{Integration, Simulator, Trajectory};
use analysis::studies::bench::steps::{STEPS, by_hand, experiment};
use criterion::{Criterion, Throughput, criterion_group, criterion_main};

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
        let mut simulator = Simulator::new(&experiment, Integration::default()).expect("has a law");
        group.bench_function(name, |bencher| {
            bencher.iter(|| simulator.fill(black_box(&mut out)));
        });
    }
    group.finish();
}

criterion_group!(benches, steps);
criterion_main!(benches);
