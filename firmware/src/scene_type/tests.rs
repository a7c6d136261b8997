//! The servo of a program against the servo of the same scene as data: the same bits.

use fixed::types::I8F24;
use proptest::prelude::*;

use super::*;
use crate::encoder::RawCount;
use crate::energy::NoAction;
use crate::environment::{
    Canceller, Drag, KNOB_MODES, Knots, ModeTable, Profile, ProfileMode, Shape,
};
use crate::scene::{Latency, TimeRange};
use crate::servo::{Latched, Output, Servo};
use crate::test_scene::{self, TRANSDUCERS};

const PERIOD: f64 = 1e-3;

const fn scene(environment: Environment) -> Scene {
    Scene { torque_limit: Some(0.5), ..test_scene::scene(environment) }
}

const fn rigid(environment: Environment) -> Scene {
    Scene { coupling: Coupling::Rigid, ..scene(environment) }
}

const fn matched(environment: Environment, latency: Latency) -> Scene {
    Scene { coupling: Coupling::Matched, latency, ..scene(environment) }
}

/// An output delay in s with its jitter.
const fn delayed(delay: f64) -> Latency {
    Latency { output_jitter: 1e-6, ..Latency::delayed(delay) }
}

const SPRING: Wall = Wall::spring(2.0, 3);
const DAMPED: Wall = Wall::damped(12.0, 0.005, 1);
const UNDELAYED: Wall = Wall::damped(20.0, 0.01, 0);
const FILTERED: Wall = Wall::damped(5.0, 0.01, 2).filtered(0.8);
/// Walls that leave room for a profile.
const SOFT: Wall = Wall::damped(5.0, 0.002, 1);
const LATE: Wall = Wall::damped(3.0, 0.001, 2);

const fn free_mode(residual: f64, wall: Option<Wall>, profile: Option<Profile>) -> Environment {
    Parts { canceller: Some(Canceller::to(residual)), wall, profile, ..Parts::NONE }.sum()
}

const fn beside(wall: Wall, profile: Profile) -> Environment {
    Parts { wall: Some(wall), profile: Some(profile), ..Parts::NONE }.sum()
}

/// The same with a drag of this damping and delay.
const fn dragging(environment: Environment, damping: f64, delay: usize) -> Environment {
    Parts { drag: Some(Drag::of(damping, delay)), ..*environment.parts() }.sum()
}

static ENDLESS: Knots<16> = Knots::of(&[Shape::detents(24, 0.02)]);
static KNOB: Knots<16> = Knots::of(&[Shape::detents(24, 0.02), Shape::end_stops(-2.0, 2.0, 5.0)]);
static SNAP: Knots<64> =
    Knots::of(&[Shape::detents(24, 0.02).snap(1.1), Shape::end_stops(-2.0, 2.0, 5.0)]);
static SNAP_ENDLESS: Knots<64> =
    Knots::of(&[Shape::detents(24, 0.05).snap(0.6), Shape::detents(8, 0.01)]);
static SNAP_MODE: ModeTable<16> =
    ModeTable::of(&[Shape::detents(24, 0.05).snap(1.1), Shape::end_stops(-1.0, 1.0, 15.0)]);
static SNAP_MODES: [ProfileMode; 1] = [SNAP_MODE.named("snap")];

const fn knob(delay: usize) -> Profile {
    Profile::of(&KNOB, delay)
}

const fn endless(delay: usize) -> Profile {
    Profile::of(&ENDLESS, delay)
}

const fn mode(number: f64) -> Environment {
    Profile::of_modes(&KNOB_MODES, 1).selecting(number).unwrap().alone()
}

/// Checks the program of each scene at these counts, in floating and in fixed point. Each format compiles all of
/// the servo once more, and `f64` has the code of `f32`.
macro_rules! programs {
    ($($scene:expr),* $(,)?) => {
        fn every_program(counts: &[i32], is_felt: bool) {
            $({
                const CERTIFIED: Certified<Scene> = $scene.certified();
                crate::scene_type!(Of: CERTIFIED);
                is_its_data::<Of, f32>(counts, is_felt);
                is_its_data::<Of, I8F24>(counts, is_felt);
            })*
        }
    };
}

