//! The controller that the certificate judges is the controller that a servo computes: to 1e-11 the same
//! torques, where the coefficients' rounding alone makes a difference of 1e-10 to 1e-5.

use super::*;
use crate::certificate::{LoopTransfers, QuantizationBound, Resolution};
use crate::latency::TimeRange;
use crate::matched::MatchedCoupling;
use crate::number::{Format, OutOfRange, Rounding};
use crate::passivity::polynomial::{Polynomial, UnitRoot};
use crate::passivity::transfer::Transfer;

/// The servo's arithmetic in f64 with the coefficients of another format, so that nothing but
/// their rounding is left of it.
macro_rules! coarse {
    ($name:ident, $format:expr) => {
        #[derive(Clone, Copy, Debug, Default, PartialEq, PartialOrd)]
        struct $name(f64);

        impl Number for $name {
            type Coefficient = f64;
            const FORMAT: Format = $format;
            const ZERO: Self = Self(0.0);

            fn from_f64(value: f64) -> Result<Self, OutOfRange> {
                Ok(Self(value))
            }
            fn bound_from_f64(value: f64) -> Result<Self, OutOfRange> {
                Ok(Self(value))
            }
            fn to_f64(self) -> f64 {
                self.0
            }
            fn coefficient(value: f64) -> Result<f64, OutOfRange> {
                Ok($format.coefficient(value, Rounding::Nearest))
            }
            fn coefficient_to_f64(coefficient: f64) -> f64 {
                coefficient
            }
            fn plus(self, other: Self) -> Self {
                Self(self.0 + other.0)
            }
            fn minus(self, other: Self) -> Self {
                Self(self.0 - other.0)
            }
            fn times(self, coefficient: f64) -> Self {
                Self(self.0 * coefficient)
            }
            fn negated(self) -> Self {
                Self(-self.0)
            }
            fn within(self, bound: Self) -> bool {
                self.0.abs() <= bound.0
            }
            fn positive_part(self) -> Self {
                Self(self.0.max(0.0))
            }
            fn angle_scale(radians_per_count: f64) -> Result<f64, OutOfRange> {
                Ok($format.coefficient(radians_per_count, Rounding::Inward))
            }
            fn angle(count: i32, scale: f64) -> (Self, bool) {
                (Self(f64::from(count) * scale), true)
            }
            fn parts_scale(parts_per_rad: f64) -> Result<f64, OutOfRange> {
                Ok($format.parts_per_rad(parts_per_rad))
            }
            fn parts(self, scale: f64) -> i32 {
                (self.0 * scale).round() as i32
            }
            fn part_scale(torque: f64) -> Result<f64, OutOfRange> {
                Ok($format.torque_of_part(torque))
            }
            fn of_parts(parts: i32, scale: f64) -> Self {
                Self(f64::from(parts) * scale)
            }
            fn code_scale(codes_per_torque: f64) -> Result<f64, OutOfRange> {
                Ok(codes_per_torque)
            }
            fn codes_below(self, _: u16, _: f64) -> u16 {
                0
            }
        }
    };
}

coarse!(AsF32, Format::F32);
// Smaller compliances have fewer digits here: the binary point moves 31 places and no more.
coarse!(AsFixed, Format::Fixed { fraction_bits: 24 });
coarse!(AsFixed16, Format::Fixed { fraction_bits: 16 });

/// Descending coefficients, the zeros at 1 multiplied out.
fn descending(p: &Polynomial, ones: i32) -> Vec<f64> {
    let p = p.times_unit_root(UnitRoot::Plus, ones as usize).unwrap();
    (0..p.len()).rev().map(|i| p.coefficient(i).midpoint()).collect()
}

/// The first samples of a causal transfer function's impulse response.
fn response(g: &Transfer) -> Vec<f64> {
    assert!(g.shift >= 0 && g.minus_ones == 0);
    let denominator = descending(&g.denominator, 0);
    let mut numerator = descending(&g.numerator, g.ones);
    numerator.resize(numerator.len() + g.shift as usize, 0.0);
    let late = denominator.len() - numerator.len();
    let numerator = [vec![0.0; late], numerator].concat();
    let scale = g.scale.midpoint();
    impulse_response(&numerator, &denominator, TICKS).iter().map(|h| h * scale).collect()
}

/// Largest difference of the servo's torques to a controller's, over the largest torque.
fn difference<N: Number>(scene: &Scene, format: Format) -> f64 {
    let strong = Transducers { full_scale_torque: 1e9, ..TRANSDUCERS };
    let mut servo = Servo::<Environment, N>::build(scene, &strong).unwrap();
    let response = response(&LoopTransfers::in_format(scene, format).unwrap().controller);
    let scale = core::f64::consts::TAU / TRANSDUCERS.counts_per_turn;
    let scale = N::FORMAT.coefficient(scale, Rounding::Inward);
    let counts: Vec<i32> = hand().step_by(3).take(TICKS).collect();
    let mut largest = (0.0_f64, 0.0_f64);
    for k in 0..TICKS {
        servo.tick(RawCount::from(counts[k]));
        let angles = counts[..=k].iter().rev().map(|&count| f64::from(count) * scale);
        let wanted: f64 = angles.zip(&response).map(|(x, h)| x * h).sum();
        let error = (servo.torque_nm() - wanted).abs();
        largest = (largest.0.max(error), largest.1.max(wanted.abs()));
    }
    largest.0 / largest.1
}

