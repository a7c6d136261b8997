use haptic_servo::environment::Wall;
use haptic_servo::scene::{Coupling, Device, Scene};

use super::*;
use crate::device::Hand;
use crate::fixture::on_paddle;
use crate::simulation::method::Method;
use crate::simulation::plant::Plant;

/// The mass and damper of theory, section 5.
const DEVICE: Device = Device { inertia: 0.05, damping: 0.5, passivity: None };

fn spring(stiffness: f64, delay: usize, coupling: Coupling) -> Experiment {
    let spring = on_paddle(Wall::spring(stiffness, delay).alone(), coupling);
    Experiment::still(&Scene { device: DEVICE, ..spring })
}

fn critical(experiment: &Experiment, method: Method, substeps: u32) -> f64 {
    critical_stiffness(experiment, Integration { method, substeps }).unwrap().unwrap()
}

fn near(is: f64, should: f64, within: f64) {
    assert!((is - should).abs() <= within, "{is} instead of {should}");
}

/// The passivity limit `b / (T (n - 1/2))` of theory, section 5, is nearly that of the device in no
/// hand, and never above it. The numbers are from the characteristic equation in closed form,
/// `K = -z^n / (1 / K_vc + G(z))` where that is real on the unit circle.
#[test]
fn delayed_springs_behind_the_standard_coupling() {
    let coupling = Coupling::Spring { stiffness: 1000.0 };
    for (delay, limit) in [(1, 1_000.008_333), (2, 334.131_266), (3, 200.740_941)] {
        let found = critical(&spring(1.0, delay, coupling), Method::Exact, 1);
        near(found, limit, 1e-6);
        let passive = 0.5 / (1e-3 * (delay as f64 - 0.5));
        assert!(found >= passive && found < 1.005 * passive);
    }
}

/// Theory, section 9: the verdict depends on the integrator.
#[test]
fn apparent_limits_of_the_methods() {
    let bare = spring(1.0, 0, Coupling::Rigid);
    near(critical(&bare, Method::Exact, 1), 1001.67, 5e-3);
    near(critical(&bare, Method::Euler, 1), 500.0, 1e-6);
    near(critical(&bare, Method::SemiImplicit, 1), 199_000.0, 1e-4);
    near(critical(&bare, Method::Euler, 10), 910.0, 2.0);
    near(critical(&bare, Method::SemiImplicit, 10), 1113.0, 2.0);
    near(critical(&bare, Method::Rk4, 1), 1001.67, 5e-3);
}

#[test]
fn the_radius_is_one_at_the_critical_stiffness_and_the_loop_differs_on_its_sides() {
    let standard = Coupling::Spring { stiffness: 1000.0 };
    let hand = Hand { inertia: 0.02, damping: 0.1, stiffness: 300.0 };
    for delay in 0..5 {
        let mut experiment = spring(1.0, delay, standard);
        experiment.plant = experiment.plant.clone().with_hand(hand);
        experiment.latency = if delay == 2 { 3e-4 } else { 0.0 };
        let Some(limit) = critical_stiffness(&experiment, Integration::default()).unwrap() else {
            assert_eq!(delay, 0);
            continue;
        };
        let at = |stiffness: f64| {
            let scene = experiment.scene.with(Parameter::Stiffness, stiffness).unwrap();
            judge(&Experiment { scene, ..experiment.clone() }, Integration::default()).unwrap()
        };
        near(at(limit).spectral_radius, 1.0, 1e-11);
        assert_eq!(at(limit).verdict, StabilityVerdict::Marginal);
        assert_eq!(at(limit * (1.0 - 1e-5)).verdict, StabilityVerdict::Stable);
        assert_eq!(at(limit * (1.0 + 1e-5)).verdict, StabilityVerdict::Unstable);
    }
}

#[test]
fn a_device_that_stays_where_it_is_left_is_marginal_and_one_that_drifts_is_not() {
    let free = |damping: f64| {
        let device = Device { damping, ..DEVICE };
        let mut experiment = spring(0.0, 1, Coupling::Rigid);
        experiment.plant = Plant::rigid(device);
        judge(&experiment, Integration::default()).unwrap()
    };
    assert_eq!(free(0.5).verdict, StabilityVerdict::Marginal);
    near(free(0.5).spectral_radius, 1.0, 1e-14);
    assert_eq!(free(0.0).verdict, StabilityVerdict::Unstable);
}

