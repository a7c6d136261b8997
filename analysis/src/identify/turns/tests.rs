//! Slow turns of simulated devices with known friction and cogging, and records that are no such turns.

use haptic_servo::scene::{Device, EncoderReading};
use rayon::prelude::*;

use super::*;
use crate::disturbance::{Cogging, Disturbance, Sine};
use crate::identify::record::Pair;
use crate::identify::rig::{MeasuredDevice, Sensing};
use crate::identify::{IdentifyError, slow_turns};
use crate::simulation::plant::Plant;

const PERIOD: f64 = 1e-3;
const COUNTS: f64 = 16_384.0;

/// A gimbal motor with a magnetic encoder.
#[derive(Clone, Copy, Debug)]
struct Truth {
    device: Device,
    disturbance: Disturbance,
    linearity: f64,
    seed: u64,
}

impl Truth {
    /// Within the ranges of motors that one can buy.
    fn random(seed: u64) -> Self {
        let mut random = fastrand::Rng::with_seed(seed);
        let mut between = |least: f64, most: f64| least * (most / least).powf(random.f64());
        let device =
            Device { inertia: between(1e-5, 1e-4), damping: between(5e-4, 3e-3), passivity: None };
        let (friction, torque) = (between(1e-3, 8e-3), between(5e-4, 6e-3));
        let count = [36.0, 42.0, 84.0][random.usize(..3)];
        let cogging = Cogging::of(vec![Sine { torque, count, phase: 0.0 }]);
        let linearity = [0.0, 0.02, 0.04][random.usize(..3)];
        Self { device, disturbance: Disturbance { friction, cogging }, linearity, seed }
    }

    fn rig(&self) -> MeasuredDevice {
        let ideal = EncoderReading::IDEAL;
        let encoder = EncoderReading { linearity: self.linearity, noise: 2.0, ..ideal };
        let sensing = Sensing {
            disturbance: self.disturbance,
            encoder,
            torque_noise: 3e-4,
            seed: self.seed,
            ..Sensing::ideal(PERIOD, COUNTS)
        };
        MeasuredDevice::new(&Plant::rigid(self.device), &sensing).unwrap()
    }

    /// Amplitude in N m of a sine that turns it at up to this speed in rad/s.
    fn amplitude(&self, speed: f64) -> f64 {
        let Disturbance { friction, cogging } = self.disturbance;
        1.2 * (friction + cogging.torque()) + self.device.damping * speed
    }

    /// A record of slow sines of these amplitudes in N m; `acts` is the torque that the device gets of a torque.
    fn turned(&self, amplitudes: &[f64], acts: impl Fn(f64) -> f64) -> Record {
        let mut device = self.rig();
        let mut record = Record { period: PERIOD, torque: vec![], counts: vec![], frequency: None };
        for amplitude in amplitudes {
            for tick in 0..16_000 {
                let torque = amplitude * (TAU * f64::from(tick) / 8000.0).sin();
                record.torque.push(torque);
                record.counts.push(f64::from(device.count()));
                device.hold(acts(torque));
            }
        }
        record
    }

    fn found(&self) -> SlowTurns {
        let amplitudes = [3.0, 5.0, 9.0].map(|speed| self.amplitude(speed));
        let record = self.turned(&amplitudes, |torque| torque);
        slow_turns(&record, &Correction::of_encoder(COUNTS))
            .unwrap_or_else(|error| panic!("{self:?}: {error}"))
    }

    /// Cogging in N m where the encoder shows an angle in rad.
    fn cogging_at(&self, shown: f64) -> f64 {
        let inverse = (0..50).fold(shown, |angle, _| shown - self.linearity * f64::sin(angle));
        self.disturbance.cogging.at(inverse)
    }
}

fn holds(interval: &Estimate, truth: f64) -> bool {
    interval.lo <= truth && truth <= interval.hi
}

