//! Amplifiers of which only the begin and end of the step response are known: mixtures of delays, by their
//! own waveforms, never need more than the certified passivity.

use std::f64::consts::PI;

use haptic_servo::certificate::{Rejection, assess, certify};
use haptic_servo::environment::{Canceller, Wall};
use haptic_servo::parameter::Parameter;
use haptic_servo::scene::{Coupling, Device, Latency, Scene, TimeRange, Timing};
use nalgebra::Complex;
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use tests::loops::Loop;

/// A part of the torque.
#[derive(Clone, Copy, Debug)]
struct Part {
    /// Delay in periods.
    delay: f64,
    /// All of them together are 1.
    weight: f64,
}

/// A loop with an amplifier whose response begins and ends then, in periods.
#[derive(Clone, Copy, Debug)]
struct Unknown {
    drawn: Loop,
    response: [f64; 2],
}

impl Unknown {
    fn draw(rng: &mut ChaCha8Rng) -> Self {
        let drawn = Loop { actuator_lag: 0.0, sensor_lag: 0.0, ..Loop::draw(rng) };
        let mut ends = [rng.random_range(0.0..1.0), rng.random_range(0.0..1.0)];
        ends.sort_by(f64::total_cmp);
        Self { drawn, response: ends }
    }

    fn scene(&self) -> Scene {
        let [begin, end] = self.response;
        let mut scene = self.drawn.scene();
        scene.latency = scene.latency.with_actuator_response(begin, end);
        scene
    }

    /// The passivity that is certified to be enough; `None` where the controller is not stable.
    fn certified(&self) -> Option<f64> {
        assess(&self.scene()).alpha_port.map(|port| port.hi())
    }

    /// Some response between the two.
    fn mixture(&self, rng: &mut ChaCha8Rng) -> Vec<Part> {
        let [begin, end] = self.response;
        let parts = rng.random_range(1..=5);
        let mut all: Vec<Part> = (0..parts)
            .map(|_| Part {
                delay: self.drawn.output_delay
                    + match rng.random_range(0..4) {
                        0 => begin,
                        1 => end,
                        _ => rng.random_range(begin..=end),
                    },
                weight: rng.random_range(0.01..1.0),
            })
            .collect();
        let sum: f64 = all.iter().map(|part| part.weight).sum();
        all.iter_mut().for_each(|part| part.weight /= sum);
        all
    }

    /// The passivity that a mixture needs: from the mean torque of a period and its square, of which
    /// equation 38 is made.
    fn needed(&self, parts: &[Part]) -> f64 {
        const ANGLES: usize = 400;
        let mut times: Vec<f64> = parts.iter().map(|part| part.delay.fract()).collect();
        times.extend([0.0, 1.0]);
        times.sort_by(f64::total_cmp);
        let at = |theta: f64| {
            let z = Complex::from_polar(1.0, theta);
            let (mut mean, mut square) = (Complex::new(0.0, 0.0), 0.0);
            for ends in times.windows(2) {
                let (length, middle) = (ends[1] - ends[0], 0.5 * (ends[0] + ends[1]));
                let one = |part: &Part| z.powi((middle - part.delay).floor() as i32) * part.weight;
                let torque: Complex<f64> = parts.iter().map(one).sum();
                mean += torque * length;
                square += torque.norm_sqr() * length;
            }
            let h = self.drawn.controller_at(z);
            let step = z - 1.0;
            let real = (h * mean / step).re;
            let ripple = (square - mean.norm_sqr()) / step.norm_sqr();
            0.5 * ((real * real + ripple * h.norm_sqr()).sqrt() - real)
        };
        (1..=ANGLES).map(|n| at(PI * n as f64 / ANGLES as f64)).fold(0.0, f64::max)
    }
}

#[test]
fn no_mixture_of_delays_needs_more_than_what_is_certified() {
    let mut rng = ChaCha8Rng::seed_from_u64(1);
    let (mut loops, mut nearest) = (0, 0.0_f64);
    while loops < 60 {
        let unknown = Unknown::draw(&mut rng);
        let Some(certified) = unknown.certified() else { continue };
        loops += 1;
        for _ in 0..20 {
            let parts = unknown.mixture(&mut rng);
            let needed = unknown.needed(&parts);
            assert!(
                needed <= certified * (1.0 + 1e-9),
                "{unknown:?} {parts:?} {needed} {certified}"
            );
            nearest = nearest.max(needed / certified);
        }
    }
    // A bound that nothing comes near to would not be tested.
    assert!(nearest > 0.99, "{nearest}");
}

