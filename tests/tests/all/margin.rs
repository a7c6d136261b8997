//! The margin is what the device may lose while everything else stays as it is: with a little less
//! taken away the scene passes the exact rule in exact numbers, with a little more it does not.

use haptic_servo::certificate::{Rule, assess};
use haptic_servo::environment::Wall;
use haptic_servo::scene::{Coupling, Device, Scene};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use tests::exact::q;
use tests::rules::Exact;
use tests::scenes;

/// Whether the exact rule passes for a device that has lost some of its passivity.
fn passes_without(exact: &Exact, loss: f64) -> bool {
    let mut weaker = exact.clone();
    weaker.delta -= q(loss);
    weaker.passes_exact()
}

#[test]
fn a_linear_scene_passes_up_to_its_margin_and_not_beyond() {
    let (mut certified, mut bounded, mut lacking) = (0, 0, 0);
    for seed in 0..600 {
        let drawn = scenes::any(&mut ChaCha8Rng::seed_from_u64(seed));
        let assessment = assess(&drawn.scene);
        let Some(margin) = assessment.margin(&drawn.scene) else { continue };
        assert_eq!(assessment.rule, Rule::Exact);
        let delta = assessment.delta.lo();
        if assessment.outcome.is_err() {
            lacking += 1;
            assert!(margin < 0.0, "{seed}: {margin}");
            assert!(!passes_without(&drawn.exact, 0.999 * margin), "{seed}: {margin} is too much");
            continue;
        }
        certified += 1;
        assert!(margin <= delta, "{seed}: {margin} of {delta}");
        assert!(passes_without(&drawn.exact, 0.999_999 * margin), "{seed}: {margin} of {delta}");
        let more = margin + 1e-6 * delta;
        if more < delta {
            bounded += 1;
            assert!(!passes_without(&drawn.exact, more), "{seed}: more than {margin} of {delta}");
        }
    }
    println!("certified={certified} bounded={bounded} lacking={lacking}");
    assert!(certified > 80 && bounded > 40 && lacking > 40);
}

fn wall(stiffness: f64, damping: f64, delay: usize, limit: Option<f64>) -> Scene {
    Scene {
        coupling: Coupling::Spring { stiffness: 44.0 },
        torque_limit: limit,
        ..Scene::of(
            Device::damped(2.2e-5, 0.022),
            0.001,
            Wall::damped(stiffness, damping, delay).alone(),
        )
    }
}

/// A controller `C` is worst near rest here: there it takes `T (C(1) / 2 - C'(1))` (theory, section 4.1).
/// Behind the coupling of 44 N m/rad `C` is `22 / (z + 1/2)` for a spring of 22 N m/rad that is one sample
/// late, and constant for an undelayed spring.
#[test]
fn the_margin_of_a_spring_is_what_its_controller_leaves_near_rest() {
    let late: f64 = 0.022 - 0.001 * (0.5 * 22.0 / 1.5 + 22.0 / (1.5 * 1.5));
    let stiff: f64 = 0.022 - 0.0005 * 1000.0 / (1.0 + 1000.0 / 44.0);
    for (stiffness, delay, expected) in [(22.0, 1, late), (1000.0, 0, stiff)] {
        let scene = wall(stiffness, 0.0, delay, None);
        let margin = assess(&scene).margin(&scene).unwrap();
        assert!(margin <= expected && margin > expected - 1e-9, "{margin} for {expected}");
        // A late spring that is limited has as much.
        let limited = wall(stiffness, 0.0, delay, Some(1.0));
        let margin = assess(&limited).margin(&limited).unwrap();
        assert!(margin <= expected && margin > 0.0, "{margin} for {expected}");
        assert!(delay == 0 || margin > expected - 1e-9, "{margin} for {expected}");
    }
}
