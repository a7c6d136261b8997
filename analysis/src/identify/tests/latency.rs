//! Lag and delay of the output: found with inertia and damping, inside intervals that hold them.

use rayon::prelude::*;

use super::least_squares::{Delay, Measured};
use super::*;

/// An output that is late.
#[derive(Clone, Copy, Debug)]
struct Output {
    lag: f64,
    delay: f64,
}

/// Encoder, noise and amplitudes of the program `identify`, in a twentieth of its time.
fn record(device: Device, output: Output, seed: u64) -> Record {
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
    Rig { device, actuator_lag: output.lag, sensing }.measure(&sines)
}

fn measured(device: Device, output: Output, seed: u64) -> Identification {
    let correction = Correction::of_encoder(SENSING.counts_per_turn);
    identify(&record(device, output, seed), &correction).unwrap()
}

fn many(output: Output, records: u64) -> Vec<Identification> {
    (0..records).into_par_iter().map(|seed| measured(KNOB, output, seed)).collect()
}

#[test]
#[ignore = "searches for long"]
fn each_interval_holds_the_truth_in_95_of_100_records() {
    let output = Output { lag: 159e-6, delay: 3e-4 };
    let all = many(output, 100);
    let holds = |interval: &dyn Fn(&Identification) -> Estimate, truth: f64| {
        let hold = |found: &&Identification| {
            let Estimate { lo, hi, .. } = interval(found);
            lo <= truth && truth <= hi
        };
        all.iter().filter(hold).count()
    };
    let hits = [
        holds(&|found| found.inertia, KNOB.inertia),
        holds(&|found| found.damping, KNOB.damping),
        holds(&|found| found.mean_delay, output.lag + output.delay),
        holds(&|found| found.latency.unwrap().actuator_lag, output.lag),
        holds(&|found| found.latency.unwrap().output_delay, output.delay),
    ];
    println!("{hits:?}");
    assert!(hits.iter().all(|&hits| hits >= 95), "{hits:?}");
    // No interval is wide because of that.
    for found in &all {
        let reach = |e: Estimate| 0.5 * (e.hi - e.lo);
        // Friction is fitted too, and its share is not known better.
        assert!(reach(found.damping) < 3e-3 * KNOB.damping, "{:?}", found.damping);
        assert!(reach(found.inertia) < 8e-3 * KNOB.inertia, "{:?}", found.inertia);
        assert!(reach(found.mean_delay) < 5e-6, "{:?}", found.mean_delay);
        assert!(found.latency.unwrap().is_told_apart());
    }
}

#[test]
fn damping_is_unbiased_where_the_real_part_is_not() {
    let output = Output { lag: 159e-6, delay: 50e-6 };
    let all = many(output, 40);
    let mean = |number: &dyn Fn(&Identification) -> f64| {
        let numbers: Vec<f64> = all.iter().map(number).collect();
        let count = numbers.len() as f64;
        let mean = numbers.iter().sum::<f64>() / count;
        let variance = numbers.iter().map(|n| (n - mean).powi(2)).sum::<f64>() / (count - 1.0);
        (mean, (variance / count).sqrt())
    };
    // Theory, section 3.3: at 240 Hz a third of the damping is gone.
    let omega = 240.0 * std::f64::consts::TAU;
    let raw = mean(&|found| found.disk.delta).0 - KNOB.damping;
    let foreseen = Model { damping: KNOB.damping, inertia: KNOB.inertia, ..output.into() };
    let foreseen = foreseen.impedance(omega).re - KNOB.damping;
    assert!(raw < -0.3 * KNOB.damping, "{raw}");
    assert!((raw / foreseen - 1.0).abs() < 0.01, "{raw} {foreseen}");
    let (damping, deviation) = mean(&|found| found.damping.value);
    println!("raw {raw:e}, fitted {:e} +- {deviation:e}", damping - KNOB.damping);
    // Friction is not below zero, so its mean is a little above, and that of the damping as much below.
    let off = damping - KNOB.damping;
    assert!(-3e-4 * KNOB.damping < off && off < 3.0 * deviation, "{damping} {deviation}");
    // A delay alone in the place of lag and delay leaves the inertia wrong.
    let delayed = |found: &Identification| {
        let again = |r: &FrequencyPoint| {
            let admittance = r.admittance * found.model.images(r.omega, SENSING.period);
            FrequencyPoint { admittance, ..*r }
        };
        let responses: Vec<FrequencyPoint> = found.responses.iter().map(again).collect();
        let period = SENSING.period;
        let measured = Measured {
            responses: &responses,
            period,
            declared: 0.0,
            source: None,
            with_friction: false,
        };
        let model = measured.fit(0.0, Delay::From(2e-4)).unwrap().model;
        model.inertia
    };
    let (late, deviation) = mean(&delayed);
    assert!((late - KNOB.inertia).abs() > 20.0 * deviation, "{late} {deviation}");
    let (inertia, deviation) = mean(&|found| found.inertia.value);
    assert!((inertia - KNOB.inertia).abs() < 3.0 * deviation, "{inertia} {deviation}");
}

