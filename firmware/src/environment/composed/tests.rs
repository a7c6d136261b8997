use fixed::types::I8F24;
use proptest::prelude::*;

use super::*;
use crate::certificate::{certify, certify_in, certify_scene, scene_data};
use crate::encoder::{CounterWidth, RawCount};
use crate::environment::{Ends, EnvironmentModel, Knots, Matched, Shape};
use crate::number::Format;
use crate::passivity::interval::Interval;
use crate::scene::{Coupling, Device, Latency, Scene, Timing};
use crate::servo::{Servo, Transducers};

static ENDLESS: Knots<16> = Knots::of(&[Shape::detents(24, 0.02)]);
static KNOB: Knots<16> = Knots::of(&[Shape::detents(24, 0.02), Shape::end_stops(-2.0, 2.0, 5.0)]);

const DAMPING: f64 = 0.022;
const PERIOD: f64 = 0.001;
const WALL: DamperWall<1> = DamperWall { stiffness: 5.0, damping: 0.002 };
const LATE: DamperWall<2> = DamperWall { stiffness: 3.0, damping: 0.001 };
const UNDELAYED: DamperWall<0> = DamperWall { stiffness: 30.0, damping: 0.002 };

const TRANSDUCERS: Transducers = Transducers {
    counts_per_turn: 61_440.0,
    counter: CounterWidth::Bits32,
    full_scale_torque: 1.0,
    largest_speed: 100.0,
};

fn scene<E>(environment: E) -> Scene<E> {
    Scene {
        device: Device { inertia: 2.2e-5, damping: DAMPING, passivity: None },
        timing: Timing { period: PERIOD, worst_period: None },
        coupling: Coupling::Spring { stiffness: 44.0 },
        environment,
        latency: Latency::NONE,
        torque_limit: Some(0.5),
    }
}

fn knob<const N: usize>() -> Profile<16, N> {
    Profile::of(&KNOB)
}

fn behind<W: Copy>(wall: W) -> OneSided<W> {
    OneSided { face: 0.3, wall }
}

/// Whether both give the same codes at these counts.
fn is_same<N: Number, E: EnvironmentModel + Discretize<N>>(
    scene: Scene<E>,
    counts: &[i32],
) -> bool {
    let data = certify_scene(scene_data(&scene), N::FORMAT).unwrap_or_else(|why| panic!("{why}"));
    let typed = certify_scene(scene, N::FORMAT).unwrap();
    let mut typed: Servo<E, N> = Servo::new(&typed, &TRANSDUCERS).unwrap();
    let mut data: Servo<Environment, N> = Servo::new(&data, &TRANSDUCERS).unwrap();
    counts.iter().all(|&count| {
        let raw = RawCount::from(count.cast_unsigned());
        typed.tick(raw) == data.tick(raw) && typed.torque_nm() == data.torque_nm()
    })
}

fn every_type_is_its_data<N: Number>(counts: &[i32]) {
    let endless = Profile::<16, 1>::of(&ENDLESS);
    let residual = 0.018;
    assert!(is_same::<N, _>(scene(FreeModeProfile { residual, profile: endless }), counts));
    assert!(is_same::<N, _>(scene(FreeModeProfile { residual, profile: knob::<2>() }), counts));
    let spring = DelayedSpring::<3> { stiffness: 2.0 };
    let profile = knob::<2>();
    assert!(is_same::<N, _>(scene(WallAndProfile { wall: spring, profile }), counts));
    assert!(is_same::<N, _>(scene(WallAndProfile { wall: behind(spring), profile }), counts));
    assert!(is_same::<N, _>(scene(WallAndProfile { wall: WALL, profile }), counts));
    assert!(is_same::<N, _>(scene(WallAndProfile { wall: behind(UNDELAYED), profile }), counts));
    let matched = |environment| Scene {
        coupling: Coupling::Matched,
        latency: Latency { output_jitter: 1e-6, ..Latency::delayed(2e-4) },
        ..scene(Matched::<_, 0, 0> { environment })
    };
    let wall = behind(UNDELAYED);
    assert!(is_same::<N, _>(matched(FreeModeWallAndProfile { residual, wall, profile }), counts));
    let all = |wall| scene(FreeModeWallAndProfile { residual, wall, profile });
    assert!(is_same::<N, _>(all(behind(LATE)), counts));
    let scene = scene(FreeModeWallAndProfile { residual, wall: spring, profile });
    assert!(is_same::<N, _>(scene, counts));
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(32))]

    /// Across faces, end stops and turns.
    #[test]
    fn a_type_gives_the_torques_of_its_data(
        steps in prop::collection::vec(prop_oneof![-40..40_i32, -4_000..4_000_i32], 400),
    ) {
        let walk = |count: &mut i32, step: &i32| {
            *count = (*count + step).clamp(-600_000, 600_000);
            Some(*count)
        };
        let counts: Vec<i32> = steps.iter().scan(0, walk).collect();
        every_type_is_its_data::<f64>(&counts);
        every_type_is_its_data::<f32>(&counts);
        every_type_is_its_data::<I8F24>(&counts);
    }
}

