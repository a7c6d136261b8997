use super::*;
use crate::chain::{EncoderPlace, Mass};
use crate::fixture::on_paddle;
use haptic_servo::certificate::certify;
use haptic_servo::environment::Wall;
use haptic_servo::scene::{Coupling, Device, Latency, TimeRange};

fn device() -> Chain {
    Chain::rigid(2.2e-5, 0.022).unwrap()
}

fn scene(stiffness: f64, damping: f64, delay: usize, coupling: Coupling) -> Scene {
    on_paddle(Wall::damped(stiffness, damping, delay).alone(), coupling)
}

/// The largest number that a certificate passes, below `most`.
fn largest(most: f64, scene: impl Fn(f64) -> Scene) -> f64 {
    let (mut low, mut high) = (0.0, most);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if certify(&scene(middle)).is_ok() { low = middle } else { high = middle }
    }
    low
}

#[test]
fn what_is_rejected_oscillates_in_some_hand_and_what_is_certified_in_none() {
    for (stiffness, damping, delay, coupling) in [
        (22.0, 0.01, 0, Coupling::Rigid),
        (5.0, 0.0, 1, Coupling::Rigid),
        (22.0, 0.01, 1, Coupling::Spring { stiffness: 44.0 }),
        (40.0, 0.0, 2, Coupling::Spring { stiffness: 44.0 }),
        (4.0, 0.015, 2, Coupling::Spring { stiffness: 20.0 }),
    ] {
        let times = |factor: f64| scene(stiffness * factor, damping * factor, delay, coupling);
        let limit = largest(1e3, times);
        let near = |share: f64| times(limit * share);
        assert!(certify(&near(0.95)).is_ok() && certify(&near(1.05)).is_err());
        let certified = search(&near(0.95), &device()).unwrap();
        assert!(!certified.oscillates && certified.lighter.is_none(), "{certified:?}");
        let rejected = search(&near(1.05), &device()).unwrap();
        assert!(rejected.oscillates || rejected.lighter.is_some(), "{rejected:?}");
    }
}

/// Delayed springs with a delay of the output, an amplifier or a sensor that lag: next to the
/// certificate's limit.
#[test]
fn hands_find_the_limits_of_scenes_with_latency() {
    let range = TimeRange::exactly;
    for (latency, coupling) in [
        (Latency::delayed(4e-4), Coupling::Rigid),
        (Latency { actuator_lag: range(3e-4), ..Latency::NONE }, Coupling::Rigid),
        (
            Latency { sensor_lag: range(2e-4), ..Latency::delayed(1.3e-3) },
            Coupling::Spring { stiffness: 44.0 },
        ),
        (Latency::delayed(3e-4).with_actuator_lag(2e-4), Coupling::Spring { stiffness: 30.0 }),
        (Latency::sampled(3, 2e-4, 1e-3), Coupling::Rigid),
    ] {
        let with = |stiffness: f64| Scene { latency, ..scene(stiffness, 0.0, 1, coupling) };
        let low = largest(100.0, with);
        assert!(low > 1.0, "{low}");
        let certified = search(&with(0.97 * low), &device()).unwrap();
        assert!(!certified.oscillates && certified.lighter.is_none(), "{certified:?}");
        let rejected = search(&with(1.06 * low), &device()).unwrap();
        assert!(rejected.oscillates || rejected.lighter.is_some(), "{low} {rejected:?}");
    }
}

#[test]
fn no_hand_shakes_what_is_certified_behind_a_matched_coupling() {
    let latency = Latency::delayed(3e-4).with_actuator_lag(1e-4);
    let matched = Scene { latency, ..scene(500.0, 0.0, 0, Coupling::Matched) };
    assert!(certify(&matched).is_ok());
    let found = search(&matched, &device()).unwrap();
    assert!(!found.oscillates && found.lighter.is_none(), "{found:?}");
    // The spring of the same stiffness at rest does not absorb it.
    let stiffness = 2.0 * 0.022 / (1e-3 + 4e-4);
    let spring = Scene { coupling: Coupling::Spring { stiffness }, ..matched };
    assert!(certify(&spring).is_err());
}

/// The climb from a soft link must not end at a mass that nothing holds.
#[test]
fn a_mass_behind_nothing_is_no_hand() {
    let (inertia, damping) = (2.912708129978716e-5, 0.03430654821215887);
    let scene = Scene {
        coupling: Coupling::Spring { stiffness: 15.785823866956035 },
        ..Scene::of(
            Device::damped(inertia, damping),
            0.003042550575872087,
            Wall::damped(8.3155701205929, 0.009421656226762594, 1).alone(),
        )
    };
    assert!(certify(&scene).is_ok());
    let found = search(&scene, &Chain::rigid(inertia, damping).unwrap()).unwrap();
    assert!(!found.oscillates && found.lighter.is_none(), "{found:?}");
}

/// A simulation tick by tick must agree with the search.
#[test]
fn the_hand_that_was_found_makes_a_simulation_grow() {
    let scene = scene(30.0, 0.01, 1, Coupling::Spring { stiffness: 44.0 });
    let found = search(&scene, &device()).unwrap().worst;
    let plant = plant(&device(), 1.0, &found.hand);
    let start = crate::device::Motion { position: 0.0, velocity: 1e-3 };
    let experiment = Experiment { plant, start, samples: 3000, ..Experiment::still(&scene) };
    let motion = crate::simulation::simulate(&experiment, Integration::default()).unwrap();
    let most = |part: &[f64]| part.iter().fold(0.0_f64, |most, v| most.max(v.abs()));
    let grown = most(&motion.position[2000..]) / most(&motion.position[1000..2000]);
    assert!((grown.powf(1e-3) / found.spectral_radius - 1.0).abs() < 1e-3, "{grown}");
}

/// Theory, section 3.2: with the motor on one mass and the encoder on another no passivity is
/// left, and a spring that is certified on the rigid device oscillates.
#[test]
fn a_device_that_is_not_collocated_oscillates_under_a_certified_spring() {
    let scene = scene(20.0, 0.0, 1, Coupling::Spring { stiffness: 44.0 });
    assert!(certify(&scene).is_ok());
    let masses =
        vec![Mass { inertia: 1e-5, damping: 0.022 }, Mass { inertia: 1.2e-5, damping: 0.0 }];
    let link = Link { stiffness: 20.0, damping: 1e-4 };
    let chain = Chain::new(masses, vec![link]).unwrap();
    assert!(!search(&scene, &chain).unwrap().oscillates);
    let apart = chain.with_encoder(EncoderPlace::Hand);
    assert!(search(&scene, &apart).unwrap().oscillates);
}

/// Nothing holds the position of a pure damper: doubles move its eigenvalue 1 to 1 + 3.5e-9 in a heavy hand.
#[test]
fn a_position_that_nothing_holds_does_not_oscillate() {
    let device = Device { inertia: 0.05, damping: 0.5, passivity: None };
    for period in [1e-4, 5e-5] {
        let damper = Scene::of(device, period, Wall::damped(0.0, 0.1, 1).alone());
        assert!(certify(&damper).is_ok());
        let chain = Chain::rigid(device.inertia, device.damping).unwrap();
        let found = search(&damper, &chain).unwrap();
        assert!(!found.oscillates && found.lighter.is_none(), "{found:?}");
    }
}
