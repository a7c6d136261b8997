use super::*;
use crate::certificate::Certified;
use crate::environment::{
    Anticogging, Canceller, CoggingMap, Environment, KNOB_MODES, Knots, Parts, Profile, Shape, Wall,
};
use crate::scene::Coupling;
use crate::scene_type::Typed;
use crate::servo::Latched;

const TRANSDUCERS: Transducers = Transducers::of(4096.0, 2.0);

const fn scene(environment: Environment) -> Scene {
    Scene { torque_limit: Some(1.0), ..crate::test_scene::scene(environment) }
}

const WALL: Scene = scene(Wall::damped(22.0, 0.01, 1).behind(0.0).alone());

/// The scene of a program with this environment.
macro_rules! program {
    ($environment:expr) => {{
        const CERTIFIED: Certified<Scene> = scene($environment).certified();
        crate::scene_type!(Of: CERTIFIED);
        *Typed::<Of>::certified().scene()
    }};
}

/// A wall with an undelayed canceller.
fn free_mode_wall(residual: f64, wall: Wall) -> Environment {
    Parts { canceller: Some(Canceller::to(residual)), wall: Some(wall), ..Parts::NONE }.sum()
}

fn refusal(changes: &[(Parameter, f64)]) -> String {
    let options = RenderingOptions::DEFAULT;
    let explained = explain::<_, f32, Latched>(&WALL, changes, &TRANSDUCERS, &options).unwrap_err();
    let refused = prepare::<_, f32, Latched>(&WALL, changes, &TRANSDUCERS, &options);
    assert_eq!(refused.map(|_| ()).unwrap_err(), explained.step());
    explained.to_string()
}

#[test]
fn every_scene_has_the_parameters_of_its_parts() {
    let damper = Wall::damped(2.0, 0.01, 1);
    let filtered = Wall::damped(2.0, 0.01, 1).filtered(0.5);
    let names = |parameters: Parameters| parameters.to_string();
    assert_eq!(
        names(parameters(&scene(Wall::spring(2.0, 1).alone()))),
        "stiffness, coupling.stiffness, torque_limit"
    );
    assert_eq!(
        names(parameters(&scene(filtered.placed(0.1).alone()))),
        "stiffness, damping, filter, face, coupling.stiffness, torque_limit"
    );
    let free =
        Scene { torque_limit: None, ..scene(Canceller { residual: 0.01, delay: 1 }.alone()) };
    assert_eq!(names(parameters(&free)), "residual, coupling.stiffness");
    let both = free_mode_wall(0.01, damper.behind(0.0));
    let both = Scene { coupling: Coupling::Rigid, ..scene(both) };
    assert_eq!(names(parameters(&both)), "stiffness, damping, face, residual, torque_limit");
    assert_eq!(
        names(parameters(&scene(Profile::of(&DETENTS, 1).alone()))),
        "coupling.stiffness, torque_limit, torque, count, centre"
    );
}

static COGGING: CoggingMap<8> = CoggingMap::of(&[1e-3, -1e-3, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]);
static DETENTS: Knots<16> = Knots::of(&[Shape::detents(24, 0.02)]);

fn changes_one<E: NamedParameters + Copy>(before: Scene<E>, wanted: Parameter, value: f64) {
    let after = apply(&before, &[(wanted, value)]).unwrap();
    for (name, parameter) in TUNABLE {
        let expected = if parameter == wanted { Some(value) } else { get(&before, parameter) };
        assert_eq!(get(&after, parameter), expected, "{name}");
    }
    assert_eq!((after.device, after.timing), (before.device, before.timing));
}

#[test]
fn a_change_is_made_where_it_belongs_and_nowhere_else() {
    for (i, (name, wanted)) in TUNABLE.into_iter().enumerate() {
        assert_eq!(parameter(name), Some(wanted));
        assert_eq!(super::name(wanted), Some(name));
        let filtered = Wall::damped(2.0, 0.01, 1).filtered(0.5);
        let wall = free_mode_wall(0.02, filtered.behind(0.1)).with(Parameter::Drag, 0.01).unwrap();
        let wall = wall.beside(Anticogging::of(&COGGING, 1.0));
        let value = 0.125 + i as f64;
        // No scene has the numbers of both, and those of several modes have no number but the mode's.
        match wanted {
            Parameter::Mode => {}
            Parameter::ProfileTorque | Parameter::Count | Parameter::Centre => {
                changes_one(scene(Profile::of(&DETENTS, 1).alone()), wanted, value);
            }
            _ => changes_one(scene(wall), wanted, value),
        }
    }
    assert_eq!(parameter("period"), None);
}

#[test]
fn a_torque_profile_has_its_own() {
    static KNOB: Knots<16> =
        Knots::of(&[Shape::detents(24, 0.02), Shape::end_stops(-1.0, 1.0, 5.0)]);
    static RANGE: Knots<64> = Knots::of(&[Shape::bistable(0.4, 0.05)]);
    let names = |parameters: Parameters| parameters.to_string();
    let knob = program!(Profile::of(&KNOB, 1).damped(0.001).alone());
    assert_eq!(
        names(parameters(&knob)),
        "stiffness, damping, coupling.stiffness, torque_limit, torque, count, centre"
    );
    let range = program!(Profile::of(&RANGE, 1).alone());
    assert_eq!(names(parameters(&range)), "stiffness, coupling.stiffness, torque_limit, torque");
    let more = apply(&knob, &[(Parameter::Count, 36.0), (Parameter::ProfileTorque, 0.03)]).unwrap();
    assert_eq!(get(&more, Parameter::Count), Some(36.0));
    assert_eq!(get(&more, Parameter::ProfileTorque), Some(0.03));
}

