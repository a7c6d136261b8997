use fixed::types::I8F24;

use super::*;
use crate::certificate::{Certified, Rejection, certify_in, certify_scene, first_refused_mode};
use crate::coupling::Response;
use crate::encoder::{CounterWidth, RawCount};
use crate::environment::{Discretize, Environment, Knots, Law, Profile};
use crate::number::{Format, Number};
use crate::parameter::Parameter;
use crate::scene::Scene;
use crate::scene_type::Typed;
use crate::servo::{BuildError, Latched, PreparedServo, RenderingOptions, Servo, Transducers};
use crate::{test_scene, tuning};

const TRANSDUCERS: Transducers = Transducers {
    counter: CounterWidth::Bits16,
    full_scale_torque: 2.0,
    ..test_scene::TRANSDUCERS
};

const fn scene(profile: Profile) -> Scene {
    Scene { torque_limit: Some(1.0), ..test_scene::scene(profile.alone()) }
}

/// Late by a sample.
const fn of(modes: &'static [ProfileMode]) -> Profile {
    Profile::of_modes(modes, 1)
}

fn selected(mode: usize) -> Scene {
    scene(of(&KNOB_MODES).selecting(mode as f64).unwrap())
}

fn numbers() -> impl Iterator<Item = usize> {
    0..KNOB_MODES.len()
}

#[test]
fn each_mode_is_certified_and_rendered_in_the_boards_number_formats() {
    for mode in numbers() {
        let name = KNOB_MODES[mode].name();
        let data = selected(mode);
        assert_eq!(data.environment.profile().unwrap().units(), KNOB_MODES[mode].units);
        for format in [Format::F64, Format::F32, I8F24::FORMAT] {
            let assessment =
                certify_in(&data, format).unwrap_or_else(|error| panic!("{name}: {error}"));
            assert_eq!(assessment.renders_in::<Latched>(&data), Ok(()), "{name}");
        }
        renders::<f32>(mode);
        renders::<I8F24>(mode);
    }
}

fn renders<N: Number>(mode: usize) {
    let timed = certify_scene(selected(mode), N::FORMAT).unwrap().time::<Latched>().unwrap();
    let options = RenderingOptions::DEFAULT;
    let built = PreparedServo::<_, N, Latched>::new(&timed, &TRANSDUCERS, &options);
    assert!(built.is_ok(), "{}: {:?}", KNOB_MODES[mode].name(), built.map(|_| ()));
}

/// The torque of a mode is that of its shapes, but for corners that are cut where no knot lies on them.
#[test]
fn each_mode_has_the_torque_of_its_shapes() {
    for mode in numbers() {
        let shapes = MODES[mode].shapes;
        assert_eq!(KNOB_MODES[mode].name(), MODES[mode].name);
        let (scene, profile) = (selected(mode), of(&KNOB_MODES).selecting(mode as f64).unwrap());
        let mut undelayed = profile;
        undelayed.delay = 0;
        let law = Discretize::<f64>::law(&undelayed.alone(), &scene.context()).unwrap();
        let narrowest = shapes.iter().map(Shape::narrowest).fold(f64::INFINITY, f64::min);
        // A straight piece falls or rises by all of the torque, and less than a cell of it is cut.
        let torque = if profile.outline().rise > 0 { profile.torque } else { 0.0 };
        let cut = 0.5 * torque / (profile.knots_per_rad() * narrowest) + 1e-5;
        for step in -2000..4000 {
            let angle = f64::from(step) * 2e-3 + 1e-4;
            // Beyond its ends it goes on by their springs, from the torque there.
            let (within, stiffness) = match profile.ends {
                Some(ends) => (angle.clamp(ends.from, ends.to), ends.stiffness),
                None => (angle, 0.0),
            };
            let inside: f64 = shapes.iter().map(|shape| shape.torque_at(within)).sum();
            let expected = inside + stiffness * (angle - within);
            let Response::Held(found) = law.evaluate(angle) else { panic!("it is held") };
            assert!((found - expected).abs() <= cut, "{mode} at {angle}: {found}, not {expected}");
        }
    }
}

/// A program selects a mode by its number alone.
#[test]
fn a_mode_is_rendered_as_the_profile_that_it_is() {
    const CERTIFIED: Certified<Scene> = scene(of(&KNOB_MODES)).certified();
    crate::scene_type!(Modes: CERTIFIED);
    for mode in numbers() {
        let changes = [(Parameter::Mode, mode as f64)];
        let changed = tuning::apply(Typed::<Modes>::certified().scene(), &changes).unwrap();
        let certified = certify_scene(changed, Format::F32).unwrap();
        let as_data = selected(mode).certify().unwrap();
        assert_eq!(certified.as_data(), as_data.scene());
        let mut typed = Servo::<_, f32>::new(&certified, &TRANSDUCERS).unwrap();
        let mut by_data = Servo::<Environment, f32>::new(&as_data, &TRANSDUCERS).unwrap();
        for count in (-20_000..80_000).step_by(37) {
            let raw = RawCount::from(count);
            assert_eq!(typed.tick(raw), by_data.tick(raw), "{mode} at {count}");
        }
    }
}

#[test]
fn a_knob_without_shapes_turns_freely() {
    let mut servo = Servo::<_, f32>::new(&selected(0).certify().unwrap(), &TRANSDUCERS).unwrap();
    let mut count = 0_u32;
    for tick in 0..100_000_u32 {
        count = count.wrapping_add(tick % 977);
        assert_eq!(servo.tick(RawCount::from(count)).code.offset(), 0);
    }
}

