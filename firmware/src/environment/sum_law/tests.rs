use fixed::types::I8F24;

use crate::certificate::{
    Certified, Parameter, QuantizationBound, Resolution, TimingChecked, certify, certify_in,
    certify_scene, timing_checked,
};
use crate::encoder::RawCount;
use crate::environment::{Canceller, Drag, Ends, Environment, Knots, Parts, Profile, Shape, Wall};
use crate::number::Format;
use crate::parameter::NamedParameters;
use crate::passivity::interval::Interval;
use crate::scene::{Coupling, Latency, Scene, TimeRange, Timing};
use crate::servo::{AtPhase, Latched, Servo};
use crate::test_scene::{self, TRANSDUCERS, largest_error};

static ENDLESS: Knots<16> = Knots::of(&[Shape::detents(24, 0.02)]);
static KNOB: Knots<16> = Knots::of(&[Shape::detents(24, 0.02), Shape::end_stops(-2.0, 2.0, 5.0)]);

const DAMPING: f64 = 0.022;
const PERIOD: f64 = 0.001;
const WALL: Wall = Wall::damped(5.0, 0.002, 1);
const LATE: Wall = Wall::damped(3.0, 0.001, 2);
const UNDELAYED: Wall = Wall::damped(30.0, 0.002, 0);
/// Of the face of a wall.
const FACE: f64 = 0.3;

const fn scene(environment: Environment) -> Scene {
    Scene { torque_limit: Some(0.5), ..test_scene::scene(environment) }
}

const fn knob(delay: usize) -> Profile {
    Profile::of(&KNOB, delay)
}

const fn endless(delay: usize) -> Profile {
    Profile::of(&ENDLESS, delay)
}

const fn wall_and_profile(wall: Wall, profile: Profile) -> Environment {
    Parts { wall: Some(wall), profile: Some(profile), ..Parts::NONE }.sum()
}

/// A profile, with or without a wall, and an undelayed canceller.
const fn free_mode(residual: f64, wall: Option<Wall>, profile: Profile) -> Environment {
    let canceller = Some(Canceller::to(residual));
    Parts { canceller, wall, profile: Some(profile), ..Parts::NONE }.sum()
}

/// The same with a drag of this damping and delay.
const fn dragging(environment: Environment, damping: f64, delay: usize) -> Environment {
    Parts { drag: Some(Drag::of(damping, delay)), ..*environment.parts() }.sum()
}

/// Slope in N m/rad of the detents, `4 n F / (2 pi)`, by which they rise and fall.
const SLOPE: f64 = 4.0 * 24.0 * 0.02 / core::f64::consts::TAU;

fn bound(environment: Environment) -> Interval {
    certify(&scene(environment)).unwrap_or_else(|why| panic!("{why}")).bound.unwrap()
}

/// Computed by hand: `K T (n - 1/2) + B` of a wall, nothing of an undelayed wall, the cancelled damping, and
/// `T (L/2 + (n - 1) M)`, where the end stops are the steepest rise, and the detents are beside them.
#[test]
fn indices_add() {
    let detents = |n: f64| PERIOD * SLOPE * (n - 0.5);
    let stops = |n: f64| PERIOD * (2.5 + (n - 1.0) * 5.0);
    let residual = 0.015;
    let cancelled = DAMPING - residual;
    let late = |k: f64, n: f64, b: f64| k * PERIOD * (n - 0.5) + b;
    for (environment, expected) in [
        (free_mode(residual, None, endless(2)), cancelled + detents(2.0)),
        (wall_and_profile(WALL, knob(1)), late(5.0, 1.0, 0.002) + stops(1.0)),
        (wall_and_profile(LATE.behind(FACE), knob(1)), late(3.0, 2.0, 0.001) + stops(1.0)),
        (wall_and_profile(UNDELAYED.behind(FACE), knob(2)), stops(2.0)),
        (
            free_mode(residual, Some(LATE.behind(FACE)), knob(1)),
            cancelled + late(3.0, 2.0, 0.001) + stops(1.0),
        ),
        (dragging(wall_and_profile(WALL, knob(1)), 0.001, 3), late(5.0, 1.0, 0.003) + stops(1.0)),
        (dragging(LATE.behind(FACE).alone(), -0.004, 1), late(3.0, 2.0, 0.005)),
        (dragging(LATE.behind(FACE).alone(), -0.004, 0), late(3.0, 2.0, 0.005)),
        // Without a delay it takes energy.
        (dragging(LATE.behind(FACE).alone(), 0.004, 0), late(3.0, 2.0, 0.001)),
    ] {
        let found = bound(environment);
        // A knot is a whole number of units.
        assert!((found.midpoint() / expected - 1.0).abs() < 1e-3, "{found:?} {expected}");
        assert!(found.hi() - found.lo() < 1e-9 * expected, "{found:?}");
    }
}

