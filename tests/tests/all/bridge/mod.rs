//! What a bridge renders, in closed loop.

mod back_emf;
mod rig;
mod servos;

use analysis::chain::{Chain, Link};
use analysis::design::{DesignLimit, Quantity, Terms, largest};
use analysis::worst_hand::{HandImpedance, search};
use haptic_servo::certificate::{Certified, QuantizationBound, Resolution};
use haptic_servo::current::{CurrentLoop, Drive, Motor, Supply, Winding};
use haptic_servo::encoder::CounterWidth;
use haptic_servo::environment::Wall;
use haptic_servo::number::Format;
use haptic_servo::output_timing::OutputTiming;
use haptic_servo::scene::{Coupling, Device, Latency, Scene, Timing};
use haptic_servo::servo::Transducers;

use rig::{Codes, Instant, Machine, Rig};

const PERIOD: f64 = 1e-4;

const DEVICE: Device = Device { inertia: 2.2e-5, damping: 0.022, passivity: None };

/// A motor whose short circuit damps the handle by 0.0004 N m s/rad: a fiftieth of what the device has.
const MACHINE: Machine = Machine {
    device: DEVICE,
    drive: Drive {
        motor: Motor {
            winding: Winding::Brushed,
            resistance: 1.0,
            inductance: 0.08e-3,
            torque_constant: 0.02,
        },
        supply: Supply::sinking(23.0, 25.2),
        bandwidth: 2000.0,
        largest_temperature: 80.0,
    },
    transducers: Transducers {
        counts_per_turn: 61_440.0,
        counter: CounterWidth::Bits16,
        full_scale_torque: 0.2,
        largest_speed: 25.0,
    },
    period: PERIOD,
};

fn latency(design: &CurrentLoop) -> Latency {
    design.latency(OutputTiming::Latched)
}

fn spring(stiffness: f64, coupling: Coupling, latency: Latency) -> Scene {
    Scene {
        device: DEVICE,
        timing: Timing { period: PERIOD, worst_period: None },
        coupling,
        environment: Wall::spring(stiffness, 1).alone(),
        latency,
        torque_limit: None,
    }
}

fn limit(coupling: Coupling, latency: Latency) -> f64 {
    limit_of(&spring(1.0, coupling, latency))
}

/// As `haptic design largest stiffness` finds it.
fn limit_of(scene: &Scene) -> f64 {
    match largest(scene, Quantity::Stiffness, &Terms::KEPT) {
        DesignLimit::Limit(limit, _) => limit,
        other => panic!("{other:?}"),
    }
}

/// The same scene with a device that is taken for more passive than it is.
fn claimed(scene: Scene) -> Certified<Scene> {
    let damping = 4.0 * DEVICE.damping;
    Scene { device: Device { damping, ..scene.device }, ..scene }.certify().unwrap()
}

fn hands() -> Vec<HandImpedance> {
    let own = HandImpedance::default();
    let mut hands = vec![own.clone()];
    for inertia in [5e-6, 2e-5, 2e-4, 2e-3] {
        hands.push(HandImpedance { inertia, ..own.clone() });
        let rate = 1000.0_f64;
        let link = Some(Link { stiffness: inertia * rate.powi(2), damping: 0.0 });
        hands.push(HandImpedance { inertia, link, ..own.clone() });
    }
    for stiffness in [10.0, 1000.0] {
        hands.push(HandImpedance { stiffness, ..own.clone() });
    }
    hands.push(HandImpedance { inertia: 1e-3, stiffness: 10.0, damping: 0.01, ..own });
    hands
}

/// Half of the way from the lowest torque to the highest.
fn swing(instants: &[Instant]) -> f64 {
    let torques = || instants.iter().map(|instant| instant.torque);
    0.5 * (torques().fold(f64::MIN, f64::max) - torques().fold(f64::MAX, f64::min))
}

fn off(instants: &[Instant]) -> f64 {
    instants.iter().map(|it| (it.torque - it.certified).abs()).fold(0.0, f64::max)
}

fn held_inertia(hand: &HandImpedance) -> f64 {
    DEVICE.inertia + if hand.link.is_none() { hand.inertia } else { 0.0 }
}

/// Time in s in which a push has to end, where it does, and after it the time of a look.
const SETTLES: f64 = 1.5;
const LOOK: f64 = 0.2;

/// How far the push goes in rad: eight counts.
const PUSH: f64 = 8e-4;

/// A push from rest: the first swings, and their remainder.
fn pushed(mut rig: Rig, stiffness: f64, hand: &HandImpedance) -> [Vec<Instant>; 2] {
    rig.run(LOOK).unwrap();
    rig.push(PUSH * (stiffness / held_inertia(hand)).sqrt());
    let first = rig.run(0.02).unwrap();
    let all = rig.run(SETTLES).unwrap();
    [first, [all, rig.run(LOOK).unwrap()].concat()]
}