fn check<N: Number>(scene: &Scene) {
    let (as_it_runs, as_written) =
        (difference::<N>(scene, N::FORMAT), difference::<N>(scene, Format::F64));
    assert!(as_it_runs < 1e-11, "{as_it_runs:e} {scene:?}");
    assert!(as_written > 1e-10, "{as_written:e} {scene:?}");
}

/// Environments of every kind, with numbers that no format has exactly.
fn environments() -> [Environment; 16] {
    let filtered = Wall::damped(17.3, 0.0071, 1).filtered(0.37);
    let coefficients = |c: &[f64]| Coefficients::new(c).unwrap();
    let rational = |delay, unit_zeros| {
        Environment::Rational(Rational {
            numerator: coefficients(&[13.1, -7.7]),
            denominator: coefficients(&[1.3, -0.31, 0.17]),
            delay,
            unit_zeros,
        })
    };
    [
        Wall::spring(17.3, 1).alone(),
        Wall::spring(17.3, 0).alone(),
        Wall::damped(17.3, 0.0071, 2).alone(),
        Wall::damped(17.3, 0.0071, 0).alone(),
        filtered.alone(),
        Wall { delay: 0, ..filtered }.alone(),
        Wall { stiffness: 0.0, ..filtered }.alone(),
        Canceller { residual: 0.0013, delay: 0 }.alone(),
        Canceller { residual: 0.0013, delay: 1 }.alone(),
        Canceller { residual: 0.0253, delay: 0 }.alone(),
        free_mode_wall(0.0157, Wall::damped(17.3, 0.0013, 1)),
        free_mode_wall(0.0157, filtered),
        free_mode_wall(0.0157, Wall::damped(17.3, 0.0013, 0)),
        rational(0, 0),
        rational(2, 1),
        rational(0, 1),
    ]
}

#[test]
fn the_certificate_judges_what_the_servo_computes() {
    for environment in environments() {
        for coupling in [Coupling::Spring { stiffness: 37.3 }, Coupling::Rigid] {
            let scene = Scene { coupling, ..scene(environment) };
            check::<AsF32>(&scene);
            // Numbers of a device that is a thousand times stronger and heavier: its compliance
            // keeps only some of the digits. Without it, fixed point is exact to 1e-9.
            if let Coupling::Spring { stiffness } = coupling {
                check::<AsFixed>(&Scene {
                    coupling: Coupling::Spring { stiffness: stiffness * 1e3 },
                    ..scene
                });
            }
        }
    }
}

/// Largest difference of the torques in a format to those of exact arithmetic with the same
/// coefficients, over what the certificate allows for the rounding of numbers.
fn rounding<N: Number, Exactly: Number>(scene: &Scene) -> f64 {
    let strong = Transducers { full_scale_torque: 30.0, ..TRANSDUCERS };
    let mut rounded = Servo::<Environment, N>::build(scene, &strong).unwrap();
    let mut exact = Servo::<Environment, Exactly>::build(scene, &strong).unwrap();
    let mut most = 0.0_f64;
    for count in hand() {
        // About a third of a turn from zero, where a float has fewer digits.
        for servo in [&mut rounded as &mut dyn Ticks, &mut exact] {
            servo.step(count + 20_000);
        }
        most = most.max((rounded.torque_nm() - exact.torque_nm()).abs());
    }
    most / QuantizationBound::of(scene, N::FORMAT, &Resolution::of(&strong, None)).unwrap().numbers
}

trait Ticks {
    fn step(&mut self, count: i32);
}

impl<N: Number> Ticks for Servo<Environment, N> {
    fn step(&mut self, count: i32) {
        self.tick(RawCount::from(count));
    }
}

#[test]
fn rounding_moves_the_torque_by_no_more_than_the_certificate_says() {
    let mut largest = [0.0_f64; 2];
    for environment in environments() {
        let scene = Scene { coupling: Coupling::Spring { stiffness: 37.3 }, ..scene(environment) };
        let found = [rounding::<FixedI32<U16>, AsFixed16>(&scene), rounding::<f32, AsF32>(&scene)];
        for (most, share) in largest.iter_mut().zip(found) {
            assert!(share <= 1.0, "{share} {environment:?}");
            *most = most.max(share);
        }
    }
    // It is a bound that something comes near to.
    assert!(largest.iter().all(|&share| share > 0.02), "{largest:?}");
}

