use core::f64::consts::TAU;

use fixed::types::{I8F24, I16F16};

use super::*;
use crate::certificate::{Rejection, certify};
use crate::coupling::Response;
use crate::encoder::{CounterWidth, RawCount};
use crate::environment::{Discretize, Law};
use crate::number::{Number, Truncated};
use crate::scene::{Coupling, Scene};
use crate::servo::{Servo, Transducers};
use crate::test_scene::{self, scene};

const DETENTS: Knots<64> = Knots::of(&[Shape::detents(24, 0.02)]);
const KNOB: Knots<16> = Knots::of(&[Shape::detents(24, 0.02), Shape::end_stops(-2.0, 2.0, 5.0)]);

pub(super) const TRANSDUCERS: Transducers =
    Transducers { counter: CounterWidth::Bits16, ..test_scene::TRANSDUCERS };

/// Detents with another torque.
fn detents_of(torque: f64, delay: usize) -> Profile {
    let mut profile = Profile::of(&DETENTS, delay);
    profile.torque = torque;
    profile
}

/// The torque of a law at an angle, undelayed.
fn torque<N: Number>(profile: &Profile, angle: f64) -> f64 {
    let mut undelayed = *profile;
    undelayed.delay = 0;
    let law = Discretize::<N>::law(&undelayed.alone(), &scene(()).context()).unwrap();
    match law.evaluate(N::from_f64(angle).unwrap()) {
        Response::Held(torque) => torque.to_f64(),
        other => panic!("{other:?}"),
    }
}

#[test]
fn detents_are_a_wave_of_straight_lines() {
    let profile = Profile::of(&DETENTS, 1);
    assert_eq!((profile.count, profile.torque, profile.centre), (24.0, 0.02, 0.0));
    let outline = DETENTS.outline();
    assert_eq!((outline.sum, outline.is_odd, outline.wraps), (0, true, true));
    let pitch = TAU / 24.0;
    for (part, expected) in
        [(0.0, 0.0), (0.125, 0.01), (0.25, 0.02), (0.4, 0.008), (0.5, 0.0), (0.75, -0.02)]
    {
        for detent in [-12.0, -3.0, 0.0, 7.0] {
            let found = torque::<f64>(&profile, (detent + part) * pitch);
            assert!((found - expected).abs() < 1e-6, "{detent} {part}: {found}");
        }
    }
}

#[test]
fn end_stops_are_springs_beyond_the_range() {
    let profile = Profile::of(&KNOB, 1);
    assert_eq!(profile.ends, Some(Ends { from: -2.0, to: 2.0, stiffness: 5.0 }));
    let at_end = torque::<f64>(&profile, 2.0);
    assert!((torque::<f64>(&profile, 2.5) - at_end - 2.5).abs() < 1e-4);
    assert!((torque::<f64>(&profile, -2.5) + at_end + 2.5).abs() < 1e-4);
}

/// Against the shapes' own torques, from which the table was sampled.
#[test]
fn every_format_gives_the_sum_of_the_shapes() {
    let cases: [&[Shape]; 5] = [
        &[Shape::detents(24, 0.02), Shape::detents(12, 0.01)],
        &[Shape::bistable(0.4, 0.05), Shape::texture(0.2, 0.004)],
        &[Shape::centre(0.5, 0.3), Shape::magnet(0.2, 0.1, 0.02)],
        &[Shape::Table(TABLE), Shape::end_stops(-1.0, 1.0, 4.0)],
        &[Shape::detents(24, 0.02), Shape::end_stops(-1.0, 1.2, 4.0)],
    ];
    for shapes in cases {
        let units = vec![0; 1024].leak();
        let profile = Profile::sampled(shapes, units, 1).unwrap();
        let steepest = f64::from(profile.outline().rise.max(profile.outline().fall)) / 32767.0
            * profile.torque;
        for i in -300..300 {
            let angle = f64::from(i) * 0.005 + 0.0011;
            let within = match profile.ends {
                Some(Ends { from, to, .. }) => angle.clamp(from, to),
                None => angle,
            };
            let stops = profile.ends.map_or(0.0, |ends| ends.stiffness * (angle - within));
            let inside: f64 = shapes
                .iter()
                .filter(|shape| !matches!(shape, Shape::EndStops { .. }))
                .map(|shape| shape.torque_at(within))
                .sum();
            // A corner that is not on a cell's border is cut.
            let allowed = 0.6 * steepest + 1e-4;
            let expected = inside + stops;
            for found in [
                torque::<f64>(&profile, angle),
                torque::<f32>(&profile, angle),
                torque::<I8F24>(&profile, angle),
                torque::<Truncated<I8F24>>(&profile, angle),
            ] {
                assert!(
                    (found - expected).abs() < allowed,
                    "{shapes:?} {angle}: {found}, {expected}"
                );
            }
            assert!((torque::<I16F16>(&profile, angle) - expected).abs() < allowed + 1e-3);
        }
    }
}