#[test]
fn a_knob_of_several_modes_has_the_number_of_the_selected_one() {
    let knob = program!(Profile::of_modes(&KNOB_MODES, 1).alone());
    let names = parameters(&knob).to_string();
    assert_eq!(names, "coupling.stiffness, torque_limit, mode");
    changes_one(knob, Parameter::Mode, 4.0);
    let options = RenderingOptions::DEFAULT;
    let prepared = |mode| {
        prepare::<_, f32, Latched>(&knob, &[(Parameter::Mode, mode)], &TRANSDUCERS, &options)
    };
    for mode in 0..KNOB_MODES.len() {
        let scene = prepared(mode as f64).unwrap().scene;
        assert_eq!(get(&scene, Parameter::Mode), Some(mode as f64));
    }
    for (mode, shown) in
        [(11.0, "11"), (-1.0, "-1"), (2.5, "2.5"), (4_294_967_296.0, "4.294967296e9")]
    {
        assert_eq!(prepared(mode).map(|_| ()).unwrap_err(), Step::Certificate);
        let explained =
            explain::<_, f32, Latched>(&knob, &[(Parameter::Mode, mode)], &TRANSDUCERS, &options);
        assert_eq!(
            explained.unwrap_err().to_string(),
            format!("rejected: the mode is {shown}, and must be a whole number from 0 to 10")
        );
    }
    assert_eq!(prepared(f64::NAN).map(|_| ()).unwrap_err(), Step::Certificate);
}

#[test]
fn what_cannot_be_changed_is_refused_in_a_sentence() {
    assert_eq!(
        refusal(&[(Parameter::Residual, 0.001)]),
        "this scene has no residual; it has stiffness, damping, face, coupling.stiffness, \
         torque_limit"
    );
    assert_eq!(
        refusal(&[(Parameter::Period, 0.002)]),
        "the period is fixed while the program runs; the tunable parameters are stiffness, damping, \
         filter, face, residual, coupling.stiffness, torque_limit, torque, count, centre, mode, drag, \
         anticogging"
    );
    assert!(refusal(&[(Parameter::DeviceDamping, 1.0)]).starts_with("the device damping is fixed"));
    let twice = [(Parameter::Face, 0.1), (Parameter::Stiffness, 1.0), (Parameter::Face, 0.1)];
    assert_eq!(refusal(&twice), "face is given twice");
}

#[test]
fn a_set_is_judged_as_a_whole_and_by_the_compilers_own_sentence() {
    let stiff = Scene { environment: Wall::damped(30.0, 0.01, 1).behind(0.0).alone(), ..WALL };
    let sentence = stiff.certify().unwrap_err().sentence();
    assert_eq!(refusal(&[(Parameter::Stiffness, 30.0)]), sentence.as_str());
    // Each alone would not pass, or would; together they do.
    let softer = [(Parameter::Stiffness, 30.0), (Parameter::Damping, 0.005)];
    let options = RenderingOptions::DEFAULT;
    let scene = prepare::<_, f32, Latched>(&WALL, &softer, &TRANSDUCERS, &options).unwrap().scene;
    assert_eq!(scene.environment, Wall::damped(30.0, 0.005, 1).behind(0.0).alone());
    assert_eq!(
        refusal(&[(Parameter::TorqueLimit, 2.5)]),
        "the torque limit of 2.5 N m is above the DAC's full scale of 2 N m: lower it to \
         that, or scale the amplifier up"
    );
    assert!(refusal(&[(Parameter::Stiffness, f64::NAN)]).contains("the stiffness is NaN"));
}

/// A softer wall and a higher limit return more energy to a supply that takes 40 mJ: at the first values
/// `L^2 (1/22 + 1/44)` = 34 mJ with a limit of 0.7 N m, and 0.11 J of the device at 100 rad/s.
#[test]
fn a_change_that_returns_more_than_the_supply_takes_is_refused() {
    let mut limited = WALL;
    limited.torque_limit = Some(0.7);
    let options = |largest| RenderingOptions { returned: largest, ..RenderingOptions::DEFAULT };
    let prepared = |changes: &[(Parameter, f64)], options| {
        prepare::<_, f32, Latched>(&limited, changes, &TRANSDUCERS, &options).map(|_| ())
    };
    let takes = options(Some(0.11 + 0.040));
    assert_eq!(prepared(&[], takes), Ok(()));
    for changes in [[(Parameter::Stiffness, 15.0)], [(Parameter::TorqueLimit, 0.8)]] {
        assert_eq!(prepared(&changes, takes), Err(Step::Servo));
        assert_eq!(prepared(&changes, options(None)), Ok(()));
        let told = explain::<_, f32, Latched>(&limited, &changes, &TRANSDUCERS, &takes);
        let told = told.unwrap_err().to_string();
        assert!(told.contains("J to the supply, which takes less than 0.15 J"), "{told}");
    }
    let stiffer = [(Parameter::TorqueLimit, 0.75)];
    assert_eq!(prepared(&stiffer, takes), Ok(()));
}