programs![
    scene(Wall::spring(22.0, 1).alone()),
    scene(Wall::spring(22.0, 0).alone()),
    scene(Wall::spring(2.0, 8).alone()),
    scene(Wall::spring(4.0, 3).behind(0.02).alone()),
    scene(DAMPED.alone()),
    scene(UNDELAYED.alone()),
    scene(FILTERED.alone()),
    scene(DAMPED.placed(0.05).alone()),
    scene(UNDELAYED.placed(-0.05).alone()),
    scene(FILTERED.placed(0.02).alone()),
    scene(DAMPED.behind(0.05).alone()),
    scene(UNDELAYED.behind(-0.05).alone()),
    scene(FILTERED.behind(0.02).alone()),
    scene(Canceller::to(0.001).alone()),
    scene(Canceller { residual: 0.015, delay: 1 }.alone()),
    scene(free_mode(0.015, Some(DAMPED), None)),
    scene(free_mode(0.015, Some(DAMPED.behind(0.05)), None)),
    scene(free_mode(0.015, Some(UNDELAYED.behind(0.05)), None)),
    scene(endless(0).alone()),
    scene(endless(1).alone()),
    scene(knob(2).alone()),
    scene(knob(1).damped(0.001).alone()),
    scene(Profile::of(&SNAP, 1).alone()),
    scene(Profile::of(&SNAP_ENDLESS, 0).alone()),
    scene(mode(4.0)),
    scene(Profile::of_modes(&SNAP_MODES, 1).alone()),
    scene(free_mode(0.018, None, Some(endless(1)))),
    scene(free_mode(0.018, None, Some(knob(2)))),
    scene(beside(SPRING, knob(2))),
    scene(beside(SPRING.behind(0.3), knob(2))),
    scene(beside(SOFT, knob(2))),
    scene(beside(UNDELAYED.behind(0.3), knob(2))),
    scene(free_mode(0.018, Some(LATE.behind(0.3)), Some(knob(2)))),
    scene(free_mode(0.018, Some(SPRING), Some(knob(2)))),
    scene(Drag::of(0.01, 0).alone()),
    scene(dragging(DAMPED.behind(0.05).alone(), 0.004, 1)),
    scene(dragging(UNDELAYED.behind(0.05).alone(), -0.004, 2)),
    scene(dragging(free_mode(0.018, Some(LATE.behind(0.3)), Some(knob(2))), 0.001, 0)),
    scene(dragging(free_mode(0.018, None, Some(endless(1))), -0.001, 3)),
    // Without lags, with one, with three, with whole samples, and with updates within a period.
    matched(free_mode(0.018, Some(UNDELAYED.behind(0.3)), Some(knob(2))), delayed(2e-4)),
    matched(Profile::of(&SNAP_ENDLESS, 0).alone(), Latency::delayed(5e-4)),
    matched(DAMPED.behind(0.05).alone(), Latency::NONE.with_actuator_lag(4e-4)),
    matched(Canceller { residual: 0.015, delay: 2 }.alone(), Latency::NONE.with_actuator_lag(4e-4)),
    matched(
        UNDELAYED.behind(0.05).alone(),
        Latency {
            sensor_lag: TimeRange::between(5e-5, 6e-5),
            ..Latency::delayed(1e-4).with_actuator_lag(2e-4)
        }
    ),
    matched(UNDELAYED.behind(0.05).alone(), delayed(1.2e-3)),
    matched(DAMPED.alone(), delayed(2.2e-3).with_actuator_lag(1e-4)),
    matched(DAMPED.behind(0.0).alone(), Latency::sampled(40, 8e-5, PERIOD)),
    rigid(Wall::damped(6.0, 0.004, 1).behind(0.1).alone()),
    rigid(Canceller::to(0.015).alone()),
    rigid(beside(Wall::damped(2.0, 0.003, 1), knob(1))),
];

/// The outputs and the torques' bits at these counts.
fn outputs<E: Rendering<N>, N: Number>(
    scene: &Scene<E>,
    counts: &[i32],
    tick: fn(&mut Servo<E, N>, RawCount) -> Output,
) -> Vec<(Output, u64)> {
    let mut servo = Servo::build(scene, &TRANSDUCERS).unwrap();
    let mut at = |count: i32| {
        let output = tick(&mut servo, RawCount::from(count));
        (output, servo.torque_nm().to_bits())
    };
    counts.iter().map(|count| at(*count)).collect()
}