const TABLE: &[(f64, f64)] = &[(-1.0, 0.03), (-0.4, -0.01), (0.3, 0.02), (1.0, 0.0)];

#[test]
fn shapes_that_make_no_sense_are_named() {
    let refused = |shapes: &[Shape]| {
        Knots::<64>::sampled(shapes).map(|_| ()).unwrap_err().sentence().as_str().to_owned()
    };
    assert_eq!(refused(&[]), "a torque profile needs a shape");
    assert_eq!(
        refused(&[Shape::detents(24, 0.02), Shape::texture(-0.1, 0.01)]),
        "shape 1: `pitch` is -0.1, and must be greater than 0"
    );
    assert_eq!(
        refused(&[Shape::end_stops(1.0, 1.0, 5.0)]),
        "shape 0: `from` is 1, and must be below `to`"
    );
    assert!(refused(&[Shape::detents(24, f64::NAN)]).contains("`torque` is NaN"));
    assert!(
        refused(&[Shape::Table(&[(0.0, 1.0), (0.0, 2.0)])]).starts_with(
            "shape 0, knot 1: 0 must be above the angle of the knot before, which is 0"
        )
    );
    assert!(refused(&[Shape::Table(TABLE)]).contains("needs end stops"));
    assert!(
        refused(&[Shape::Periodic(&[(0.0, 0.0), (0.1, 0.02), (TAU / 24.0, 0.01)])]).contains(
            "knot 2: 0.01 must be the torque of the first knot, which closes the period: 0"
        )
    );
    assert!(
        refused(&[Shape::Periodic(MOTOR)])
            .starts_with("the mean of the torque over a period is 0.01 N m")
    );
    assert!(refused(&[Shape::detents(360, 0.02), Shape::detents(7, 0.02)]).contains("knots"));
}

const MOTOR: &[(f64, f64)] = &[(0.0, 0.0), (0.1, 0.02), (TAU / 24.0, 0.0)];

/// The paper's limits: a sample late it is the steepest rise alone, `L < 2 delta / T`.
#[test]
fn the_steepest_rise_decides_where_the_torque_is_a_sample_late() {
    let detents = |torque: f64| certify(&scene(detents_of(torque, 1).alone()));
    // 44 N m/rad over a quarter of the pitch.
    let limit = 44.0 * TAU / 24.0 / 4.0;
    let found = detents(0.999 * limit).unwrap().bound.unwrap();
    assert!((found.hi() / 0.022 - 0.999).abs() < 1e-3, "{found:?}");
    assert!(matches!(detents(1.001 * limit), Err(Rejection::Shortage { .. })));
    // Two samples late: L/2 + M.
    let late = |torque: f64| certify(&scene(detents_of(torque, 2).alone())).is_ok();
    assert!(late(0.999 * limit / 3.0) && !late(1.001 * limit / 3.0));
    // Without a coupling and a sample late, L/2 + M again (equation 48).
    let rigid = |torque: f64| {
        let detents = detents_of(torque, 1).alone();
        certify(&Scene { coupling: Coupling::Rigid, ..scene(detents) }).is_ok()
    };
    assert!(rigid(0.999 * limit / 3.0) && !rigid(1.001 * limit / 3.0));
}

#[test]
fn without_delay_tops_between_detents_cost_and_slopes_that_push_back_are_free() {
    let detents = |torque: f64| certify(&scene(detents_of(torque, 0).alone()));
    let at = |slope: f64| slope * TAU / 24.0 / 4.0;
    // The fall of 43.9 in front of the coupling is one of 43.9 / (1 + 43.9 / 44) behind it.
    let bound = detents(at(43.9)).unwrap().bound.unwrap().hi();
    assert!((bound - 0.5e-3 * 43.9 / (1.0 + 43.9 / 44.0)).abs() < 1e-5, "{bound}");
    let steep = detents(at(44.1)).unwrap_err();
    assert!(matches!(steep, Rejection::Steep { .. }), "{steep}");
}