/// The index at the port: `c = T (L/2 + (n + e) M)` of both slopes, and their variance (equation 59).
#[test]
fn without_a_coupling_the_springs_add() {
    let (n, e) = (1.0, 0.3);
    let wall = Wall::spring(2.0, 1);
    let environment = wall_and_profile(wall, knob(1));
    let at_port = |latency| Scene { coupling: Coupling::Rigid, latency, ..scene(environment) };
    for (latency, e) in [(Latency::NONE, 0.0), (Latency::delayed(e * PERIOD), e)] {
        let found = certify(&at_port(latency)).unwrap_or_else(|why| panic!("{why}")).bound.unwrap();
        let slopes: f64 = 5.0 + 2.0;
        let within = (0.5 + n + e) * slopes;
        let expected =
            0.5 * PERIOD * (within + (within.powi(2) + e * (1.0 - e) * slopes.powi(2)).sqrt());
        assert!((found.midpoint() / expected - 1.0).abs() < 1e-9, "{found:?} {expected}");
    }
}

fn refusal(environment: Environment, coupling: Coupling) -> String {
    certify(&Scene { coupling, ..scene(environment) }).unwrap_err().sentence().as_str().to_owned()
}

#[test]
fn what_has_no_proof_is_refused_with_a_sentence() {
    let spring = Coupling::Spring { stiffness: 44.0 };
    let undelayed = free_mode(0.01, None, endless(0));
    assert_eq!(
        refusal(undelayed, spring),
        "rejected: the delay is 0 samples, and must be at least 1 where another part is beside the \
         torque profile"
    );
    let endless = wall_and_profile(WALL.behind(FACE), endless(1));
    assert_eq!(
        refusal(endless, spring),
        "rejected: the face is 0.3 rad, and must be beside a torque profile with end stops: one without them \
         repeats in every turn, and a wall stands in one of them"
    );
    let pulling = wall_and_profile(Wall { stiffness: -1.0, ..WALL }, knob(1));
    assert!(refusal(pulling, spring).contains("pulls away at rest like a negative spring"));
    let missing = Scene {
        timing: Timing { period: PERIOD, worst_period: Some(2.0 * PERIOD) },
        latency: Latency { sensor_lag: TimeRange::exactly(1e-5), ..Latency::delayed(0.0) }
            .with_actuator_lag(1e-5),
        coupling: Coupling::Rigid,
        ..scene(wall_and_profile(WALL, knob(1)))
    };
    let sentence = certify(&missing).unwrap_err().to_string();
    assert!(sentence.contains("updates that are missed beside two lags"), "{sentence}");
    let mut soft = knob(1);
    soft.ends = Some(Ends { from: -2.0, to: 2.0, stiffness: -1.0 });
    let sentence = refusal(wall_and_profile(WALL, soft), spring);
    assert!(sentence.ends_with("must be greater than 0 beyond end stops"), "{sentence}");
}

/// Without a coupling a canceller and a damper add what they may give for a unit of velocity (theory, section
/// 16.3).
#[test]
fn without_a_coupling_dampers_add() {
    let late = 1.5 * PERIOD;
    for (environment, expected) in [
        (free_mode(0.015, None, knob(1)), late * 5.0 + DAMPING - 0.015),
        (wall_and_profile(Wall::damped(2.0, 0.003, 1), knob(1)), late * 7.0 + 0.003),
        (dragging(knob(1).alone(), -0.003, 0), late * 5.0 + 0.003),
        (dragging(WALL.behind(FACE).alone(), 0.003, 0), late * 5.0 + 0.005),
    ] {
        let found = certify(&Scene { coupling: Coupling::Rigid, ..scene(environment) }).unwrap();
        let bound = found.bound.unwrap();
        assert!((bound.midpoint() / expected - 1.0).abs() < 1e-9, "{bound:?} {expected}");
    }
}

/// A scene file has one delay for both.
#[test]
fn a_drag_is_as_late_as_the_part_beside_it() {
    let environment = LATE.alone().with(Parameter::Drag, 0.004).unwrap();
    assert_eq!(environment, dragging(LATE.alone(), 0.004, 2));
    let earlier = Wall { delay: 1, ..LATE };
    let expected = dragging(earlier.alone(), 0.004, 1);
    assert_eq!(environment.with(Parameter::Delay, 1.0), Some(expected));
}

/// Each remedy is certified, and the one of a sum is of its parts by name.
#[test]
fn remedies_name_the_parts() {
    let wall = Wall::damped(20.0, 0.002, 1);
    let scene = scene(free_mode(0.012, Some(wall), knob(1)));
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
    let mut all = free_mode(0.012, Some(WALL.behind(FACE)), knob(1));
    let data = all;
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
    let free = free_mode(0.012, None, knob(1));
    assert_eq!(free.get(Parameter::Stiffness), Some(5.0));
}