fn last(instants: &[Instant]) -> &[Instant] {
    &instants[instants.len() - (LOOK / PERIOD) as usize * 4..]
}

/// What the torque of a bridge may be off, in N m: by counts, codes, numbers and compare values, without the
/// ripple that the rig does not have.
fn bound(machine: &Machine, scene: &Scene) -> QuantizationBound {
    let resolution = machine.current_loop().resolution();
    let steps = Resolution::of(&machine.transducers, None).with_current_loop(&resolution);
    let bound = QuantizationBound::of(scene, Format::F32, &steps).unwrap();
    let current = bound.current.map(|current| current - 0.5 * resolution.ripple);
    QuantizationBound { current, ..bound }
}

#[test]
fn the_limit_behind_a_bridge_is_that_of_its_lag_to_a_per_cent() {
    let updated = latency(&MACHINE.current_loop());
    assert_eq!(updated.actuator_updates, 4);
    let lag = Latency::delayed(PERIOD / 4.0).with_actuator_lag(updated.actuator_lag.middle());
    for (coupling, expected) in [(Coupling::Rigid, 85.85), (Coupling::Matched, 658.1)] {
        let [found, plain] = [updated, lag].map(|latency| limit(coupling, latency));
        println!("{coupling:?}: {found} N m/rad, of the lag {plain} N m/rad");
        assert!((found / plain - 1.0).abs() < 0.01, "{coupling:?}: {found} {plain}");
        assert!((found - expected).abs() < 0.05, "{coupling:?}: {found}");
    }
}

/// In every hand a scene is as it was certified, and comes to rest with the friction that the bound asks for; gives how
/// far the torque was off, as a part of the bound.
fn off_in_hands(scene: &Scene, stiffness: f64, codes: impl Fn(&Certified<Scene>) -> Codes) -> f64 {
    let (bound, certified) = (bound(&MACHINE, scene), scene.certify().unwrap());
    let mut largest = 0.0_f64;
    for hand in hands() {
        for friction in [0.0, bound.hum()] {
            let exact = servos::exact(&MACHINE, &certified);
            let mut rig = Rig::new(&MACHINE, &hand, codes(&certified), exact);
            rig.friction = friction;
            let [first, then] = pushed(rig, stiffness, &hand);
            largest = largest.max(off(&first)).max(off(&then));
            let (rest, resolution) = (swing(last(&then)), bound.current.unwrap());
            assert!(friction == 0.0 || rest <= resolution, "{hand:?}: {rest} of {resolution}");
        }
    }
    println!("{largest} N m off of {} N m", bound.hum());
    largest / bound.hum()
}

#[test]
fn a_spring_at_99_per_cent_of_the_limit_is_what_was_certified_and_comes_to_rest() {
    let latency = latency(&MACHINE.current_loop());
    let stiffness = 0.99 * limit(Coupling::Rigid, latency);
    let scene = spring(stiffness, Coupling::Rigid, latency);
    let off = off_in_hands(&scene, stiffness, |certified| servos::counted(&MACHINE, certified));
    assert!((0.5..1.0).contains(&off), "{off}");
}

#[test]
fn a_spring_5_per_cent_above_the_limit_grows_in_a_hand_in_which_a_certified_one_does_not() {
    let latency = latency(&MACHINE.current_loop());
    let limit = limit(Coupling::Rigid, latency);
    let above = spring(1.05 * limit, Coupling::Rigid, latency);
    let chain = Chain::rigid(DEVICE.inertia, DEVICE.damping).unwrap();
    let found = search(&above, &chain).unwrap();
    assert!(above.certify().is_err() && found.oscillates);
    let below = spring(0.99 * limit, Coupling::Rigid, latency).certify().unwrap();
    let grown = [claimed(above), below].map(|scene| {
        // Few counts of a swing are a spring of another stiffness.
        let codes = servos::rounded(&MACHINE, servos::exact(&MACHINE, &scene));
        let exact = servos::exact(&MACHINE, &scene);
        let rig = Rig::new(&MACHINE, &found.worst.hand, codes, exact);
        let [first, then] = pushed(rig, limit, &found.worst.hand);
        swing(last(&then)) / swing(&first)
    });
    println!("above {}, below {} times the first swings", grown[0], grown[1]);
    assert!(grown[0] > 2.0 && grown[1] < 0.5, "{grown:?}");
}

#[test]
fn a_boards_servo_behind_the_matched_coupling_is_what_was_certified_and_comes_to_rest() {
    let of = |stiffness: f64| Scene {
        torque_limit: Some(MACHINE.transducers.full_scale_torque),
        ..spring(stiffness, Coupling::Matched, latency(&MACHINE.current_loop()))
    };
    let scene = of(0.99 * limit_of(&of(1.0)));
    let off = off_in_hands(&scene, 140.0, |_| servos::board(&MACHINE, &scene));
    assert!(off < 1.0, "{off}");
}
