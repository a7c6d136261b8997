use super::*;
use crate::certificate::Certified;
use crate::environment::{Canceller, Environment, Parts, Rational, Wall};
use crate::scene::{Coupling, Latency};
use crate::servo::{AtPhase, Latched, Simultaneous};
use crate::test_scene;

const fn scene(environment: Environment, coupling: f64) -> Scene {
    Scene { coupling: Coupling::Spring { stiffness: coupling }, ..test_scene::scene(environment) }
}

fn data(environment: Environment) -> Certified<Scene> {
    scene(environment, 44.0).certify().unwrap()
}

#[test]
fn an_undelayed_scene_is_for_simulations_alone() {
    let undelayed = Wall::damped(20.0, 0.01, 0).alone();
    let late = Wall::damped(2.0, 0.002, 1);
    let free = Canceller { residual: 0.001, delay: 0 }.alone();
    // Its wall is late, but its canceller is not.
    let canceller = Some(Canceller::to(0.015));
    let both = Parts { canceller, wall: Some(late), ..Parts::NONE }.sum();
    for environment in [undelayed, free, both] {
        let certified = data(environment);
        assert!(certified.time::<Simultaneous>().is_ok());
        assert_eq!(certified.time::<Latched>().unwrap_err(), TimingError::NotLate);
    }
    for environment in [late.alone(), Canceller { residual: 0.001, delay: 1 }.alone()] {
        assert!(data(environment).time::<Latched>().is_ok());
    }
}

/// A board fades in only scenes that pass with any torque limit.
#[test]
fn a_scene_that_must_not_be_limited_is_for_simulations_alone() {
    // Its coupling is softer than the standard one, and condition 18 requires more than the exact
    // rule.
    let stiff = scene(Wall::spring(15.0, 2).alone(), 33.0);
    let certified = stiff.certify().unwrap();
    let Err(TimingError::Limited { bound: Some(bound), limit: Some(limit) }) =
        certified.time::<Latched>()
    else {
        panic!("{:?}", certified.time::<Latched>())
    };
    assert!((bound - 0.0225).abs() < 1e-12 && (limit - 0.0165).abs() < 1e-12, "{bound} {limit}");
    assert_eq!(
        certified.time::<Simultaneous>().map(|_| ()).unwrap_err(),
        TimingError::Limited { bound: Some(bound), limit: Some(limit) }
    );
    // A coupling that is stiffer than the standard one has no limit that is known to do.
    let stiff = scene(Wall::spring(5.0, 1).alone(), 60.0).certify().unwrap();
    let error = stiff.time::<Latched>().unwrap_err();
    assert!(matches!(error, TimingError::Limited { bound: Some(_), limit: None }), "{error}");
    assert!(error.to_string().contains("soften the coupling"), "{error}");
}

#[test]
fn no_board_renders_a_rational_environment() {
    let prompt = Rational::of(&[8.0, -2.0], &[1.0, -0.5]).unwrap();
    let of = |delay| Environment::Rational(Rational { delay, ..prompt });
    let late = |delay| scene(of(delay), 44.0).certify().unwrap().time::<Latched>();
    assert_eq!(late(0).unwrap_err(), TimingError::NotLate);
    let error = late(1).unwrap_err();
    assert!(matches!(error, TimingError::Limited { bound: None, .. }), "{error}");
    assert!(error.to_string().contains("no bound is known then for a rational environment"));
}