/// Slope in N m/rad of the detents, `4 n F / (2 pi)`, by which they rise and fall.
const SLOPE: f64 = 4.0 * 24.0 * 0.02 / core::f64::consts::TAU;

fn bound(environment: Environment) -> Interval {
    certify(&scene(environment)).unwrap_or_else(|why| panic!("{why}")).bound.unwrap()
}

/// Computed by hand: `K T (n - 1/2) + B` of a wall, nothing of one without delay, what is cancelled, and
/// `T (L/2 + (n - 1) M)`, where the end stops are the steepest rise, and the detents are beside them.
#[test]
fn indices_add() {
    let detents = |n: f64| PERIOD * SLOPE * (n - 0.5);
    let stops = |n: f64| PERIOD * (2.5 + (n - 1.0) * 5.0);
    let residual = 0.015;
    let cancelled = DAMPING - residual;
    let endless = Profile::<16, 2>::of(&ENDLESS);
    let free = FreeModeProfile { residual, profile: endless };
    let late = |k: f64, n: f64, b: f64| k * PERIOD * (n - 0.5) + b;
    for (environment, expected) in [
        (free.as_data(), cancelled + detents(2.0)),
        (
            WallAndProfile { wall: WALL, profile: knob::<1>() }.as_data(),
            late(5.0, 1.0, 0.002) + stops(1.0),
        ),
        (
            WallAndProfile { wall: behind(LATE), profile: knob::<1>() }.as_data(),
            late(3.0, 2.0, 0.001) + stops(1.0),
        ),
        (WallAndProfile { wall: behind(UNDELAYED), profile: knob::<2>() }.as_data(), stops(2.0)),
        (
            FreeModeWallAndProfile { residual, wall: behind(LATE), profile: knob::<1>() }.as_data(),
            cancelled + late(3.0, 2.0, 0.001) + stops(1.0),
        ),
    ] {
        let found = bound(environment);
        // A knot is a whole number of units.
        assert!((found.midpoint() / expected - 1.0).abs() < 1e-3, "{found:?} {expected}");
        assert!(found.hi() - found.lo() < 1e-9 * expected, "{found:?}");
    }
}

/// The rule at the port: `T (L/2 + (n + e) M)` and `K T (1/2 + n + e)`, and a ripple of both slopes.
#[test]
fn without_a_coupling_the_springs_add() {
    let (n, e) = (1.0, 0.3);
    let wall = DelayedSpring::<1> { stiffness: 2.0 };
    let environment = WallAndProfile { wall, profile: knob::<1>() };
    let at_port =
        |latency| Scene { coupling: Coupling::Rigid, latency, ..scene(environment.as_data()) };
    for (latency, e) in [(Latency::NONE, 0.0), (Latency::delayed(e * PERIOD), e)] {
        let found = certify(&at_port(latency)).unwrap_or_else(|why| panic!("{why}")).bound.unwrap();
        let slopes: f64 = 5.0 + 2.0;
        let expected = PERIOD * (0.5 + n + e) * slopes
            + e * (1.0 - e) * (PERIOD * slopes).powi(2) / (4.0 * DAMPING);
        assert!((found.midpoint() / expected - 1.0).abs() < 1e-9, "{found:?} {expected}");
    }
}

fn refusal(environment: Environment, coupling: Coupling) -> String {
    certify(&Scene { coupling, ..scene(environment) }).unwrap_err().sentence().as_str().to_owned()
}