impl From<Output> for Model {
    fn from(Output { lag, delay }: Output) -> Self {
        Self { damping: 0.0, inertia: 0.0, friction: 0.0, delay, lag, source: None }
    }
}

#[test]
fn a_lag_alone_and_a_delay_alone_are_said_to_be_alike() {
    let found = measured(KNOB, Output { lag: 0.0, delay: 2e-5 }, 1);
    let latency = found.latency.unwrap();
    assert!(!latency.is_told_apart(), "{latency:?}");
    // The sum is known all the same, and both ranges reach to it.
    assert!(found.mean_delay.hi - found.mean_delay.lo < 6e-6, "{:?}", found.mean_delay);
    let ([no_lag, lag], [no_delay, delay]) = (latency.lag_range(), latency.delay_range());
    assert_eq!((no_lag, no_delay), (0.0, 0.0));
    assert!(lag > 1.9e-5 && delay > 2e-5, "{latency:?}");
}

#[test]
fn a_shorter_lag_that_is_declared_narrows_the_delay() {
    let record = record(KNOB, Output { lag: 1e-5, delay: 1e-4 }, 1);
    let correction = Correction::of_encoder(SENSING.counts_per_turn);
    let open = identify(&record, &correction).unwrap().latency.unwrap();
    let declared = Correction { longest_lag: Some(2e-5), ..correction };
    let found = identify(&record, &declared).unwrap().latency.unwrap();
    assert!(found.actuator_lag.hi <= 2e-5 && open.actuator_lag.hi > 4e-5, "{found:?} {open:?}");
    assert!(found.output_delay.lo > 7e-5 && found.output_delay.lo > open.output_delay.lo);
    assert!(found.output_delay.lo < 1e-4 && 1e-4 < found.output_delay.hi, "{found:?}");
}

#[test]
fn what_the_record_does_not_tell_has_no_interval() {
    let none = |found: &Identification| found.latency.unwrap_err();
    // Slower than half a period: taken for inertia, it would fit as well.
    let slow = measured(KNOB, Output { lag: 3e-3, delay: 1e-4 }, 1);
    assert_eq!(none(&slow), NoLatency::TooSlow(5e-4));
    // A device that is as quick as an amplifier.
    let quick = Device { inertia: 6e-6, ..KNOB };
    let found = measured(quick, Output { lag: 1e-4, delay: 0.0 }, 1);
    assert!(matches!(none(&found), NoLatency::LikeInertia(_)), "{found:?}");
    assert!(found.inertia.lo <= 6e-6 && 6e-6 <= found.inertia.hi, "{:?}", found.inertia);
    // Tones at which the device does not show its inertia, which a delay looks like.
    let short =
        identified(&rig(KNOB, Sensing { torque_noise: 5e-3, ..SENSING }), &[1.0, 2.0, 4.0], 0.02);
    assert!(none(&short).to_string().contains("faster tones"), "{short:?}");
    // Counts that are younger than their row, by a declared delay that is too long.
    let record = record(KNOB, Output { lag: 1e-4, delay: 0.0 }, 1);
    let early = Correction { count_delay: 3e-4, ..Correction::of_encoder(SENSING.counts_per_turn) };
    let found = identify(&record, &early).unwrap();
    assert!(none(&found).to_string().contains("too early"), "{:?}", found.latency);
    assert_near(&found.damping, KNOB.damping, 0.02);
}
