//! Current loops that are updated a whole number of times in a period: the certificate's response and ripple
//! against the torque over time, drawn from update to update.

use haptic_servo::certificate::{Rejection, assess, certify};
use haptic_servo::environment::Wall;
use haptic_servo::parameter::Parameter;
use haptic_servo::passivity::interval::Interval;
use haptic_servo::passivity::lagged::{LagIntervals, SampledResponse, delay_of_updates};
use haptic_servo::scene::{Coupling, Device, EncoderReading, Latency, Scene, TimeRange, Timing};
use nalgebra::Complex;
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use tests::scenes::log_uniform;

type C = Complex<f64>;

/// A current loop: updates in a period, those from a count to its torque, the age of a count in update intervals,
/// and its time constant in periods.
#[derive(Clone, Copy, Debug)]
struct CurrentLoop {
    updates: u16,
    delay: u32,
    age: f64,
    lag: f64,
}

impl CurrentLoop {
    fn draw(rng: &mut ChaCha8Rng) -> Self {
        let updates = rng.random_range(1..=40);
        let delay = rng.random_range(0..=3 * u32::from(updates));
        let age = if rng.random() { 0.0 } else { rng.random_range(0.01..0.99) };
        Self { updates, delay, age, lag: log_uniform(rng, 0.01, 20.0) }
    }

    fn response(&self) -> SampledResponse {
        let lag = self.of_lags(Interval::decimal(self.lag));
        assert_eq!(lag.pieces(), 1);
        lag.response(0).unwrap()
    }

    fn of_lags(&self, lag: Interval) -> LagIntervals {
        let age = Interval::exact(self.age).div(Interval::exact(self.updates.into()));
        let delay = delay_of_updates(self.delay, self.updates);
        let between = self.age > 0.0;
        let delay = if between { delay.add(age) } else { delay };
        LagIntervals { delay, lags: [lag, Interval::ZERO], updates: self.updates, between }
    }

    /// The torque over a tick, which begins with a reading, of a controller's output `z^k`: at the tick's ends and
    /// at each update, with its time in update intervals. From one to the next it is a straight line.
    fn torque(&self, theta: f64) -> Vec<(f64, C)> {
        let n = self.updates as usize;
        let left = (-1.0 / (f64::from(self.updates) * self.lag)).exp();
        // Until less than a rounding of it is left.
        let ticks = (40.0 * self.lag).ceil() as usize + 5;
        let mut torque = C::new(0.0, 0.0);
        let mut all = Vec::new();
        for update in 0..n * ticks {
            all.push(torque);
            let output = update as i64 - i64::from(self.delay);
            if output >= 0 {
                let tick = (output as usize / n) as f64;
                let wanted = C::from_polar(1.0, theta * tick);
                torque = wanted + (torque - wanted) * left;
            }
        }
        all.push(torque);
        // The last tick, as that of `z^0`.
        let back = C::from_polar(1.0, -theta * (ticks - 1) as f64);
        let at = |time: f64| {
            let (update, part) = (time.floor() as usize, time.fract());
            let next = all[(update + 1).min(all.len() - 1)];
            (time, (all[update] + (next - all[update]) * part) * back)
        };
        let begin = (n * (ticks - 1)) as f64;
        let updates = (0..n).map(|update| begin + update as f64);
        let ends = [begin - self.age, begin + n as f64 - self.age];
        ends[..1].iter().copied().chain(updates).chain([ends[1]]).map(at).collect()
    }

    /// `z^-whole g` and `D` by the mean of a tick's torque and of its square.
    fn expected(&self, theta: f64) -> (C, f64) {
        let torque = self.torque(theta);
        let share = 1.0 / f64::from(self.updates);
        let (mut mean, mut square) = (C::new(0.0, 0.0), 0.0);
        for ends in torque.windows(2) {
            let [(from, first), (to, last)] = [ends[0], ends[1]];
            let (middle, share) = (0.5 * (first + last), share * (to - from));
            mean += share * middle;
            // Simpson's rule, which a parabola obeys.
            let sizes = [first, middle, last].map(|torque| torque.norm_sqr());
            square += share * (sizes[0] + 4.0 * sizes[1] + sizes[2]) / 6.0;
        }
        let step = C::from_polar(1.0, theta) - 1.0;
        (mean / step, (square - mean.norm_sqr()) / step.norm_sqr())
    }
}

fn value(response: &SampledResponse, theta: f64) -> C {
    analysis::response::Response::new(response.transfer(Interval::ONE)).at_angle(theta)
}