/// Whether every sample of a map is as near to the cogging as is said.
fn is_near(found: &SlowTurns, truth: &Truth) -> bool {
    let samples = found.map.len() as f64;
    let off = |(sample, torque): (usize, &f64)| {
        (torque - truth.cogging_at(TAU * sample as f64 / samples)).abs()
    };
    found.map.iter().enumerate().map(off).all(|off| off < found.uncertainty)
}

/// Over the angle of the device, what a nonlinear encoder spreads over harmonics is one again.
#[test]
fn the_cogging_of_a_simulation_is_that_of_the_motor() {
    let truth = Truth { linearity: 0.04, ..Truth::random(3) };
    let found = truth.found();
    assert!(found.harmonics.len() > 2, "{:?}", found.harmonics);
    let [Sine { torque, count, .. }, others @ ..] = &found.cogging(0.04)[..] else { panic!() };
    let cogging = truth.disturbance.cogging;
    assert_eq!(*count, cogging.highest());
    assert!((torque / cogging.torque() - 1.0).abs() < 0.15, "{torque} {cogging:?}");
    assert!(others.iter().all(|other| other.torque < 0.25 * torque), "{others:?}");
}

/// By `SLOW_TURNS=1000 cargo test -p analysis --lib intervals_hold -- --nocapture` of more devices.
#[test]
fn the_intervals_hold_random_truths() {
    let devices = std::env::var("SLOW_TURNS").map_or(24, |devices| devices.parse().unwrap());
    let of = |seed: u64| {
        let truth = Truth::random(seed);
        let found = truth.found();
        let Truth { device, disturbance, linearity, .. } = truth;
        // A nonlinear encoder spreads it over several harmonics.
        let cogging = found.harmonics.first().filter(|_| linearity == 0.0);
        [
            holds(&found.friction, disturbance.friction),
            found.least_friction.lo <= disturbance.friction,
            holds(&found.damping, device.damping),
            holds(&found.inertia, device.inertia),
            cogging.is_none_or(|it| holds(&it.amplitude, disturbance.cogging.torque())),
            is_near(&found, &truth),
            // A device with a tenth more friction, or with half of the inertia more, is another one.
            !holds(&found.friction, 1.1 * disturbance.friction),
            !holds(&found.inertia, 1.5 * device.inertia),
        ]
    };
    let all: Vec<[bool; 8]> = (0..devices).into_par_iter().map(of).collect();
    let hits: [usize; 8] = std::array::from_fn(|index| all.iter().filter(|it| it[index]).count());
    println!(
        "of {devices} devices, in the intervals of 95 %: friction {}, least friction {}, damping {}, inertia {}, \
         cogging {}, map {}; another friction told {}, another inertia {}",
        hits[0], hits[1], hits[2], hits[3], hits[4], hits[5], hits[6], hits[7]
    );
    assert!(hits.iter().all(|hits| 10 * hits >= 9 * devices as usize), "{hits:?}");
}

#[test]
fn a_record_that_is_no_such_turns_is_named() {
    let truth = Truth { linearity: 0.0, ..Truth::random(0) };
    let complaint = |record: &Record| {
        slow_turns(record, &Correction::of_encoder(COUNTS)).unwrap_err().to_string()
    };
    let amplitudes = [3.0, 5.0, 9.0].map(|speed| truth.amplitude(speed));
    let good = truth.turned(&amplitudes, |torque| torque);
    let same = |torque| torque;
    let [slow, fast] = [amplitudes[0], amplitudes[2]];
    let cases = [
        (truth.turned(&[0.9 * truth.disturbance.friction], same), "no whole turn in one direction"),
        (truth.turned(&[slow, slow], same), "friction is told from damping by at least three"),
        (
            Record { counts: good.counts.iter().map(|count| -count).collect(), ..good.clone() },
            "torque and counts have opposite signs",
        ),
        (
            truth.turned(&amplitudes, |torque| torque.clamp(-0.8 * fast, 0.8 * fast)),
            "the amplifier clips there",
        ),
        (
            Record {
                counts: good.counts.iter().map(|count| count.rem_euclid(COUNTS)).collect(),
                ..good.clone()
            },
            "the counter wraps",
        ),
    ];
    for (record, said) in cases {
        let complaint = complaint(&record);
        assert!(complaint.contains(said), "{said}: {complaint}");
    }
    let (torque, counts) = (good.torque[..3900].to_vec(), good.counts[..3900].to_vec());
    let one = Record { torque, counts, ..good };
    assert!(complaint(&one).contains("whole turns go forward"), "{}", complaint(&one));
}

