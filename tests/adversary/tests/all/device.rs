//! The held device against an independent exponential of the same chain, and its energies against
//! each other.

use adversary::device::{AMPLIFIED, HeldDevice, Lags, SENSED, TORQUE};
use adversary::plan::Readings;
use adversary::scenes::{self, Choice};
use nalgebra::DVector;
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use tests::hands::Hand;
use tests::plant::Plant;

/// A hand whose stiffness and inertia are such that both exponentials are exact to many digits.
fn draw(rng: &mut ChaCha8Rng) -> Hand {
    let mut hand = Hand::draw(rng);
    hand.inertia = hand.inertia.max(0.05);
    hand.damping = hand.damping.min(1.0);
    hand.stiffness = hand.stiffness.min(10.0);
    for segment in &mut hand.segments {
        segment.inertia = segment.inertia.max(0.05);
        segment.link_stiffness = segment.link_stiffness.min(10.0);
        segment.link_damping = segment.link_damping.min(1.0);
        segment.stiffness = segment.stiffness.min(10.0);
        segment.damping = segment.damping.min(1.0);
    }
    hand
}

#[test]
fn a_held_device_moves_as_the_reference_does() {
    let mut rng = ChaCha8Rng::seed_from_u64(7);
    for _ in 0..500 {
        let hand = draw(&mut rng);
        let (plant, held) = (Plant::new(&hand), HeldDevice::new(&hand, 1.0, &Lags::default()));
        let masses = 1 + hand.segments.len();
        let mut x = [0.0; 8];
        x[..2 * masses].fill_with(|| rng.random_range(-1.0..1.0));
        x[TORQUE] = rng.random_range(-1.0..1.0);
        // The reference has every position against the ground.
        let absolute = |x: &[f64; 8]| {
            let position = |i: usize| (0..=i).map(|j| x[2 * j]).sum::<f64>();
            DVector::from_fn(2 * masses, |k, _| if k % 2 == 0 { position(k / 2) } else { x[k] })
        };
        let expected = &plant.a * absolute(&x) + &plant.b * x[TORQUE];
        let energy = (held.energy(&x) - plant.energy(&absolute(&x))).abs();
        assert!(energy <= 1e-12 * (1.0 + held.energy(&x)), "{energy} {hand:?}");
        // In one piece, and in two.
        let mut pieces = x;
        held.step(0.3).advance(&mut pieces);
        held.step(0.7).advance(&mut pieces);
        let (whole, start) = (held.audited(1.0), x);
        let taken = whole.taken(&x);
        let (squared, _) = whole.advance(&mut x);
        let size = 1.0 + expected.amax();
        for moved in [x, pieces] {
            let error = (absolute(&moved) - &expected).amax();
            assert!(error <= 1e-9 * size, "{error} {hand:?}");
        }
        // Nothing is lost: the work of the torque is in the masses, the springs and the dampers.
        let work = start[TORQUE] * (x[0] - start[0]);
        let gained = held.energy(&x) - held.energy(&start);
        let lost = work - gained - taken - squared;
        assert!(lost.abs() <= 1e-9 * (held.energy(&start) + 1.0), "{lost} {hand:?}");
    }
}

/// The lags against their solutions in closed form, the position that the sensor follows by quadrature.
#[test]
fn amplifier_and_sensor_lag_as_their_time_constants_say() {
    const PIECES: u32 = 2000;
    let mut rng = ChaCha8Rng::seed_from_u64(8);
    for _ in 0..30 {
        let mut hand = draw(&mut rng);
        hand.segments.truncate(1);
        let (amplifier, sensor) = (rng.random_range(0.05..2.0), rng.random_range(0.05..2.0));
        let held = HeldDevice::new(&hand, 1.0, &Lags { amplifier, updates: 0, sensor });
        let mut x = [0.0; 8];
        x.fill_with(|| rng.random_range(-1.0..1.0));
        x[SENSED + 1] = 0.0;
        let (start, mut fine) = (x, x);
        // exp(-(1 - t) / sensor) x(t) / sensor, by Simpson's rule.
        let (step, part) = (held.step(0.5 / f64::from(PIECES)), 1.0 / f64::from(PIECES));
        let weigh = |x: &[f64; 8], t: f64| ((t - 1.0) / sensor).exp() * x[0] / sensor;
        let mut sensed = start[SENSED] * (-1.0 / sensor).exp();
        for i in 0..PIECES {
            let t = f64::from(i) * part;
            let mut sum = weigh(&fine, t);
            step.advance(&mut fine);
            sum += 4.0 * weigh(&fine, t + 0.5 * part);
            step.advance(&mut fine);
            sensed += (sum + weigh(&fine, t + part)) * part / 6.0;
        }
        let whole = held.audited(1.0);
        let taken = whole.taken(&x);
        let (squared, work) = whole.advance(&mut x);
        let left = (-1.0 / amplifier).exp();
        let amplified = start[TORQUE] + (start[AMPLIFIED] - start[TORQUE]) * left;
        let size = 1.0 + x.iter().fold(0.0_f64, |size, x| size.max(x.abs()));
        assert!((x[AMPLIFIED] - amplified).abs() <= 1e-9 * size, "{amplifier} {hand:?}");
        assert!((x[SENSED] - sensed).abs() <= 1e-6 * size, "{sensor} {hand:?}");
        let lost = work - (held.energy(&x) - held.energy(&start)) - taken - squared;
        assert!(lost.abs() <= 1e-9 * size * size * (1.0 + held.energy(&start)), "{lost} {hand:?}");
    }
}

/// The error of an encoder behind its filter, on a cubic path, against Simpson's rule.
#[test]
fn an_error_is_filtered_as_the_time_constant_says() {
    const PIECES: u32 = 2000;
    let readings = Readings { waves: [7.0, 0.01, 0.4], ..Readings::default() };
    let (part, lag, c) = (0.0625, 0.03, [0.2, 1.1, -3.0, 20.0]);
    let path = |t: f64| {
        let [x, v, a, j] = c;
        [x + t * (v + t * (a + t * j)), v + t * (2.0 * a + 3.0 * t * j)]
    };
    let rate = |t: f64| ((t - part) / lag).exp() * readings.error(path(t)[0]) / lag;
    let length = part / f64::from(PIECES);
    let pieces = (0..PIECES).map(|i| f64::from(i) * length);
    let simpson = |t: f64| rate(t) + 4.0 * rate(t + 0.5 * length) + rate(t + length);
    let sum: f64 = pieces.map(simpson).sum::<f64>() * length / 6.0;
    let exact = 0.003 * (-part / lag).exp() + sum;
    let filtered = readings.filtered(0.003, [path(0.0), path(part)], part, lag);
    assert!((filtered - exact).abs() < 1e-6 * readings.waves[1], "{filtered} {exact}");
}

/// Scenes whose encoders err before a filter, and have noise, are accepted, too.
#[test]
fn a_filter_stands_behind_errors_and_noise() {
    let (mut both, mut noisy) = (0, 0);
    for number in 0..400 {
        let mut rng = ChaCha8Rng::seed_from_u64(1);
        rng.set_stream(number);
        let Some(drawn) = scenes::draw(&mut rng, &Choice { latency: Some(true), ..Choice::ANY })
        else {
            continue;
        };
        let latency = drawn.scene.latency;
        noisy += u32::from(latency.encoder.noise > 0.0);
        both += u32::from(latency.encoder.linearity > 0.0 && !latency.sensor_lag.is_zero());
    }
    assert!(both > 0 && noisy > 10, "{both} {noisy}");
}