/// Whether there was a torque in simultaneous ticks.
fn is_same<S: SceneType, N: Number>(
    program: &Scene<Typed<S>>,
    data: &Scene,
    counts: &[i32],
) -> bool {
    let of_program = outputs::<_, N>(program, counts, Servo::tick);
    let of_data = outputs::<_, N>(data, counts, Servo::tick);
    let differs = of_program.iter().zip(&of_data).position(|(a, b)| a != b);
    assert_eq!(differs, None, "{data:?}");
    if data.environment.is_late() {
        let of_program = outputs::<_, N>(program, counts, |servo, raw| {
            servo.timed_tick::<Latched>(raw, &mut NoAction)
        });
        let of_data = outputs::<_, N>(data, counts, |servo, raw| {
            servo.timed_tick::<Latched>(raw, &mut NoAction)
        });
        let differs = of_program.iter().zip(&of_data).position(|(a, b)| a != b);
        assert_eq!(differs, None, "latched: {data:?}");
    }
    of_program.iter().any(|(_, bits)| bits << 1 != 0)
}

/// With the numbers of its constant, and with others.
fn is_its_data<S: SceneType, N: Number>(counts: &[i32], is_felt: bool) {
    let (mut program, mut data) = (*Typed::<S>::certified().scene(), *S::CERTIFIED.scene());
    assert_eq!(Typed::<S>::of(&data), Some(program));
    let has_torque = is_same::<S, N>(&program, &data, counts);
    assert!(has_torque || !is_felt, "no torque: {data:?}");
    if S::CERTIFIED.scene().environment.profile().is_some_and(|profile| profile.modes.is_some()) {
        return;
    }
    for parameter in [
        Parameter::Stiffness,
        Parameter::Damping,
        Parameter::Filter,
        Parameter::Face,
        Parameter::Residual,
        Parameter::Drag,
        Parameter::ProfileTorque,
        Parameter::Centre,
        Parameter::From,
        Parameter::To,
        Parameter::CouplingStiffness,
        Parameter::TorqueLimit,
    ] {
        let numbers = (program.value(parameter), data.value(parameter));
        assert_eq!(numbers.0, numbers.1, "{parameter:?}: {data:?}", data = S::CERTIFIED.scene());
        if let (Some(of_program), Some(of_data)) = numbers {
            (*of_program, *of_data) = (0.9 * *of_program, 0.9 * *of_data);
        }
    }
    is_same::<S, N>(&program, &data, counts);
}

/// A hand that pushes in, trembles and comes back, at most about 0.2 rad, and then turns a knob from one end
/// stop to the other.
#[test]
fn a_program_gives_a_hand_the_torques_of_its_data() {
    let waves = |t: f64, waves: [(f64, f64); 3]| {
        waves.into_iter().map(|(counts, rate)| counts * (rate * t).sin()).sum::<f64>() as i32
    };
    let times = |ticks: i32| (0..ticks).map(|tick| f64::from(tick) * PERIOD);
    let push = times(3000).map(|t| waves(t, [(1200.0, 3.0), (700.0, 11.0), (40.0, 150.0)]));
    let turn = times(6000).map(|t| waves(t, [(18_600.0, 3.0), (2900.0, 71.0), (200.0, 370.0)]));
    every_program(&push.chain(turn).collect::<Vec<_>>(), true);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(32))]

    /// Across faces, end stops and turns.
    #[test]
    fn a_program_gives_the_torques_of_its_data(
        steps in prop::collection::vec(prop_oneof![-40..40_i32, -4_000..4_000_i32], 400),
    ) {
        let walk = |count: &mut i32, step: &i32| {
            *count = (*count + step).clamp(-600_000, 600_000);
            Some(*count)
        };
        every_program(&steps.iter().scan(0, walk).collect::<Vec<_>>(), false);
    }
}

const UNDAMPED: Certified<Scene> =
    scene(Wall::damped(10.0, 0.0, 1).behind(0.01).alone()).certified();
crate::scene_type!(Undamped: UNDAMPED);

/// A number is never part of the structure, not even a zero.
#[test]
fn a_damper_without_damping_may_get_some() {
    let mut program = *Typed::<Undamped>::certified().scene();
    *program.value(Parameter::Damping).unwrap() = 0.01;
    let data = scene(Wall::damped(10.0, 0.01, 1).behind(0.01).alone());
    let counts: Vec<i32> =
        (0..1000).map(|k| (900.0 * (f64::from(k) * 0.01).sin()) as i32 + k % 50).collect();
    assert!(is_same::<Undamped, f32>(&program, &data, &counts));
    let torques = |scene: &Scene| outputs::<Environment, f32>(scene, &counts, Servo::tick);
    assert_ne!(torques(&data), torques(UNDAMPED.scene()));
}