/// Counts of two encoders on a shaft that turns at several speeds both ways, over time.
fn pair(age: f64, hysteresis: f64, error: impl Fn(f64) -> f64, seed: u64) -> Pair {
    const REFERENCE: f64 = 40_000.0;
    let mut random = fastrand::Rng::with_seed(seed);
    let mut pair = Pair { period: PERIOD, counts: vec![], reference: vec![] };
    let mut from = 0.3;
    for speed in [4.0, -4.0, 9.0, -9.0, 16.0, -16.0_f64] {
        let ticks = (2.2 * TAU / speed.abs() / PERIOD) as usize;
        for tick in 0..ticks {
            let at = |time: f64| from + speed * time;
            let time = tick as f64 * PERIOD;
            let old = at(time - age);
            let noise = 2.0 * (2.0 * random.f64() - 1.0);
            let shown = old + error(old) - 0.5 * hysteresis * speed.signum();
            pair.counts.push((shown / TAU * COUNTS + noise).floor());
            pair.reference.push((at(time) / TAU * REFERENCE).floor());
        }
        from += speed * ticks as f64 * PERIOD;
    }
    pair
}

#[test]
fn a_second_encoder_shows_the_slope_the_age_and_the_hysteresis() {
    let mut hits = [0; 4];
    for seed in 0..20 {
        let mut random = fastrand::Rng::with_seed(1000 + seed);
        let [first, second, fine] =
            [0.014, 0.006, 3e-4].map(|most| most * (0.4 + 0.6 * random.f64()));
        let (phase, age) = (TAU * random.f64(), 1.2e-4 * random.f64());
        let hysteresis = 4.0 * TAU / COUNTS * random.f64();
        let error =
            |x: f64| first * x.sin() + second * (2.0 * x + phase).sin() + fine * (64.0 * x).cos();
        let slope = |x: f64| {
            first * x.cos() + 2.0 * second * (2.0 * x + phase).cos()
                - 64.0 * fine * (64.0 * x).sin()
        };
        let steepest =
            (0..100_000).map(|k| slope(TAU * f64::from(k) / 1e5).abs()).fold(0.0, f64::max);
        let pair = pair(age, hysteresis, error, seed);
        let found = crate::identify::linearity(&pair, [COUNTS, 40_000.0]).unwrap();
        let found_age = found.age.unwrap();
        // The bound is no waste.
        assert!(found.slope.hi < 1.2 * steepest + 2e-3, "{steepest} {:?}", found.slope);
        hits[0] += usize::from(holds(&found.slope, steepest));
        hits[1] += usize::from(holds(&found_age, age));
        hits[2] += usize::from(holds(&found.hysteresis, hysteresis));
        hits[3] += usize::from(steepest <= found.slope.hi);
        assert!(found_age.hi - found_age.lo < 3e-5, "{found_age:?}");
    }
    println!("{hits:?}");
    assert!(hits.iter().all(|hits| *hits >= 17), "{hits:?}");
    let wrong = [COUNTS, 10_000.0];
    let error = crate::identify::linearity(&pair(0.0, 0.0, |_| 0.0, 1), wrong).unwrap_err();
    assert!(matches!(error, IdentifyError::Turns(TurnsError::NotOneShaft { .. })), "{error}");
}