/// The gains that solve a tick are rounded; so are all other coefficients.
#[test]
fn every_format_has_nearly_the_same_bound() {
    let scene = scene(free_mode(0.012, Some(LATE.behind(FACE)), knob(1)));
    let exact = certify(&scene).unwrap().bound.unwrap();
    for format in [Format::F32, Format::Fixed { fraction_bits: 24 }] {
        let found = certify_in(&scene, format).unwrap().bound.unwrap();
        assert!((found.hi() / exact.hi() - 1.0).abs() < 1e-4, "{found:?} {exact:?}");
    }
}

const KNOB_AND_WALL: Scene =
    Scene { torque_limit: None, ..scene(wall_and_profile(LATE.behind(FACE), knob(1))) };
const CERTIFIED: Certified<Scene> = KNOB_AND_WALL.certified();
const TIMED: TimingChecked<Scene, Latched> = CERTIFIED.timing_checked::<Latched>();

/// Late parts run latched, cancellers behind the matched coupling; a board reaches the same verdict when it
/// starts.
#[test]
fn boards_render_them() {
    assert_eq!(TIMED.scene(), &KNOB_AND_WALL);
    let environment = free_mode(0.018, Some(UNDELAYED.behind(FACE)), knob(1));
    let matched = Scene {
        coupling: Coupling::Matched,
        latency: Latency { output_jitter: 1e-6, ..Latency::delayed(2e-4) },
        ..scene(environment)
    };
    for format in [Format::F32, Format::Fixed { fraction_bits: 24 }] {
        assert!(timing_checked::<_, Latched>(KNOB_AND_WALL, format).is_ok(), "{format}");
        let certified = certify_scene(matched, format).unwrap_or_else(|why| panic!("{why}"));
        assert!(certified.time::<AtPhase<200_000>>().is_ok(), "{format}");
        assert!(timing_checked::<_, AtPhase<200_000>>(matched, format).is_ok(), "{format}");
        let more = matched.with(Parameter::Residual, 0.001).unwrap();
        assert!(certify_scene(more, format).is_err(), "{format}");
        assert!(timing_checked::<_, AtPhase<200_000>>(more, format).is_err(), "{format}");
    }
}

/// Against the same detents between ends that are far away, where angles are not those within a turn.
#[test]
fn a_canceller_beside_a_profile_without_ends_feels_no_turn() {
    static FAR: Knots<16> =
        Knots::of(&[Shape::detents(24, 0.02), Shape::end_stops(-50.0, 50.0, 5.0)]);
    let free = |profile| scene(free_mode(0.012, None, profile)).certify().unwrap();
    let servo = |profile| Servo::<_, f64>::new(&free(profile), &TRANSDUCERS).unwrap();
    let (mut endless, mut ended) = (servo(endless(1)), servo(Profile::of(&FAR, 1)));
    let mut largest = 0.0_f64;
    for tick in 0..40_000 {
        let angle = 40.0 * (f64::from(tick) * 3e-4).sin() + 0.3 * (f64::from(tick) * 0.17).sin();
        let count = (angle * 61_440.0 / core::f64::consts::TAU) as i32;
        let raw = RawCount::from(count.cast_unsigned());
        endless.tick(raw);
        ended.tick(raw);
        let off = (endless.torque_nm() - ended.torque_nm()).abs();
        largest = largest.max(off);
    }
    // A few parts of a cell, in which places in the table are counted.
    assert!(largest < 1e-5 && endless.torque_nm() != 0.0, "{largest}");
}

#[test]
fn no_motion_has_a_torque_farther_off_than_the_bound_on_its_limit_cycle() {
    const COUNTS: f64 = 4096.0;
    const MOTION: [f64; 2] = [1.5, 0.02];
    let spring = Wall::spring(8.0, 1);
    let residual = 0.016;
    for environment in [
        free_mode(residual, None, endless(1)),
        wall_and_profile(spring.behind(FACE), knob(1)),
        wall_and_profile(WALL, knob(1)),
        free_mode(residual, Some(spring.behind(FACE)), knob(1)),
        dragging(knob(1).alone(), -0.004, 1),
        dragging(spring.behind(FACE).alone(), 0.006, 0),
        dragging(spring.behind(FACE).alone(), -0.004, 1),
    ] {
        let scene = scene(environment);
        let steps = Resolution {
            encoder: Some(core::f64::consts::TAU / COUNTS),
            full_scale: Some(1.0),
            ..Resolution::default()
        };
        for (found, format) in [
            (largest_error::<f32>(&scene, COUNTS, MOTION), Format::F32),
            (largest_error::<I8F24>(&scene, COUNTS, MOTION), Format::Fixed { fraction_bits: 24 }),
        ] {
            let bound = QuantizationBound::of(&scene, format, &steps).unwrap();
            let encoder = bound.encoder.unwrap();
            assert!(bound.in_any_motion);
            assert!(found <= encoder + bound.numbers + encoder / 1024.0, "{found} {bound:?}");
            assert!(found > 0.25 * encoder, "{found} {bound:?}");
        }
    }
}