#[test]
fn response_and_ripple_are_those_of_the_torque_over_time() {
    let mut rng = ChaCha8Rng::seed_from_u64(1);
    for _ in 0..400 {
        let drawn = CurrentLoop::draw(&mut rng);
        let response = drawn.response();
        for theta in [0.03, 0.7, 1.9, 3.1] {
            let (g, ripple) = drawn.expected(theta);
            let found = value(&response, theta);
            assert!((found - g).norm() < 1e-10 * (1.0 + g.norm()), "{drawn:?} {theta} {found} {g}");
            let found = response.ripple_at(theta.cos());
            let room = 1e-11 / theta.powi(2);
            assert!(
                found.lo() - room <= ripple && ripple <= found.hi() + room,
                "{drawn:?} {theta} {found:?} {ripple}"
            );
            assert!(found.hi() - found.lo() < 1e-8, "{drawn:?} {theta} {found:?}");
        }
    }
}

/// With many updates a straight line is no longer distinguished from the exponential: it is late by
/// `h^2 / (12 tau)`.
#[test]
fn many_updates_are_a_continuous_lag() {
    for (delay, lag) in [(0.25_f64, 0.3_f64), (1.5, 0.06), (0.5, 4.0)] {
        let lags = [Interval::decimal(lag), Interval::ZERO];
        let continuous =
            LagIntervals { delay: Interval::exact(delay), lags, updates: 0, between: false };
        let continuous = continuous.response(0).unwrap();
        for updates in [64_u16, 512, 4096] {
            let n = f64::from(updates);
            let sampled =
                CurrentLoop { updates, delay: (delay * n) as u32, age: 0.0, lag }.response();
            for theta in [0.2, 1.0, 2.0, 3.0] {
                let apart = value(&sampled, theta) - value(&continuous, theta);
                let later = 1.0 / (12.0 * lag * n * n);
                assert!(apart.norm() < 1.01 * later, "{apart} {later}");
                let [one, other] =
                    [&sampled, &continuous].map(|it| it.ripple_at(theta.cos()).midpoint());
                assert!((one - other).abs() < later, "{one} {other} {later}");
            }
        }
    }
}

/// A time constant in a range has every one of its values in the enclosures.
#[test]
fn a_range_of_the_time_constant_encloses_its_values() {
    let mut rng = ChaCha8Rng::seed_from_u64(2);
    for _ in 0..100 {
        let drawn =
            CurrentLoop { lag: log_uniform(&mut rng, 0.05, 2.0), ..CurrentLoop::draw(&mut rng) };
        let to = drawn.lag * rng.random_range(1.0..1.1);
        let range = drawn.of_lags(Interval::new(drawn.lag, to)).response(0).unwrap();
        for part in [0.0, 0.4, 1.0] {
            let one = CurrentLoop { lag: drawn.lag + part * (to - drawn.lag), ..drawn };
            let c = rng.random_range(-1.0..0.99_f64);
            let (_, ripple) = one.expected(c.acos());
            let found = range.ripple_at(c);
            assert!(found.lo() - 1e-9 <= ripple && ripple <= found.hi() + 1e-9, "{drawn:?} {c}");
        }
    }
}

const PERIOD: f64 = 1e-4;

fn spring(stiffness: f64, delay: usize, latency: Latency) -> Scene {
    Scene {
        latency,
        ..Scene::of(Device::damped(2.2e-5, 0.022), PERIOD, Wall::spring(stiffness, delay).alone())
    }
}

fn limit(latency: Latency) -> f64 {
    largest(|stiffness| spring(stiffness, 1, latency))
}

fn largest(scene: impl Fn(f64) -> Scene) -> f64 {
    let (mut low, mut high) = (0.0, 1e4);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if certify(&scene(middle)).is_ok() { low = middle } else { high = middle }
    }
    low
}