/// A device without damping has no passivity to certify with, and moves all the same.
#[test]
fn a_scene_without_passivity_has_a_loop() {
    let mut experiment = spring(100.0, 1, Coupling::Spring { stiffness: 1000.0 });
    experiment.scene.device.damping = 0.0;
    for passivity in [None, Some(0.0), Some(f64::NAN)] {
        experiment.scene.device.passivity = passivity;
        experiment.plant = Plant::rigid(experiment.scene.device);
        let stability = judge(&experiment, Integration::default()).unwrap();
        assert_eq!(stability.verdict, StabilityVerdict::Unstable);
        let held = Hand { inertia: 0.0, damping: 0.5, stiffness: 0.0 };
        experiment.plant = experiment.plant.clone().with_hand(held);
        assert_eq!(
            judge(&experiment, Integration::default()).unwrap().verdict,
            StabilityVerdict::Stable
        );
    }
}

/// A scan of the spectral radius in small steps of the stiffness, for loops that are stable from
/// the start, from somewhere on, and never.
#[test]
fn the_crossing_is_the_first_that_a_scan_sees() {
    for (damping, delay, coupling) in [
        (0.2, 1, Coupling::Rigid),
        (0.2, 2, Coupling::Spring { stiffness: 700.0 }),
        (-0.2, 1, Coupling::Spring { stiffness: 2000.0 }),
        (-0.7, 1, Coupling::Rigid),
        (0.45, 3, Coupling::Spring { stiffness: 1000.0 }),
    ] {
        let mut experiment = spring(1.0, delay, coupling);
        experiment.scene.environment = Wall::damped(1.0, damping, delay).alone();
        let stable = |stiffness: f64| {
            let scene = experiment.scene.with(Parameter::Stiffness, stiffness).unwrap();
            let experiment = Experiment { scene, ..experiment.clone() };
            let closed = closed_loop(&experiment, Integration::default()).unwrap();
            radius(&eigenvalues(&closed.matrix).unwrap()) <= 1.0
        };
        const STEP: f64 = 1.003;
        let steps: Vec<f64> = (0..4000).map(|i| 0.01 * STEP.powi(i)).collect();
        let crossing = steps.windows(2).find(|pair| stable(pair[0]) && !stable(pair[1]));
        let found = critical_stiffness(&experiment, Integration::default()).unwrap();
        match (crossing, found) {
            (None, None) => {}
            (Some(pair), Some(found)) => assert!((pair[0]..=pair[1]).contains(&found), "{found}"),
            other => panic!("{damping} {delay} {other:?}"),
        }
    }
}

fn of_text(text: &str) -> Experiment {
    use crate::file::{Format, Purpose, parse_for};
    let file = parse_for(Purpose::Simulate, "", Format::Json, text);
    Experiment::at_rest(&file.unwrap_or_else(|why| panic!("{why}")))
}

/// A band-pass of order 4 from 2 to 8 Hz at 1 kHz: of its clustered poles eigenvalues in doubles keep three
/// digits. The radius was computed from the same numbers at 80 digits by the roots of the polynomial.
#[test]
fn the_radius_of_clustered_poles_is_enclosed() {
    let experiment = of_text(
        r#"{"name": "band-pass", "device": {"inertia": 0.0001, "damping": 0.02},
        "servo": {"period": 0.001}, "environment": {"type": "rational", "numerator":
        [2.4046232418060113e-08, 0.0, -9.618492967224045e-08, 0.0, 1.4427739450836068e-07, 0.0,
        -9.618492967224045e-08, 0.0, 2.4046232418060113e-08], "denominator": [1.0, -7.898994631738863,
        27.30046716057528, -53.923584135572014, 66.57573592027406, -52.611633221006294, 25.988205357868814,
        -7.336374597210256, 0.9061781468094346], "delay": 0},
        "human": {"inertia": 0.0, "damping": 0.001, "stiffness": 0.5}}"#,
    );
    let found = judge(&experiment, Integration::default()).unwrap();
    assert_eq!(found.verdict, StabilityVerdict::Stable);
    let [low, high] = found.spectral_radius_enclosure;
    assert!(low <= 0.998_460_940_873_483_1 && high >= 0.998_460_940_873_483, "{low} {high}");
    assert!(high - low < 1e-14);
}

/// A negative damper that only a spring holds: both ends were computed at 80 digits by bisection.
#[test]
fn both_ends_of_the_stable_stiffnesses_are_given() {
    let experiment = of_text(
        r#"{"name": "two", "device": {"inertia": 0.15538308190117617, "damping": 3.828832126199168},
        "servo": {"period": 0.001}, "environment": {"type": "damper-wall", "stiffness": 3224.0618253567386,
        "damping": -71.92385590529695, "delay": 0, "filter": 0.99}}"#,
    );
    let found = judge(&experiment, Integration::default()).unwrap();
    let Some([Some(from), Some(to)]) = found.stable_stiffness else { panic!("{found:?}") };
    near(from, 980.155_891_898_41, 1e-6);
    near(to, 8_103.979_412_043, 1e-5);
    assert_eq!(found.critical_stiffness, Some(to));
    near(found.spectral_radius, 0.993_203_861_408_720_8, 1e-15);
}
