use super::*;
use crate::environment::{DamperWall, DelayedSpring, FreeMode, FreeModeWall, OneSided, Rational};
use crate::scene::{Coupling, Device, Timing};
use crate::servo::{Immediate, Latched, Simultaneous};

const fn scene<E>(environment: E, coupling: f64) -> Scene<E> {
    Scene {
        device: Device { inertia: 2.2e-5, damping: 0.022, passivity: None },
        timing: Timing { period: 1e-3, worst_period: None },
        coupling: Coupling::Spring { stiffness: coupling },
        environment,
        torque_limit: None,
    }
}

fn data(environment: Environment) -> Certified<Scene> {
    scene(environment, 44.0).certify().unwrap()
}

#[test]
fn an_undelayed_scene_is_for_simulations_alone() {
    let undelayed = DamperWall::<0> { stiffness: 20.0, damping: 0.01 }.as_data();
    let late = DamperWall::<1> { stiffness: 2.0, damping: 0.002 };
    let free = FreeMode::<0> { residual: 0.001 }.as_data();
    // Its wall is late, but its canceller is not.
    let both = FreeModeWall { residual: 0.015, wall: late }.as_data();
    for environment in [undelayed, free, both] {
        let certified = data(environment);
        assert!(certified.time::<Simultaneous>().is_ok());
        assert_eq!(certified.time::<Latched>().unwrap_err(), TimingError::NotLate);
        assert_eq!(certified.time::<Immediate<1>>().unwrap_err(), TimingError::NotLate);
    }
    for environment in [late.as_data(), FreeMode::<1> { residual: 0.001 }.as_data()] {
        assert!(data(environment).time::<Latched>().is_ok());
        assert!(data(environment).time::<Immediate<5000>>().is_ok());
    }
}

#[test]
fn a_latency_has_to_fit_into_a_sample() {
    let spring = scene(DelayedSpring::<1> { stiffness: 22.0 }, 44.0).certify().unwrap();
    assert!(spring.time::<Immediate<1_000_000>>().is_ok());
    let error = spring.time::<Immediate<1_000_001>>().unwrap_err();
    assert_eq!(
        error.to_string(),
        "a torque takes up to 0.001000001 s to the motor, more than the period of 0.001 s: \
         lengthen the period, or latch the torque by the timer"
    );
}

#[test]
fn what_comes_early_has_to_pass_early() {
    // Behind so soft a coupling a damper that is less late is too much.
    let soft = scene(DamperWall::<2> { stiffness: 2.0, damping: 0.002 }, 5.0);
    let certified = soft.certify().unwrap();
    assert!(certified.time::<Latched>().is_ok());
    let earlier = scene(DamperWall::<1> { stiffness: 2.0, damping: 0.002 }, 5.0);
    let rejection = earlier.certify().unwrap_err();
    match certified.time::<Immediate<1000>>().unwrap_err() {
        TimingError::Early(early) => assert_eq!(early.reason(), rejection.reason()),
        other => panic!("{other}"),
    }
}

#[test]
fn a_rational_environment_is_as_late_as_it_says() {
    use crate::environment::Coefficients;
    let of = |delay| Rational {
        numerator: Coefficients::new(&[8.0, -2.0]).unwrap(),
        denominator: Coefficients::new(&[1.0, -0.5]).unwrap(),
        delay,
        unit_zeros: 0,
    };
    let late = |delay| scene(of(delay), 44.0).certify().unwrap().time::<Latched>();
    assert_eq!(late(0).unwrap_err(), TimingError::NotLate);
    assert!(late(1).is_ok());
}

/// Against the closed forms of theory, section 5: limit less index, from below and to the last
/// digits.
#[test]
fn the_room_is_what_the_index_leaves() {
    let close = |room: Option<f64>, expected: f64| {
        let room = room.unwrap();
        assert!(room <= expected && room > expected - 1e-12, "{room} for {expected}");
    };
    let wall = DamperWall::<1> { stiffness: 4.0, damping: 0.003 };
    // Linear: K T / 2 + B, below delta; below K_vc T / 2 where the coupling is softer.
    let room = |scene: Scene<DamperWall<1>>| scene.certify().unwrap().timed::<Latched>().room();
    close(room(scene(wall, 44.0)), 0.022 - 0.005);
    close(room(scene(wall, 20.0)), 0.010 - 0.005);
    // Limited and one-sided: the bound is the same for this wall.
    close(room(Scene { torque_limit: Some(1.0), ..scene(wall, 44.0) }), 0.022 - 0.005);
    let sided = scene(OneSided { face: 0.1, wall }, 44.0).certify().unwrap();
    close(sided.timed::<Latched>().room(), 0.022 - 0.005);
    // The bound of a wall that is later: K T (n - 1/2) + B.
    let later = DamperWall::<3> { stiffness: 2.0, damping: 0.003 };
    let later = scene(OneSided { face: 0.1, wall: later }, 44.0).certify().unwrap();
    close(later.timed::<Latched>().room(), 0.022 - 0.008);
    // No room beside a stiffer coupling than the standard one, or a rigid one.
    assert_eq!(room(scene(wall, 45.0)), None);
    let rigid = Scene { coupling: Coupling::Rigid, ..scene(wall, 44.0) };
    assert_eq!(room(rigid), None);
}