#[test]
fn motors_are_refused() {
    let data = |change: fn(&mut Profile)| {
        let mut profile = Profile::of(&KNOB, 1);
        change(&mut profile);
        scene(profile.alone())
    };
    let reason = |scene: &Scene| certify(scene).unwrap_err().sentence().as_str().to_owned();
    let slack = data(|profile| profile.ends = Some(Ends { from: -2.0, to: 2.0, stiffness: 0.0 }));
    assert!(reason(&slack).contains("greater than 0 beyond end stops"), "{}", reason(&slack));
    let units = vec![0; 64].leak();
    let lopsided = Profile::sampled(&[Shape::Periodic(LOPSIDED)], units, 1).unwrap();
    let free = scene(lopsided.alone());
    assert!(certify(&free).is_ok(), "{:?}", certify(&free));
    let limited = Scene { torque_limit: Some(0.01), ..free };
    assert!(reason(&limited).contains("as a motor does"));
    assert!(certify(&free).unwrap().renders_in::<crate::servo::Latched>(&free).is_err());
    let endless = {
        let units = vec![0; 64].leak();
        let shapes = [Shape::centre(1.0, 0.5), Shape::magnet(0.5, 0.2, 0.01)];
        let mut profile = Profile::sampled(&shapes, units, 1).unwrap();
        (profile.ends, profile.count) = (None, 1.0);
        scene(profile.alone())
    };
    assert!(matches!(certify(&endless), Err(Rejection::Motor { .. })));
}

const LOPSIDED: &[(f64, f64)] =
    &[(0.0, 0.0), (0.05, 0.03), (0.1, 0.0), (0.18, -0.003 / (TAU / 24.0 - 0.1)), (TAU / 24.0, 0.0)];

/// A position that is far away is that of a turn, to the bit.
#[test]
fn nothing_is_lost_after_any_number_of_turns() {
    let certified = scene(Profile::of(&DETENTS, 1).alone()).certify().unwrap();
    let mut near = Servo::<_, f32>::new(&certified, &TRANSDUCERS).unwrap();
    let mut far = Servo::<_, f32>::new(&certified, &TRANSDUCERS).unwrap();
    let mut count = 0_u32;
    // 500,000 turns, which is beyond 32 bits, by almost half of the counter a tick.
    for _ in 0..500_000 * 2 {
        count = count.wrapping_add(30_720);
        far.tick(RawCount::from(count));
    }
    assert_eq!(far.count(), 500_000 * 61_440);
    for step in (0..3000).chain((-3000..3000).rev()) {
        let (a, b) =
            (count.wrapping_add((step * 20_i32).cast_unsigned()), (step * 20).cast_unsigned());
        assert_eq!(near.tick(RawCount::from(b)), far.tick(RawCount::from(a)), "{step}");
    }
    let odd = Transducers { counts_per_turn: 61_440.5, ..TRANSDUCERS };
    let refused = Servo::<_, f32>::new(&certified, &odd).unwrap_err();
    assert!(
        refused.sentence().as_str().contains("whole number"),
        "{}",
        refused.sentence().as_str()
    );
}

/// A damper beside the profile does not see the turn begin anew.
#[test]
fn a_turn_that_begins_anew_is_not_felt() {
    let damped = scene(Profile::of(&DETENTS, 1).damped(0.001).alone());
    let certified = damped.certify().unwrap();
    let mut servo = Servo::<_, f32>::new(&certified, &TRANSDUCERS).unwrap();
    let torques: Vec<f64> = (0..200_000_u32)
        .map(|tick| {
            servo.tick(RawCount::from(tick.wrapping_mul(10)));
            servo.torque_nm()
        })
        .collect();
    let (first, later) = (&torques[6144..12288], &torques[6144 * 20..6144 * 21]);
    for (a, b) in first.iter().zip(later) {
        assert!((a - b).abs() < 1e-4, "{a} {b}");
    }
}