/// Position errors of half a count, each to the side that moves the torque most, move it by the
/// certificate's bound for the encoder.
#[test]
fn an_encoder_moves_the_torque_by_as_much_as_the_certificate_says() {
    for environment in environments() {
        let scene = Scene { coupling: Coupling::Spring { stiffness: 37.3 }, ..scene(environment) };
        let response = response(&LoopTransfers::of(&scene).unwrap().controller);
        let worst: f64 = response.iter().map(|h| h.abs() * 0.5e-4).sum();
        let steps = Resolution { encoder: Some(1e-4), ..Resolution::default() };
        let said = QuantizationBound::of(&scene, Format::F64, &steps).unwrap().encoder.unwrap();
        assert!((said - worst).abs() <= 1e-8 * said, "{said} {worst} {environment:?}");
    }
}

/// Behind the coupling that absorbs delays of several samples and a lag.
fn lagging_scenes() -> impl Iterator<Item = Scene> {
    let delays = [0.0, 4e-4, 2.3e-3];
    let lags = [0.0, 3e-4];
    let latencies = delays
        .into_iter()
        .flat_map(move |delay| lags.map(|lag| Latency::delayed(delay).with_actuator_lag(lag)));
    let in_updates = Latency::sampled(4, 3e-4, 1e-3);
    let later = Latency { output_delay: TimeRange::exactly(2.25e-3), ..in_updates };
    latencies.chain([in_updates, later]).flat_map(|latency| {
        let lagging =
            move |environment| Scene { coupling: Coupling::Matched, latency, ..scene(environment) };
        environments().map(lagging)
    })
}

/// The coupling's memory rounds, too.
#[test]
fn so_does_rounding_behind_the_matched_coupling() {
    let (mut judged, mut largest) = (0, 0.0_f64);
    for scene in lagging_scenes() {
        let finite = |format| QuantizationBound::of(&scene, format, &Resolution::default());
        if finite(Format::F32).is_none() || finite(<FixedI32<U16>>::FORMAT).is_none() {
            continue;
        }
        let found = [rounding::<FixedI32<U16>, AsFixed16>(&scene), rounding::<f32, AsF32>(&scene)];
        for share in found {
            assert!(share <= 1.0, "{share} {scene:?}");
            largest = largest.max(share);
        }
        judged += 1;
    }
    assert!(judged > 50 && largest > 0.02, "{judged} {largest}");
}

#[test]
fn so_does_an_encoder_behind_the_matched_coupling() {
    for scene in lagging_scenes() {
        let steps = Resolution { encoder: Some(1e-4), ..Resolution::default() };
        let Some(said) = QuantizationBound::of(&scene, Format::F64, &steps) else { continue };
        let response = response(&LoopTransfers::of(&scene).unwrap().controller);
        let worst: f64 = response.iter().map(|h| h.abs() * 0.5e-4).sum();
        let said = said.encoder.unwrap();
        assert!(worst <= said * (1.0 + 1e-8) && worst > 0.9 * said, "{said} {worst} {scene:?}");
    }
}

/// The most that the deflection can be, from the coupling's response itself.
#[test]
fn the_largest_deflection_is_that_of_a_torque_that_stays() {
    let near = Latency {
        sensor_lag: TimeRange::exactly(5.1e-3),
        ..Latency::delayed(1e-3).with_actuator_lag(5e-3)
    };
    for (latency, error) in [
        (Latency::delayed(2.3e-3).with_actuator_lag(3e-4), 1e-12),
        (Latency::delayed(1e-3), 1e-12),
        (Latency::NONE.with_actuator_lag(5e-3), 1e-12),
        // The trails of near lags are large, of opposite signs.
        (near, 1e-8),
    ] {
        let coupling = MatchedCoupling::of(1e-3, None, 0.022, &latency, Format::F64).unwrap();
        let lags = latency.actuator_lag.most + latency.sensor_lag.most;
        let total = latency.output_delay.most + lags + 1e-3;
        let found = coupling.compliance_at_rest().hi();
        assert!((found * 2.0 * 0.022 / total - 1.0).abs() < error, "{found} {latency:?}");
    }
    // In the numbers of a board, some of the last compliances may be negative.
    let equal =
        Latency { sensor_lag: TimeRange::exactly(5e-3), ..Latency::NONE.with_actuator_lag(5e-3) };
    let coupling = MatchedCoupling::of(1e-3, None, 0.022, &equal, Format::F32).unwrap();
    let mut trails = coupling.trails.map(|trail| trail.gain);
    let mut sum = coupling.compliance + coupling.arriving;
    for _ in 0..1000 {
        sum += trails.iter().sum::<f64>().abs();
        for (left, trail) in trails.iter_mut().zip(&coupling.trails) {
            *left *= trail.decay;
        }
    }
    let found = coupling.compliance_at_rest().hi();
    assert!(sum <= found && found < 1.1 * sum, "{sum} {found}");
    // An amplifier in updates is later by what its straight lines are.
    let in_updates = Latency::sampled(4, 3e-4, 1e-3);
    let coupling = MatchedCoupling::of(1e-3, None, 0.022, &in_updates, Format::F64).unwrap();
    let left = f64::exp(-2.5e-4 / 3e-4);
    let total = 1e-3 + 2.5e-4 + 1.25e-4 * (1.0 + left) / (1.0 - left);
    let found = coupling.compliance_at_rest().hi();
    assert!((found * 2.0 * 0.022 / total - 1.0).abs() < 1e-12, "{found}");
}
