//! Torques and counts that deviate in time at once (theory, section 13.4): taps and limit of the coupling, of a loop
//! with period and passivity 1, by a formula of its own. That nothing less is enough is among the planted rules of
//! `tests/adversary`.

use haptic_servo::certificate::PassivityProblem;
use haptic_servo::environment::Wall;
use haptic_servo::latency::TimeRange;
use haptic_servo::matched::MatchedCoupling;
use haptic_servo::number::Format;
use haptic_servo::scene::{Coupling, Device, Latency, Scene, Timing};
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// A torque begins `delay` after its count, `torques` off that at most, and the count is `counts` off its time at
/// most.
#[derive(Clone, Copy, Debug)]
struct Windows {
    delay: f64,
    torques: f64,
    counts: f64,
}

impl Windows {
    fn both(&self) -> f64 {
        2.0 * self.torques.min(self.counts)
    }

    fn width(&self) -> f64 {
        2.0 * (self.torques + self.counts)
    }

    /// The taps of a torque that comes `later`.
    fn tap(&self, m: usize, later: f64) -> f64 {
        let late = self.delay + self.torques + self.counts + later;
        let m = m as f64;
        (late + 1.0 - m).clamp(0.0, 1.0 + self.width()) + if m < late { self.both() } else { 0.0 }
    }

    fn latency(&self) -> Latency {
        Latency {
            output_jitter: self.torques,
            count_jitter: self.counts,
            ..Latency::delayed(self.delay)
        }
    }
}

fn draw(rng: &mut ChaCha8Rng) -> Windows {
    let sum = rng.random_range(0.02..0.49);
    let torques = sum * rng.random_range(0.1..0.9);
    let delay = [0.0, 0.3, 0.7, 1.0][rng.random_range(0..4)];
    Windows { delay: delay + rng.random_range(0.0..0.3), torques, counts: sum - torques }
}

fn coupling(latency: &Latency) -> MatchedCoupling {
    MatchedCoupling::of(1.0, None, 1.0, latency, Format::F64).expect("a coupling")
}

/// Those for torques up to the first two ticks, then the first of each trail.
fn taps(coupling: &MatchedCoupling) -> Vec<f64> {
    let mut taps = vec![coupling.compliance];
    taps.extend(vec![coupling.held; coupling.whole]);
    taps.push(coupling.arriving);
    for later in 0..3 {
        taps.push(coupling.trails.iter().map(|t| t.gain * t.decay.powi(later)).sum());
    }
    taps
}

#[test]
fn a_coupling_has_these_taps_and_this_limit() {
    let mut rng = ChaCha8Rng::seed_from_u64(72);
    for _ in 0..200 {
        let windows = draw(&mut rng);
        let coupling = coupling(&windows.latency());
        for (m, found) in taps(&coupling).into_iter().enumerate() {
            let wanted = 0.5 * windows.tap(m, 0.0);
            assert!((found - wanted).abs() < 1e-12, "{m}: {found} {wanted} {windows:?}");
        }
        let limit = 1.0 / (1.0 + windows.width() + windows.both());
        assert!((coupling.limit.midpoint() / limit - 1.0).abs() < 1e-11, "{windows:?}");
    }
    let equal = Windows { delay: 1.0, torques: 0.05, counts: 0.05 };
    assert!((coupling(&equal.latency()).limit.midpoint() * 1.3 - 1.0).abs() < 1e-11);
}