#[test]
fn what_has_no_proof_is_refused_with_a_sentence() {
    let spring = Coupling::Spring { stiffness: 44.0 };
    let undelayed = FreeModeProfile { residual: 0.01, profile: Profile::<16, 0>::of(&ENDLESS) };
    assert_eq!(
        refusal(undelayed.as_data(), spring),
        "rejected: the delay is 0 samples, and must be at least 1 where a wall or a canceller is beside the \
         torque profile"
    );
    let endless = WallAndProfile { wall: behind(WALL), profile: Profile::<16, 1>::of(&ENDLESS) };
    assert_eq!(
        refusal(endless.as_data(), spring),
        "rejected: the face is 0.3 rad, and must be beside a torque profile with end stops: one without them \
         repeats in every turn, and a wall stands in one of them"
    );
    let pulling =
        WallAndProfile { wall: DamperWall::<1> { stiffness: -1.0, ..WALL }, profile: knob::<1>() };
    assert!(
        refusal(pulling.as_data(), spring).contains("pulls away at rest like a negative spring")
    );
    let rigid = "no bound is known for a torque profile that no coupling separates from a damper, a canceller,";
    for environment in [
        FreeModeProfile { residual: 0.015, profile: knob::<1>() }.as_data(),
        WallAndProfile { wall: WALL, profile: knob::<1>() }.as_data(),
    ] {
        let sentence = refusal(environment, Coupling::Rigid);
        assert!(sentence.contains(rigid), "{sentence}");
    }
    let mut soft = knob::<1>();
    soft.ends = Some(Ends { from: -2.0, to: 2.0, stiffness: -1.0 });
    let sentence = refusal(WallAndProfile { wall: WALL, profile: soft }.as_data(), spring);
    assert!(sentence.ends_with("must be greater than 0 beyond end stops"), "{sentence}");
}

/// Each remedy is certified, and the one of a sum is of its parts by name.
#[test]
fn remedies_name_the_parts() {
    let wall = DamperWall::<1> { stiffness: 20.0, damping: 0.002 };
    let all = FreeModeWallAndProfile { residual: 0.012, wall, profile: knob::<1>() };
    let scene = scene(all.as_data());
    let rejection = certify(&scene).unwrap_err();
    let remedies: Vec<_> = rejection.remedies().iter().collect();
    for (parameter, is_there) in
        [(Parameter::Stiffness, true), (Parameter::Residual, true), (Parameter::Damping, false)]
    {
        let found = remedies.iter().any(|remedy| remedy.parameter == parameter);
        assert_eq!(found, is_there, "{parameter:?}: {rejection}");
    }
    for remedy in remedies {
        for value in [remedy.lowest, remedy.highest].into_iter().flatten() {
            let changed = scene.with(remedy.parameter, value).unwrap();
            assert!(certify(&changed).is_ok(), "{remedy}");
        }
    }
}

#[test]
fn names_are_of_the_part_that_the_documentation_says() {
    let mut all =
        FreeModeWallAndProfile { residual: 0.012, wall: behind(WALL), profile: knob::<1>() };
    let data = all.as_data();
    for (parameter, expected) in [
        (Parameter::Stiffness, 5.0),
        (Parameter::Damping, 0.002),
        (Parameter::Face, 0.3),
        (Parameter::Residual, 0.012),
        (Parameter::ProfileTorque, 0.02),
        (Parameter::Count, 24.0),
        (Parameter::From, -2.0),
    ] {
        assert_eq!(all.value(parameter).copied(), Some(expected), "{parameter:?}");
        assert_eq!(data.get(parameter), Some(expected), "{parameter:?}");
        assert_eq!(data.with(parameter, 1.0).unwrap().get(parameter), Some(1.0), "{parameter:?}");
    }
    let free = FreeModeProfile { residual: 0.012, profile: knob::<1>() };
    assert_eq!(free.as_data().get(Parameter::Stiffness), Some(5.0));
}

/// The gains that solve a tick are rounded; so are all other coefficients.
#[test]
fn every_format_has_nearly_the_same_bound() {
    let all = FreeModeWallAndProfile { residual: 0.012, wall: behind(LATE), profile: knob::<1>() };
    let scene = scene(all.as_data());
    let exact = certify(&scene).unwrap().bound.unwrap();
    for format in [Format::F32, Format::Fixed { fraction_bits: 24 }] {
        let found = certify_in(&scene, format).unwrap().bound.unwrap();
        assert!((found.hi() / exact.hi() - 1.0).abs() < 1e-4, "{found:?} {exact:?}");
    }
}