/// Against the closed forms of theory, section 5: limit less index, from below and to the last
/// digits.
#[test]
fn the_room_is_what_the_index_leaves() {
    let close = |room: f64, expected: f64| {
        assert!(room <= expected && room > expected - 1e-12, "{room} for {expected}");
    };
    let sided = Wall::damped(4.0, 0.003, 1).behind(0.1);
    let wall = Wall::damped(4.0, 0.003, 1).alone();
    // Linear: K T / 2 + B, below delta; below K_vc T / 2 where the coupling is softer.
    let room =
        |scene: Scene| scene.certify().unwrap().timing_checked::<Latched>().injectable_damping();
    close(room(scene(wall, 44.0)), 0.022 - 0.005);
    close(room(scene(wall, 20.0)), 0.010 - 0.005);
    // Limited and one-sided: the bound is the same for this wall.
    close(room(Scene { torque_limit: Some(1.0), ..scene(wall, 44.0) }), 0.022 - 0.005);
    let sided = scene(sided.alone(), 44.0).certify().unwrap();
    close(sided.timing_checked::<Latched>().injectable_damping(), 0.022 - 0.005);
    // The bound of a wall that is later: K T (n - 1/2) + B.
    let later = Wall::damped(2.0, 0.003, 3).behind(0.1).alone();
    let later = scene(later, 44.0).certify().unwrap();
    close(later.timing_checked::<Latched>().injectable_damping(), 0.022 - 0.008);
}

/// A wall that is not late, behind the coupling that absorbs this output delay.
fn at_phase(output_delay: f64, output_jitter: f64) -> Certified<Scene> {
    let latency = Latency { output_jitter, ..Latency::delayed(output_delay) };
    let wall = Wall::damped(2.0, 0.002, 0).alone();
    Scene { coupling: Coupling::Matched, latency, ..scene(wall, 44.0) }.certify().unwrap()
}

#[test]
fn a_board_s_phase_is_the_scene_s_output_delay() {
    let scene = at_phase(1e-5, READ_WITHIN);
    assert!(scene.time::<AtPhase<10_000>>().is_ok());
    let other = scene.time::<AtPhase<11_000>>().unwrap_err();
    assert_eq!(other, TimingError::Phase { scene: 1e-5, board: 1.1e-5 });
    let still = at_phase(1e-5, 5e-7).time::<AtPhase<10_000>>().unwrap_err();
    assert_eq!(still, TimingError::Jitter { jitter: 5e-7 });
}

/// Beside a jitter of the torques, the time in which a board reads a count has to be a jitter of the counts.
#[test]
fn a_board_s_counts_deviate_by_the_count_jitter_of_the_scene_if_it_states_one() {
    let at = |output_jitter: f64, count_jitter: f64| {
        let latency = Latency { output_jitter, count_jitter, ..Latency::delayed(1e-5) };
        let wall = Wall::damped(2.0, 0.002, 0).alone();
        let scene = Scene { coupling: Coupling::Matched, latency, ..scene(wall, 44.0) };
        scene.certify().unwrap().time::<AtPhase<10_000>>().err()
    };
    assert_eq!(at(2e-6, 5e-7), Some(TimingError::Jitter { jitter: 5e-7 }));
    assert_eq!(at(2e-6, READ_WITHIN), None);
    assert_eq!(at(5e-7, READ_WITHIN), None);
    assert_eq!(at(0.0, READ_WITHIN), None);
}

/// Too short to compute a code in, and so long that the next one might be there.
#[test]
fn a_phase_has_its_range() {
    let range = |phase| TimingError::PhaseRange { phase, shortest: 5e-6, longest: 0.000999 };
    let short = at_phase(4.999e-6, READ_WITHIN).time::<AtPhase<4_999>>().unwrap_err();
    assert_eq!(short, range(4.999e-6));
    assert!(short.to_string().ends_with("between 5e-6 s and 0.000999 s"), "{short}");
    // Counts that are read late reach the torque of the next period.
    let long = at_phase(0.0009991, READ_WITHIN).time::<AtPhase<999_100>>().unwrap_err();
    assert_eq!(long, range(0.0009991));
    assert!(at_phase(5e-6, READ_WITHIN).time::<AtPhase<5_000>>().is_ok());
    assert!(at_phase(0.000999, READ_WITHIN).time::<AtPhase<999_000>>().is_ok());
    // And a board that judges for itself refuses the same.
    let judged = |scene: Certified<Scene>| {
        crate::certificate::timing_checked::<_, AtPhase<4_999>>(*scene.scene(), Format::F32)
    };
    assert_eq!(judged(at_phase(4.999e-6, READ_WITHIN)).unwrap_err(), Step::Certificate);
}