/// A lag is a mixture of delays: its taps are means of those without a lag.
#[test]
fn the_taps_of_a_lag_are_means_over_its_delays() {
    const PARTS: usize = 40_000;
    let windows = Windows { delay: 0.75, torques: 0.06, counts: 0.09 };
    let mean = |delay_of: &dyn Fn(f64) -> f64, m: usize| {
        let part = |i: usize| windows.tap(m, delay_of((i as f64 + 0.5) / PARTS as f64));
        (0..PARTS).map(part).sum::<f64>() / PARTS as f64
    };
    let tau = 0.6;
    let continuous = |share: f64| -tau * (1.0 - share).ln();
    // Between two of four updates in a period the step response is a straight line.
    let decay = f64::exp(-0.25 / tau);
    let updated = |share: f64| {
        let (mut rest, mut update) = (1.0, 0.0);
        while 1.0 - share < rest * decay {
            (rest, update) = (rest * decay, update + 1.0);
        }
        0.25 * (update + (1.0 - (1.0 - share) / rest) / (1.0 - decay))
    };
    let lagging = windows.latency().with_actuator_lag(tau);
    let sensed = Latency { sensor_lag: TimeRange::exactly(tau), ..windows.latency() };
    let sampled = Latency { actuator_updates: 4, ..lagging };
    let cases: [(Latency, &dyn Fn(f64) -> f64); 3] =
        [(lagging, &continuous), (sensed, &continuous), (sampled, &updated)];
    for (latency, delay_of) in cases {
        for (m, found) in taps(&coupling(&latency)).into_iter().enumerate() {
            let wanted = 0.5 * mean(delay_of, m);
            assert!((found - wanted).abs() < 1e-4, "{m}: {found} {wanted} {latency:?}");
        }
    }
    // Without the addition they would be off by more than that.
    assert!(windows.both() * f64::exp(-1.0 / tau) > 1e-2);
}

/// One jitter is of torques or of counts, whichever of the two a scene states.
#[test]
fn a_count_jitter_alone_is_an_output_jitter() {
    let jitter = 2e-4;
    let output =
        Latency { output_jitter: jitter, ..Latency::delayed(3e-4).with_actuator_lag(1e-4) };
    let count = Latency { output_jitter: 0.0, count_jitter: jitter, ..output };
    let of = |latency: &Latency| MatchedCoupling::of(1e-3, None, 0.022, latency, Format::F32);
    assert_eq!(of(&output), of(&count));
    for coupling in [Coupling::Rigid, Coupling::Matched, Coupling::Spring { stiffness: 8.0 }] {
        for (damping, torque_limit) in [(0.0, None), (0.001, None), (0.001, Some(1.0))] {
            let judged = |latency| {
                let device = Device { inertia: 2.2e-5, damping: 0.022, passivity: None };
                let posed = PassivityProblem::of(&Scene {
                    device,
                    timing: Timing { period: 1e-3, worst_period: None },
                    coupling,
                    environment: Wall::damped(3.0, damping, 1).alone(),
                    latency,
                    torque_limit,
                })
                .unwrap();
                (posed.answer(), posed.bound(), posed.paper_limit())
            };
            assert_eq!(judged(output), judged(count), "{coupling:?} {damping} {torque_limit:?}");
        }
    }
}

/// Where the proof does not reach, a number is refused with what it has to be.
#[test]
fn what_is_not_proved_is_refused() {
    let refused = |latency: Latency| {
        let scene = Scene {
            coupling: Coupling::Matched,
            latency,
            ..Scene::of(Device::damped(2.2e-5, 0.022), 1e-3, Wall::spring(1.0, 1).alone())
        };
        scene.certify().err().map(|error| error.to_string())
    };
    let both = Latency { output_jitter: 2e-4, count_jitter: 2.9e-4, ..Latency::delayed(6e-4) };
    assert_eq!(refused(both), None);
    let lag = |least, most| Latency { actuator_lag: TimeRange::between(least, most), ..both };
    assert_eq!(refused(lag(1e-4, 1e-4)), None);
    for (latency, words) in [
        (
            Latency { count_jitter: 3e-4, ..both },
            "the count jitter is 0.0003 s, and must be below half",
        ),
        (Latency { output_delay: TimeRange::between(5e-4, 6e-4), ..both }, "below half"),
        (lag(1e-4, 2e-4), "0 beside an output jitter and a lag"),
        (
            Latency { count_jitter: 1.5e-3, ..both },
            "at most the time from a count to its torque, less",
        ),
        (
            Latency { output_jitter: 0.0, count_jitter: 1.7e-3, ..both },
            "at most the time from a count",
        ),
    ] {
        let error = refused(latency).unwrap_or_default();
        assert!(error.contains(words), "{error}: {latency:?}");
    }
}