/// Readings with an age beside such a loop: the spring by the rule for linear scenes, and the one-sided spring by
/// that for static laws, have the same limit. With many updates it is that of the continuous lag behind the age, and
/// behind the matched coupling a spring in contact is certified up to nearly any stiffness.
#[test]
fn a_reading_with_an_age_is_that_much_later() {
    let lag = 6e-5;
    let read = |latency: Latency, least: f64, most: f64| {
        let age = TimeRange::between(least, most);
        let encoder = EncoderReading { age, ..EncoderReading::IDEAL };
        latency.read_by(Box::leak(Box::new(encoder)))
    };
    for (updates, age) in [(1, 3e-5), (4, 1e-5), (4, 2.5e-5), (4, 7.3e-5), (20, 1.13e-4)] {
        let read = |latency| read(latency, age, age);
        let latency = read(Latency::sampled(updates, lag, PERIOD));
        let linear = limit(latency);
        let one_sided = largest(|stiffness| {
            let environment = Wall::spring(stiffness, 1).behind(0.0).alone();
            Scene { environment, ..spring(stiffness, 1, latency) }
        });
        assert!((one_sided / linear - 1.0).abs() < 1e-9, "{updates} {age}: {one_sided} {linear}");
        let begin = PERIOD / f64::from(updates);
        let continuous = limit(read(Latency::delayed(begin).with_actuator_lag(lag)));
        let later = (linear / continuous - 1.0).abs();
        assert!(later < 1.1 / f64::from(updates).powi(2), "{updates} {age}: {later}");
        let young = limit(Latency::sampled(updates, lag, PERIOD));
        assert!(linear < 0.99 * young, "{updates} {age}: {linear} {young}");
        let matched = Scene {
            coupling: Coupling::Matched,
            torque_limit: Some(1.0),
            environment: Wall::spring(1e3, 0).behind(0.0).alone(),
            ..spring(1.0, 0, latency)
        };
        assert!(certify(&matched).is_ok(), "{updates} {age}");
    }
    // An age that varies is a jitter as well; a static law counts its largest age.
    let loop_of = Latency::sampled(4, lag, PERIOD);
    let one_sided = |latency| {
        largest(|stiffness| {
            let environment = Wall::spring(stiffness, 1).behind(0.0).alone();
            Scene { environment, ..spring(stiffness, 1, latency) }
        })
    };
    let [varying, oldest, older] = [(0.0, 1e-5), (1e-5, 1e-5), (2.5e-5, 2.5e-5)]
        .map(|(least, most)| one_sided(read(loop_of, least, most)));
    assert!(older <= varying && varying <= oldest, "{older} {varying} {oldest}");
}

/// The rest of a step of the torque lies between those of the continuous lag and of the same that begins later.
#[test]
fn straight_lines_are_later_than_the_lag_by_so_much() {
    let mut rng = ChaCha8Rng::seed_from_u64(3);
    let mut closest = f64::INFINITY;
    for _ in 0..200 {
        let updates = rng.random_range(1..=40_u16);
        let lag = log_uniform(&mut rng, 0.01, 20.0);
        let sensor_lag = TimeRange::exactly(0.1);
        let latency = Latency { sensor_lag, ..Latency::sampled(updates, lag, 1.0) };
        let later = latency.later_than_lag(1.0);
        let between = 1.0 / f64::from(updates);
        let left = (-between / lag).exp();
        for step in 1..200 {
            let part = f64::from(step) / 200.0;
            let rest = 1.0 - (1.0 - left) * part;
            // The time at which the lag has that rest.
            let behind = part * between + lag * rest.ln();
            assert!((-1e-15..=later.hi()).contains(&behind), "{updates} {lag} {part}: {behind}");
            closest = f64::min(closest, later.hi() / behind.max(1e-300));
        }
    }
    assert!(closest < 1.001, "{closest}");
}

/// Beside a sensor filter the certificate has the continuous lag in a window. For a spring that is the exact limit of
/// the same lag at the end of the window, and for a damped one less than that, by about the width of the window.
#[test]
fn a_filter_of_the_encoder_beside_updates() {
    for (updates, lag, filter) in
        [(1, 1e-4, 3e-5), (2, 6e-5, 1e-4), (4, 3e-5, 5.3e-5), (4, 8e-5, 6.4e-5), (20, 5e-5, 6.4e-5)]
    {
        let sensor_lag = TimeRange::exactly(filter);
        let latency = Latency { sensor_lag, ..Latency::sampled(updates, lag, PERIOD) };
        let between = PERIOD / f64::from(updates);
        let later = (between * between / (8.0 * lag)).min(between);
        let delayed = Latency::delayed(between + later).with_actuator_lag(lag);
        let continuous = Latency { sensor_lag, ..delayed };
        for environment in [
            |stiffness| Wall::spring(stiffness, 1).alone(),
            |stiffness| Wall::spring(stiffness, 1).behind(0.0).alone(),
        ] {
            let found =
                largest(|it| Scene { environment: environment(it), ..spring(it, 1, latency) });
            assert!((found / limit(continuous) - 1.0).abs() < 1e-3, "{updates} {lag}: {found}");
        }
        let damped = |latency| {
            largest(|it| Scene {
                environment: Wall::damped(it, 1e-4, 1).alone(),
                ..spring(it, 1, latency)
            })
        };
        let (found, best) = (damped(latency), damped(continuous));
        let width = 1.0 + later / PERIOD;
        println!("{updates} {lag} {filter}: {found} of {best}");
        assert!(found <= best && found > 0.97 * best / width, "{updates}: {found} of {best}");
        let matched = Scene {
            coupling: Coupling::Matched,
            torque_limit: Some(1.0),
            environment: Wall::spring(1e3, 0).behind(0.0).alone(),
            ..spring(1.0, 0, latency)
        };
        assert!(certify(&matched).is_ok(), "{updates}: {:?}", certify(&matched).err());
    }
}

