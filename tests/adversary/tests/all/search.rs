//! No certified scene gives energy away.

use adversary::normalized_scene::{declared, margin};
use adversary::scenes::{self, Choice};
use adversary::search::Search;
use haptic_servo::certificate::assess_in;
use haptic_servo::environment::Side;
use haptic_servo::scene::{Coupling, Scene};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use tests::number;

use super::{FEW, SCENES};

#[test]
fn no_hand_takes_energy_out_of_a_certified_scene() {
    search_all(number("ADVERSARY_SCENES").unwrap_or(FEW));
}

#[test]
#[ignore = "searches for minutes"]
fn no_hand_takes_energy_out_of_many_certified_scenes() {
    search_all(SCENES);
}

/// A number of scenes, not a time: the same ones on every machine.
fn search_all(scenes: u64) {
    let seed = number("ADVERSARY_SEED").unwrap_or(1);
    let found = Search { scenes, enough: 20, ..Search::of(seed) }.run();
    println!("{found}");
    for counterexample in &found.counterexamples {
        println!("{counterexample}\n");
    }
    for motion in &found.motions {
        println!("{motion:?}\n");
    }
    assert!(found.accepted * 4 > found.scenes, "too few of the scenes were accepted");
    assert_eq!(found.refuted(), 0, "certified scenes give energy away");
}

/// The scene without its limits: that it never reaches them is one of the motions that it can have.
fn linear(scene: &Scene) -> Scene {
    let mut linear = Scene { torque_limit: None, ..*scene };
    if let Some(wall) = linear.environment.wall_mut() {
        wall.side = Side::Displaced(wall.face());
    }
    linear
}

/// The margin of a scene on a board against the least damping that the certificate asks for of its
/// linear motions: all of the scene as it runs, and a device that is declared to be less and less
/// passive.
#[test]
fn no_scene_has_more_damping_to_spare_than_could_be_taken_from_it() {
    const SCENES: u64 = 600;
    let (mut accepted, mut stating, mut overstated) = (0_u32, 0_u32, Vec::new());
    for number in 0..SCENES {
        let mut rng = ChaCha8Rng::seed_from_u64(1);
        rng.set_stream(number);
        let Some(drawn) = scenes::draw(&mut rng, &Choice::ANY) else { continue };
        let (scene, format) = (&drawn.scene, drawn.format.format());
        // A profile is not linear, and the certificate's least damping is not the least there is; nor is it
        // without a coupling where times deviate or are ranges: the index at the port then needs less than the
        // conditions for linear scenes.
        let is_at_port = !scene.latency.is_none() && scene.coupling == Coupling::Rigid;
        if scene.environment.profile().is_some() || is_at_port {
            continue;
        }
        let Some(least) = scenes::least_damping(&linear(scene), format) else { continue };
        accepted += 1;
        let stated = margin(&assess_in(scene, format), scene, None);
        let spare = declared(scene) - least;
        stating += u32::from(stated > 0.0);
        // The least damping was found to a part in 10^7.
        if stated > spare + 1e-6 * declared(scene) {
            overstated.push(format!("{number}: {stated:.3e} stated, {spare:.3e} found: {scene:?}"));
        }
    }
    println!("accepted={accepted} stating={stating} overstated={}", overstated.len());
    let some = u64::from(accepted) > SCENES / 6 && u64::from(stating) > SCENES / 12;
    assert!(some, "only {stating} of {accepted} scenes state a margin");
    let first = overstated.first();
    assert!(overstated.is_empty(), "{} of {accepted}; {first:?}", overstated.len());
}