#[test]
fn a_program_does_not_have_the_numbers_of_what_its_scene_lacks() {
    let mut program = *Typed::<Undamped>::certified().scene();
    for parameter in [Parameter::Filter, Parameter::Residual, Parameter::ProfileTorque] {
        assert_eq!(program.value(parameter), None, "{parameter:?}");
    }
    const CERTIFIED: Certified<Scene> = scene(Wall::spring(10.0, 1).alone()).certified();
    crate::scene_type!(Spring: CERTIFIED);
    let mut program = *Typed::<Spring>::certified().scene();
    assert_eq!(program.value(Parameter::Stiffness), Some(&mut 10.0));
    for parameter in [Parameter::Damping, Parameter::Face] {
        assert_eq!(program.value(parameter), None, "{parameter:?}");
    }
}

/// A scene of the same structure is taken over with its numbers, one of another structure is not.
#[test]
fn a_program_takes_scenes_of_its_structure() {
    let wall = Wall::damped(9.0, 0.003, 1).behind(-0.2);
    let other = Scene { torque_limit: None, ..scene(wall.alone()) };
    let program = Typed::<Undamped>::of(&other).unwrap();
    assert_eq!(crate::certificate::scene_data(&program), other);
    for wall in [Wall { delay: 2, ..wall }, Wall { damper: None, ..wall }, wall.placed(0.1)] {
        assert_eq!(Typed::<Undamped>::of(&scene(wall.alone())), None, "{wall:?}");
    }
    assert_eq!(Typed::<Undamped>::of(&matched(wall.alone(), Latency::NONE)), None);
}

/// Its law and its memory refuse numbers of another structure.
#[test]
fn a_program_renders_no_other_structure() {
    const CERTIFIED: Certified<Scene> =
        matched(beside(SOFT, knob(1)), Latency::NONE.with_actuator_lag(1e-4)).certified();
    crate::scene_type!(Of: CERTIFIED);
    let context = CERTIFIED.scene().context();
    let law = |wall: Option<Wall>, profile: Profile| {
        let parts = Parts { wall, profile: Some(profile), ..Parts::NONE };
        <Of as SceneType>::Law::<f32>::law_of(&parts, &context).map(|_| ())
    };
    assert_eq!(law(Some(SOFT), knob(1)), Ok(()));
    for wall in [
        None,
        Some(Wall { delay: 2, ..SOFT }),
        Some(Wall { damper: None, ..SOFT }),
        Some(SOFT.filtered(0.5)),
        Some(SOFT.behind(0.0)),
        Some(SOFT.placed(0.0)),
    ] {
        assert_eq!(law(wall, knob(1)), Err(BuildError::Structure), "{wall:?}");
    }
    let mut snapping = knob(1);
    snapping.snap = Profile::of(&SNAP, 1).snap;
    for profile in [knob(2), knob(1).damped(0.0), snapping] {
        assert_eq!(law(Some(SOFT), profile), Err(BuildError::Structure), "{profile:?}");
    }
    let canceller =
        Parts { canceller: Some(Canceller::to(0.01)), ..*CERTIFIED.scene().environment.parts() };
    let refused = <Of as SceneType>::Law::<f32>::law_of(&canceller, &context).map(|_| ());
    assert_eq!(refused, Err(BuildError::Structure));

    let program = *Typed::<Of>::certified().scene();
    let built = |scene: Scene<_>| Servo::<_, f32>::build(&scene, &TRANSDUCERS).map(|_| ());
    assert_eq!(built(program), Ok(()));
    let latency = |latency| Scene { latency, ..program };
    for other in [
        Scene { coupling: Coupling::Rigid, ..program },
        Scene { coupling: Coupling::Spring { stiffness: 44.0 }, ..program },
        latency(Latency { sensor_lag: TimeRange::exactly(2e-4), ..program.latency }),
        latency(delayed(1.5e-3).with_actuator_lag(1e-4)),
    ] {
        assert_eq!(built(other), Err(BuildError::Structure), "{other:?}");
    }
    let uncoupled =
        Scene { coupling: Coupling::Matched, ..*Typed::<Undamped>::certified().scene() };
    let refused = Servo::<_, f32>::build(&uncoupled, &TRANSDUCERS).map(|_| ());
    assert_eq!(refused, Err(BuildError::Structure));
}
