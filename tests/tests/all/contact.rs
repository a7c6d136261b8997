//! One-sided and limited walls, accepted by the nonlinear bound, in closed loop with a hand.
//!
//! Equation 28: with `beta` the energy of device and hand at the start, every torque obeys
//! `F^2 <= 4 delta beta / T`, and the environment's motion is square-summable:
//! `(K_vc T / 2 - alpha) * sum v_E^2 <= beta / T`. A lasting oscillation breaks the second, a growing
//! oscillation breaks both.

use haptic_servo::certificate::{RuleAnswer, assess};
use haptic_servo::environment::Wall;
use haptic_servo::scene::{Coupling, Device, Latency, Scene, Timing};
use nalgebra::DVector;
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use tests::contact::Contact;
use tests::hands::Hand;
use tests::plant::Plant;
use tests::scenes::log_uniform;

const SAMPLES: usize = 2_000;

/// A wall drawn near the line; the loop's units are those of a device with damping 1 and period 1.
fn draw(rng: &mut ChaCha8Rng, size: f64) -> Contact {
    let delay = rng.random_range(0..=3);
    let coupling = 2.0 * log_uniform(rng, 0.1, 1.0);
    let reach = size * 0.5 * coupling / [0.5, 0.5, 1.5, 2.5][delay];
    let share = rng.random_range(0.0..1.0);
    Contact {
        stiffness: reach * share,
        damping: size * 0.5 * coupling * (1.0 - share),
        delay,
        coupling,
        limit: if rng.random_bool(0.5) { f64::INFINITY } else { log_uniform(rng, 1e-2, 1.0) },
    }
}

fn scene(contact: &Contact) -> Scene {
    Scene {
        device: Device { inertia: 1.0, damping: 1.0, passivity: None },
        timing: Timing { period: 1.0, worst_period: None },
        coupling: Coupling::Spring { stiffness: contact.coupling },
        environment: Wall::damped(contact.stiffness, contact.damping, contact.delay)
            .behind(0.0)
            .alone(),
        latency: Latency::NONE,
        torque_limit: contact.limit.is_finite().then_some(contact.limit),
    }
}

/// The bound on `alpha` of theory section 5, here written out once more.
fn bound(contact: &Contact) -> f64 {
    match contact.delay {
        0 => 0.0,
        n => contact.stiffness * (n as f64 - 0.5) + contact.damping,
    }
}

/// Outside the wall and moving, hand included; the energy is all that there is.
fn start(rng: &mut ChaCha8Rng, plant: &Plant) -> DVector<f64> {
    let mut state = DVector::from_fn(plant.a.nrows(), |_, _| rng.random_range(-1.0..1.0));
    state[0] = -log_uniform(rng, 1e-3, 1.0);
    state
}

/// Largest ratio of what happened to what the theory allows.
fn worst(rng: &mut ChaCha8Rng, contact: &Contact) -> f64 {
    let hand = if rng.random_bool(0.5) {
        Hand::draw(rng)
    } else {
        let theta = rng.random_range(0.1..3.1);
        Hand::tuned(rng, theta)
    };
    let plant = Plant::new(&hand);
    let outcome = contact.run(&plant, &start(rng, &plant), SAMPLES);
    let spare = 0.5 * contact.coupling - bound(contact);
    (outcome.peak / (4.0 * outcome.energy)).max(spare * outcome.motion / outcome.energy)
}

#[test]
fn accepted_contacts_stay_within_the_energy_they_started_with() {
    let mut rng = ChaCha8Rng::seed_from_u64(5);
    let (mut accepted, mut largest) = (0, 0.0_f64);
    for _ in 0..2_000 {
        let contact = draw(&mut rng, 1.05);
        if assess(&scene(&contact)).outcome.is_err() {
            continue;
        }
        accepted += 1;
        let ratio = worst(&mut rng, &contact);
        assert!(ratio <= 1.0 + 1e-9, "{ratio} for {contact:?}");
        largest = largest.max(ratio);
    }
    println!("accepted contacts={accepted} largest ratio={largest:.4}");
    assert!(accepted > 500, "only {accepted} contacts were accepted");
    assert!(largest > 0.5, "the runs never came near the bound: {largest}");
}

#[test]
fn contacts_past_the_bound_break_it_and_are_refused() {
    let mut rng = ChaCha8Rng::seed_from_u64(6);
    let mut broken = 0;
    for _ in 0..2_000 {
        let contact = draw(&mut rng, 6.0);
        if contact.delay == 0 || bound(&contact) < 0.5 * contact.coupling {
            continue;
        }
        let assessment = assess(&scene(&contact));
        assert!(assessment.outcome.is_err(), "{contact:?} was accepted");
        assert_ne!(assessment.paper, RuleAnswer::Pass);
        let outcome = worst(&mut rng, &contact);
        broken += u32::from(outcome > 1.0 || outcome.is_nan());
    }
    println!("refused contacts that broke the bound: {broken}");
    assert!(broken > 50, "too few refused contacts misbehaved: {broken}");
}