/// A loop of 2 kHz, four times as fast as a servo at 10 kHz: what its straight lines cost a spring.
#[test]
fn a_loop_of_two_kilohertz_is_nearly_its_continuous_lag() {
    let lag = 1.0 / (std::f64::consts::TAU * 2e3);
    let sampled = limit(Latency::sampled(4, lag, PERIOD));
    let continuous = limit(Latency::delayed(PERIOD / 4.0).with_actuator_lag(lag));
    println!("sampled {sampled} continuous {continuous}");
    assert!(sampled < continuous && sampled > 0.99 * continuous, "{sampled} {continuous}");
    // At rest: delta > K (T/2 + T + d + tau') + D K^2 / (4 delta), and D is below T^2 / 12.
    let left = (-PERIOD / 4.0 / lag).exp();
    let held = PERIOD / 8.0 * (1.0 + left) / (1.0 - left);
    let at_rest = 0.022 / (1.75 * PERIOD + held);
    assert!(sampled < at_rest && sampled > 0.97 * at_rest, "{sampled} {at_rest}");
}

#[test]
fn what_a_current_loop_in_updates_does_not_allow_is_refused_with_value_and_bound() {
    let fine = Latency::sampled(3, 8e-5, PERIOD);
    assert!(certify(&spring(20.0, 1, fine)).is_ok());
    let refused = |latency: Latency, parameter: Parameter, words: &[&str]| {
        let Err(Rejection::Invalid(invalid)) = certify(&spring(20.0, 1, latency)) else {
            panic!("{latency:?}")
        };
        assert_eq!(invalid.parameter, parameter);
        let message = Rejection::Invalid(invalid).to_string();
        assert!(words.iter().all(|word| message.contains(word)), "{message}");
    };
    let between = TimeRange::between;
    let delayed = |time: f64| Latency { output_delay: TimeRange::exactly(time), ..fine };
    let whole = "a whole number of the amplifier's updates, of which the nearest is at 0.00003333";
    refused(delayed(3.334e-5), Parameter::OutputDelay, &["0.00003334 s", whole]);
    refused(delayed(3.333_333_34e-5), Parameter::OutputDelay, &[whole]);
    assert!(certify(&spring(20.0, 1, delayed(3.333_333_333_3e-5))).is_ok());
    refused(
        Latency { output_delay: between(3.3e-5, 3.4e-5), ..fine },
        Parameter::OutputDelay,
        &["0.000034 s", "known exactly"],
    );
    for lag in [TimeRange::ZERO, between(0.0, 1e-5)] {
        let words = ["0 s", "greater than 0"];
        refused(Latency { actuator_lag: lag, ..fine }, Parameter::ActuatorLag, &words);
    }
    let beside = ["0.00001 s", "0 beside a lag of amplifier"];
    let response = between(0.0, 1e-5);
    refused(Latency { actuator_response: response, ..fine }, Parameter::ActuatorResponse, &beside);
    let scene = Scene {
        timing: Timing { period: PERIOD, worst_period: Some(2e-4) },
        ..spring(20.0, 1, fine)
    };
    let message = certify(&scene).unwrap_err().to_string();
    assert!(message.contains("that of the servo") && message.contains("0.0001 s"), "{message}");
    // Of a lag that lies in a range every value passes.
    let range = Latency { actuator_lag: between(7e-5, 8e-5), ..fine };
    let [one, other] = [range, fine].map(|it| assess(&spring(20.0, 1, it)).alpha_port.unwrap());
    assert!(one.hi() >= other.hi() && one.hi() < 1.1 * other.hi(), "{one:?} {other:?}");
}