static FAIR: ModeTable<16> = ModeTable::of(&[Shape::detents(24, 0.05)]);
/// Steeper than the paddle allows at 1 kHz.
static STEEP: ModeTable<16> = ModeTable::of(&[Shape::detents(24, 5.0)]);
static ONE_IS_BAD: [ProfileMode; 3] =
    [FAIR.named("fair"), STEEP.named("steep"), FAIR.named("fair again")];

/// A mode is refused with the scene, and not when it is selected.
#[test]
fn a_scene_is_certified_with_each_of_its_modes() {
    let scene = scene(of(&ONE_IS_BAD));
    assert!(certify_in(&scene, Format::F64).is_ok(), "the selected one is fair");
    for format in [Format::F64, Format::F32, I8F24::FORMAT] {
        let rejection = scene.certify_in(format).unwrap_err();
        assert!(matches!(rejection, Rejection::Shortage { .. }), "{rejection}");
        let refused = first_refused_mode(&scene, format).unwrap();
        assert_eq!((refused.mode, refused.name, refused.reason), (1, "steep", rejection));
    }
    let sentence = first_refused_mode(&scene, Format::F64).unwrap();
    let sentence = sentence.sentence_in(Format::F64);
    assert!(
        sentence.as_str().starts_with("mode 1, `steep`: rejected: the environment needs alpha")
    );
    assert_eq!(first_refused_mode(&selected(3), Format::F64), None);
    // As a scene that has that mode alone.
    let alone = scene.with(Parameter::Mode, 1.0).unwrap();
    assert_eq!(alone.certify().unwrap_err(), scene.certify().unwrap_err());
}

/// Whether a mode can be had does not depend on which one is selected.
#[test]
fn what_one_mode_asks_of_an_encoder_all_ask_of_it() {
    let odd = Transducers { counts_per_turn: 61_440.5, ..TRANSDUCERS };
    for mode in numbers() {
        let refused = Servo::<_, f32>::new(&selected(mode).certify().unwrap(), &odd);
        assert!(matches!(refused, Err(BuildError::Turn { .. })), "{mode}");
    }
}

/// Twelve turns of free turning are no twelve turns beyond an end stop.
#[test]
fn a_mode_with_end_stops_starts_in_the_nearest_turn() {
    const TURN: u32 = 61_440;
    for (mode, count, torque) in [
        // Between the ends of `bounded 0 to 10`, 50 of 100 degrees, and 3 degrees below the lower one.
        (1, TURN * 50 / 360, 0.0),
        (1, TURN * 357 / 360, -15.0 * 3.0_f64.to_radians()),
        // 10 degrees to the right of the centre, and to the left of it.
        (4, TURN * 10 / 360, 0.05 * 10.0_f64.to_radians()),
        (4, TURN * 350 / 360, -0.05 * 10.0_f64.to_radians()),
    ] {
        let certified = selected(mode).certify().unwrap();
        for turns in [0_u32, 12, 2000, u32::MAX - 11] {
            let mut servo = Servo::<_, f32>::new(&certified, &TRANSDUCERS).unwrap();
            let far = count.wrapping_add(turns.wrapping_mul(TURN)).cast_signed();
            // By less than half of the counter a tick.
            let steps = i64::from(far).abs() / 30_000 + 1;
            for step in 0..=steps {
                let at = i64::from(far) * step / steps;
                servo.tick(RawCount::from(at as u32));
            }
            assert_eq!(servo.count(), i64::from(far));
            servo.rest_here();
            for _ in 0..100 {
                servo.tick(RawCount::from(far));
            }
            // Behind a coupling of 44 N m/rad.
            let expected = if torque.abs() > 0.1 { torque / (1.0 + 15.0 / 44.0) } else { torque };
            assert!(
                (servo.torque_nm() - expected).abs() < 1e-3,
                "{mode} {turns}: {}",
                servo.torque_nm()
            );
        }
    }
}

/// A mode may have a snap point: its torques are those of the type that has it alone.
#[test]
fn a_mode_has_its_snap_point() {
    const SHAPES: [Shape; 2] =
        [Shape::detents(24, 0.05).snap(1.1), Shape::end_stops(-1.0, 1.0, 15.0)];
    static TABLE: ModeTable<16> = ModeTable::of(&SHAPES);
    static MODES: [ProfileMode; 1] = [TABLE.named("snap")];
    static KNOTS: Knots<16> = Knots::of(&SHAPES);
    let modes = scene(of(&MODES)).certified();
    let context = modes.scene().context();
    let mut law = Discretize::<f32>::law(&modes.scene().environment, &context).unwrap();
    let alone = Profile::of(&KNOTS, 1).alone();
    let mut alone = Discretize::<f32>::law(&alone, &context).unwrap();
    law.rest_at(0.0);
    alone.rest_at(0.0);
    let (mut seen, mut snaps) = ([0.0; 2], 0);
    for tick in 0..400 {
        // There and back, by a count a tick and a little more.
        let x = 0.7 * (tick as f32 / 64.0).sin();
        let before = seen;
        seen = [held(&law, x), held(&alone, x)];
        assert_eq!(seen[0], seen[1], "tick {tick}");
        snaps += u32::from((seen[0] - before[0]).abs() > 0.03);
        law.update(x);
        alone.update(x);
    }
    assert!(snaps > 4, "{snaps}");
}

fn held<L: Law<f32>>(law: &L, x: f32) -> f32 {
    match law.evaluate(x) {
        Response::Held(torque) => torque,
        other => panic!("{other:?}"),
    }
}
