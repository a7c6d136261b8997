//! Time of one verdict, over environments of all degrees.

use std::hint::black_box;

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use firmware::certificate::assess;

fn verdict(criterion: &mut Criterion) {
    let scenes = analysis::studies::bench::scenes();
    let mut group = criterion.benchmark_group("verdict");
    group.throughput(Throughput::Elements(scenes.len() as u64));
    group.bench_function("rational, degrees 0 to 8", |bencher| {
        bencher.iter(|| {
            for scene in &scenes {
                black_box(assess(black_box(scene)));
            }
        });
    });
    for program in analysis::program::ALL {
        group.throughput(Throughput::Elements(1));
        group.bench_function(program.name, |bencher| {
            bencher.iter(|| black_box(assess(black_box(&program.scene))));
        });
    }
    group.finish();
}

criterion_group!(benches, verdict);
criterion_main!(benches);
