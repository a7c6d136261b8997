//! Lag and delay of the output: found with inertia and damping, inside intervals that hold them.

use rayon::prelude::*;

use super::*;

/// An output that is late.
#[derive(Clone, Copy, Debug)]
struct Output {
    lag: f64,
    delay: f64,
}

/// The encoder, the noise and the amplitudes of the program `identify`, in a twentieth of its time.
fn measured(device: Device, output: Output, seed: u64) -> Identification {
    let tones = [
        (2.0, 0.06, 1.0),
        (8.0, 0.22, 0.5),
        (32.0, 0.9, 0.3),
        (64.0, 1.6, 0.3),
        (100.0, 1.6, 0.3),
        (160.0, 1.6, 0.3),
        (240.0, 1.6, 0.3),
    ];
    let sines =
        tones.map(|(frequency, amplitude, duration)| Excitation { frequency, amplitude, duration });
    let sensing = Sensing { torque_noise: 0.005, output_delay: output.delay, seed, ..SENSING };
    let rig = Rig { device, actuator_lag: output.lag, sensing };
    let record = rig.measure(&sines).unwrap();
    identify(&record, &Correction::of_encoder(sensing.counts_per_turn)).unwrap()
}

#[test]
fn experiment() {
    for (lag, delay) in [
        (0.0, 0.0),
        (0.0, 30e-6),
        (0.0, 2e-4),
        (20e-6, 0.0),
        (53e-6, 0.0),
        (53e-6, 30e-6),
        (80e-6, 5e-6),
        (159e-6, 0.0),
        (159e-6, 300e-6),
        (80e-6, 1.3e-3),
        (400e-6, 1e-3),
        (900e-6, 1e-4),
    ] {
        let output = Output { lag, delay };
        let begun = std::time::Instant::now();
        let all: Vec<_> =
            (0..100).into_par_iter().map(|seed| measured(KNOB, output, seed)).collect();
        let time = begun.elapsed().as_secs_f64();
        let stat = |pick: &dyn Fn(&Identification) -> Option<Estimate>, truth: f64| {
            let found: Vec<_> = all.iter().filter_map(pick).collect();
            let hit = found.iter().filter(|e| e.lo <= truth && truth <= e.hi).count();
            let n = found.len() as f64;
            let width = found.iter().map(|e| e.hi - e.lo).sum::<f64>() / n;
            let mean = found.iter().map(|e| e.value).sum::<f64>() / n;
            format!("{hit}/{} w {width:.2e} mean {mean:.4e}", found.len())
        };
        eprintln!(
            "lag {lag:.1e} delay {delay:.1e}: {time:.2} s, misfit {:.2}, told {}",
            all.iter().map(|f| f.misfit).sum::<f64>() / 100.0,
            all.iter().filter(|f| f.latency.is_ok_and(|l| l.is_told_apart())).count()
        );
        eprintln!("   b {}", stat(&|f| Some(f.damping), KNOB.damping));
        eprintln!("   m {}", stat(&|f| Some(f.inertia), KNOB.inertia));
        eprintln!("   s {}", stat(&|f| Some(f.mean_delay), lag + delay));
        eprintln!("   t {}", stat(&|f| f.latency.ok().map(|l| l.actuator_lag), lag));
        eprintln!("   d {}", stat(&|f| f.latency.ok().map(|l| l.output_delay), delay));
        if let Some(f) = all.iter().find(|f| f.latency.is_err()) {
            eprintln!("   {}", f.latency.unwrap_err());
        }
    }
}
