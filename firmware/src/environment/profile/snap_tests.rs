use core::f64::consts::TAU;

use super::tests::TRANSDUCERS;
use super::*;
use crate::certificate::{Rejection, certify};
use crate::coupling::Response;
use crate::encoder::RawCount;
use crate::environment::{Discretize, Law};
use crate::output_timing::Latched;
use crate::passivity::poles::UndecidedReason;
use crate::scene::{Coupling, Latency, Scene};
use crate::servo::{BuildError, Servo, Transducers};
use crate::test_scene;

static KNOB: Knots<64> =
    Knots::of(&[Shape::detents(24, 0.02).snap(1.1), Shape::end_stops(-2.0, 2.0, 5.0)]);
static ENDLESS: Knots<64> =
    Knots::of(&[Shape::detents(24, 0.05).snap(0.6), Shape::detents(8, 0.01)]);

fn scene<E: Copy>(environment: E) -> Scene<E> {
    Scene { torque_limit: Some(0.5), ..test_scene::scene(environment) }
}

#[test]
fn a_detent_holds_the_knob_up_to_its_snap_point() {
    let profile = Profile::of(&KNOB, 1);
    assert_eq!((profile.torque, profile.count), (0.02, 24.0));
    assert_eq!((profile.outline().rise, profile.outline().fall), (0, 0));
    let mut law = Discretize::<f64>::law(&profile.alone(), &scene(()).context()).unwrap();
    law.rest_at(0.0);
    let pitch = TAU / 24.0;
    let mut at = |pitches: f64| {
        law.update(pitches * pitch);
        let Response::Held(torque) = law.evaluate(0.0) else { panic!("not held") };
        torque / 0.02
    };
    for (pitches, torque) in [
        (0.5, 0.5 / 1.1),
        (1.09, 1.09 / 1.1),
        // Up, and back over the same way: not before the snap point of the other.
        (1.11, 0.11 / 1.1),
        (0.0, -1.0 / 1.1),
        (-0.09, -1.09 / 1.1),
        (-0.11, -0.11 / 1.1),
        // To the nearest, however far.
        (5.3, 0.3 / 1.1),
        (-4.4, 0.4 / -1.1),
        // The last one within the ends, whose springs add.
        (7.5, 0.5 / 1.1),
        (9.0, 2.0 / 1.1 + 5.0 * (9.0 * pitch - 2.0) / 0.02),
    ] {
        let found = at(pitches);
        assert!((found - torque).abs() < 1e-3, "{pitches}: {found} {torque}");
    }
}

/// After a million turns either way the codes are those of the first turn.
#[test]
fn no_turn_moves_a_snap_point() {
    let certified = scene(Profile::of(&ENDLESS, 1).alone()).certify().unwrap();
    for sign in [1, -1] {
        let mut near = Servo::<_, f32>::new(&certified, &TRANSDUCERS).unwrap();
        let mut far = Servo::<_, f32>::new(&certified, &TRANSDUCERS).unwrap();
        let mut count = 0_u32;
        for _ in 0..1_000_000 * 2 {
            count = count.wrapping_add((sign * 30_720_i32).cast_unsigned());
            far.tick(RawCount::from(count));
        }
        assert_eq!(far.count(), i64::from(sign) * 1_000_000 * 61_440);
        let settled = (near.tick(RawCount::from(0_u32)), far.tick(RawCount::from(count)));
        assert_eq!(settled.0.limit, settled.1.limit);
        for step in (0..4000).chain((-8000..4000).rev()).chain(-8000..0) {
            let here = (step * 17_i32).cast_unsigned();
            let (near, far) = (
                near.tick(RawCount::from(here)),
                far.tick(RawCount::from(count.wrapping_add(here))),
            );
            assert_eq!(near, far, "{step}");
        }
    }
}

/// The line adds to every rise, and takes from every fall.
#[test]
fn the_index_is_that_of_the_steepest_branch() {
    let knob = |torque: f64| {
        let mut profile = Profile::of(&KNOB, 1);
        profile.torque = torque;
        // The end stops, 5 N m/rad steep, add to it.
        certify(&scene(profile.alone()))
    };
    let limit = (44.0 - 5.0) * 1.1 * TAU / 24.0;
    let found = knob(0.999 * limit).unwrap().bound.unwrap();
    let expected = 0.5e-3 * (5.0 + 39.0 * 0.999);
    assert!((found.hi() / expected - 1.0).abs() < 1e-6, "{found:?} {expected}");
    assert!(matches!(knob(1.001 * limit), Err(Rejection::Shortage { .. })));
    // Not late, nothing falls but what falls by more than the line rises.
    let line = 0.05 * 24.0 / (0.6 * TAU);
    let fall = 0.01 * 4.0 * 8.0 / TAU;
    assert!(fall < line);
    let at_once = certify(&scene(Profile::of(&ENDLESS, 0).alone())).unwrap();
    assert_eq!(at_once.bound.unwrap().hi(), 0.0);
    let steep = |torque: f64| {
        let mut profile = Profile::of(&KNOB, 0);
        profile.torque = torque;
        certify(&scene(profile.alone()))
    };
    assert!(steep(0.999 * limit).is_ok());
    assert!(matches!(steep(1.001 * limit), Err(Rejection::Steep { .. })));
}