fn spring(stiffness: f64, latency: Latency) -> Scene {
    Scene {
        latency,
        ..Scene::of(Device::damped(2.2e-5, 0.022), 1e-3, Wall::spring(stiffness, 0).alone())
    }
}

/// At rest: `delta > K (T/2 + d2) + K^2 T^2/(16 delta)`, for a range with a half in it.
#[test]
fn a_spring_has_its_closed_form() {
    let latency = Latency::delayed(1e-4).with_actuator_response(1e-4, 6e-4);
    let (t, delta) = (1e-3_f64, 0.022);
    let (a, b) = (t * t / (16.0 * delta), t / 2.0 + 7e-4);
    let limit = ((b * b + 4.0 * a * delta).sqrt() - b) / (2.0 * a);
    assert!(certify(&spring(0.999_999 * limit, latency)).is_ok());
    assert!(certify(&spring(1.000_001 * limit, latency)).is_err());
}

/// A response at one instant is a delay.
#[test]
fn a_response_that_takes_no_time_is_a_delay() {
    for delay in [1e-4, 5e-4, 9.5e-4, 1e-3] {
        let [one, other] =
            [Latency::delayed(delay), Latency::delayed(0.0).with_actuator_response(delay, delay)]
                .map(|latency| assess(&spring(11.0, latency)).alpha_port.expect("it lags"));
        assert!(one.hi() >= other.lo() && other.hi() >= one.lo(), "{one:?} {other:?}");
        assert!(other.hi() - other.lo() < 1e-8);
    }
}

#[test]
fn responses_that_are_none_are_refused_with_value_and_bound() {
    let refused = |latency: Latency| match certify(&spring(5.0, latency)) {
        Err(Rejection::Invalid(invalid)) => {
            assert_eq!(invalid.parameter, Parameter::ActuatorResponse);
            Rejection::Invalid(invalid).to_string()
        }
        other => panic!("{other:?}"),
    };
    let response = |begin, end| refused(Latency::NONE.with_actuator_response(begin, end));
    for (begin, end, words) in [
        (0.0, 1.1e-3, &["0.0011 s", "at most the period: 0.001 s"][..]),
        (-1e-4, 1e-4, &["-0.0001 s", "finite and not below 0"]),
        (-1e-4, 0.0, &["-0.0001 s", "finite and not below 0"]),
        (0.0, f64::NAN, &["NaN", "finite and not below 0"]),
        (f64::NAN, 1e-4, &["NaN", "finite and not below 0"]),
        (0.0, f64::INFINITY, &["inf", "finite and not below 0"]),
        (2e-4, 1e-4, &["0.0002 s", "at most the other end of its range: 0.0001 s"]),
    ] {
        let message = response(begin, end);
        assert!(words.iter().all(|word| message.contains(word)), "{message}");
    }
    let lagging = [
        Latency::NONE.with_actuator_lag(1e-4),
        Latency { sensor_lag: TimeRange::exactly(1e-4), ..Latency::NONE },
    ];
    for latency in lagging {
        let message = refused(latency.with_actuator_response(0.0, 1e-4));
        assert!(message.contains("0 beside a lag of amplifier or sensor"), "{message}");
    }
}

/// Behind the coupling that absorbs latency an environment needs an index below that of the window of all
/// responses (equation 57), which is the bound that a torque limit has.
#[test]
fn a_linear_scene_behind_the_matched_coupling_passes_where_the_limited_one_does() {
    let mut rng = ChaCha8Rng::seed_from_u64(3);
    for _ in 0..60 {
        let (period, delta) = (1e-3, 0.022);
        let mut ends = [rng.random_range(0.0..1.0), rng.random_range(0.0..1.0)];
        ends.sort_by(f64::total_cmp);
        let [begin, end] = ends.map(|end| end * period);
        let delay = period * rng.random_range(0.0..1.0);
        let left = delta / (1.0 + (end - begin) / period);
        let scene = |share: f64, torque_limit| Scene {
            device: Device { inertia: 2.2e-5, damping: delta, passivity: None },
            timing: Timing { period, worst_period: None },
            coupling: Coupling::Matched,
            environment: Canceller::to(delta - share * left).alone(),
            latency: Latency::delayed(delay).with_actuator_response(begin, end),
            torque_limit,
        };
        for limit in [None, Some(0.1)] {
            assert!(certify(&scene(0.999, limit)).is_ok(), "{begin} {end} {delay} {limit:?}");
        }
        assert!(certify(&scene(1.001, Some(0.1))).is_err(), "{begin} {end} {delay}");
    }
}