#[test]
fn what_no_proof_covers_is_refused_with_a_sentence() {
    let no_proof = |scene: &Scene| {
        let error = certify(scene).unwrap_err();
        assert!(
            matches!(error, Rejection::Undecided { doubt: UndecidedReason::NoSnapBound, .. }),
            "{error}"
        );
        assert!(error.to_string().contains("give it a delay of 0 or 1, a coupling"), "{error}");
    };
    no_proof(&scene(Profile::of(&KNOB, 2).alone()));
    for delayed in [Profile::of(&KNOB, 0).alone(), Profile::of(&KNOB, 1).alone()] {
        no_proof(&Scene { coupling: Coupling::Rigid, ..scene(delayed) });
    }
    // Where torques lag, behind the coupling that absorbs it, and behind a spring that is soft enough.
    let once = Profile::of(&ENDLESS, 0).alone();
    let latency = Latency::delayed(0.5e-3);
    let matched = Scene { coupling: Coupling::Matched, latency, ..scene(once) };
    assert!(matched.certify().is_ok(), "{:?}", matched.certify().map(|_| ()));
    let spring = Coupling::Spring { stiffness: 16.0 };
    assert!(Scene { coupling: spring, latency, ..scene(once) }.certify().is_ok());
    // A board renders profiles that are late by a sample, and gives no damping away.
    let late = scene(Profile::of(&KNOB, 1).alone()).certified();
    assert_eq!(late.time::<Latched>().unwrap().margin(), Some(0.0));
    assert!(scene(Profile::of(&ENDLESS, 1).alone()).certified().time::<Latched>().is_ok());

    let shapes = [
        Shape::Detents { count: 24, torque: 0.05, centre: 0.05 }.snap(1.1),
        Shape::end_stops(0.06, 0.1, 5.0),
    ];
    let between = Profile::sampled(&shapes, vec![0; 64].leak(), 1).unwrap();
    let nothing = certify(&scene(between.alone())).unwrap_err().to_string();
    assert!(nothing.contains("detent with a snap point is between the end stops"), "{nothing}");
    let law = Discretize::<f32>::law(&between.alone(), &scene(()).context());
    assert!(matches!(law, Err(BuildError::NotPositive { .. })));
}

/// Clipped, detents that are not the same to either side of the table's centre would turn the knob.
#[test]
fn detents_beside_the_centre_of_a_table_that_repeats_are_no_board_s() {
    let beside = |centre: f64| {
        let shapes =
            [Shape::detents(8, 0.01), Shape::Detents { count: 24, torque: 0.05, centre }.snap(1.1)];
        let profile = Profile::sampled(&shapes, vec![0; 64].leak(), 1).unwrap();
        scene(profile.alone())
    };
    let half = 0.5 * TAU / 24.0;
    assert!(certify(&beside(0.0)).is_ok() && certify(&beside(half)).is_ok());
    assert!(matches!(certify(&beside(0.02)), Err(Rejection::Uneven)));
    let unlimited = Scene { torque_limit: None, ..beside(0.02) };
    let assessment = certify(&unlimited).unwrap();
    assert!(assessment.renders_in::<Latched>(&unlimited).is_err());
}

#[test]
fn shapes_with_a_snap_point_that_make_no_sense_are_named() {
    let refused = |shapes: &[Shape]| {
        Knots::<64>::sampled(shapes).map(|_| ()).unwrap_err().sentence().as_str().to_owned()
    };
    for snap in [0.5, 0.0, -1.0, f64::NAN, 10.5] {
        let sentence = refused(&[Shape::detents(24, 0.02).snap(snap)]);
        assert!(
            sentence.starts_with("shape 0: `snap` is ")
                && sentence.ends_with(
                    "and must be greater than 0.5, half-way to the next detent, and at most 10"
                ),
            "{sentence}"
        );
    }
    let one = Shape::detents(24, 0.02).snap(1.1);
    assert_eq!(
        refused(&[one, Shape::detents(12, 0.02), one]),
        "shape 2 is the second one with a snap point, and a torque profile has one at most"
    );
    assert!(refused(&[Shape::detents(24, -0.02).snap(1.1)]).contains("`torque` is -0.02"));
}

/// A hysteresis narrower than a count has no effect.
#[test]
fn the_encoder_sees_the_hysteresis() {
    let coarse = |snap: f64, counts_per_turn: f64| {
        let shapes = [Shape::detents(24, 0.02).snap(snap)];
        let profile = Profile::sampled(&shapes, vec![0; 64].leak(), 1).unwrap();
        let scene = scene(profile.alone());
        let transducers = Transducers { counts_per_turn, ..TRANSDUCERS };
        Servo::<_, f32>::build(&scene, &transducers).map(|_| ())
    };
    // 0.02 pitches are a count of 1200 a turn.
    assert_eq!(coarse(0.51, 1210.0), Ok(()));
    let error = coarse(0.51, 1190.0).unwrap_err();
    assert!(matches!(error, BuildError::Hysteresis { .. }));
    assert_eq!(
        error.to_string(),
        "from a snap point the knob goes back 0.005235987756 rad to snap back, and that must be more than an \
         encoder count of 0.005279987653 rad: put the snap point farther from the centre, or take fewer detents"
    );
    assert_eq!(coarse(1.1, 240.0), Ok(()));
}
