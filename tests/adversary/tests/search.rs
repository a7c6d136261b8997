//! No certified scene gives energy away.

use std::time::Duration;

use adversary::scenes::{self, Choice};
use adversary::search::{Effort, Search};
use adversary::subject::{declared, margin};
use firmware::certificate::assess_in;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;

fn number(name: &str) -> Option<u64> {
    std::env::var(name).ok().map(|value| value.parse().unwrap_or_else(|e| panic!("{name}: {e}")))
}

#[test]
fn no_hand_takes_energy_out_of_a_certified_scene() {
    let scenes = number("ADVERSARY_SCENES");
    let search = Search {
        seed: number("ADVERSARY_SEED").unwrap_or(1),
        scenes: scenes.unwrap_or(u64::MAX),
        time: scenes.is_none().then_some(Duration::from_secs(30)),
        choice: Choice::ANY,
        output: None,
        enough: 20,
        effort: Effort::USUAL,
    };
    let found = search.run();
    println!("{found}");
    for counterexample in &found.counterexamples {
        println!("{counterexample}\n");
    }
    assert!(found.accepted * 4 > found.scenes, "too few of the scenes were accepted");
    assert!(
        found.counterexamples.is_empty(),
        "{} certified scenes give energy away",
        found.counterexamples.len()
    );
}

/// The margin of a scene against the least damping that the certificate itself asks for: all of the
/// scene as it runs, and a device that is declared to be less and less passive.
#[test]
fn no_scene_has_more_damping_to_spare_than_could_be_taken_from_it() {
    let (mut accepted, mut overstated) = (0_u32, Vec::new());
    for number in 0..4000 {
        let mut rng = ChaCha8Rng::seed_from_u64(1);
        rng.set_stream(number);
        let Some(drawn) = scenes::draw(&mut rng, &Choice::ANY) else { continue };
        let (scene, format) = (&drawn.scene, drawn.format.format());
        let Some(least) = scenes::least_damping(scene, format) else { continue };
        accepted += 1;
        let (stated, spare) = (margin(&assess_in(scene, format), scene), declared(scene) - least);
        // The least damping was found to a part in 10^7.
        if stated > spare + 1e-6 * declared(scene) {
            overstated.push(format!("{number}: {stated:.3e} stated, {spare:.3e} found: {scene:?}"));
        }
    }
    println!("accepted={accepted} overstated={}", overstated.len());
    assert!(accepted > 1000, "only {accepted} scenes were accepted");
    let first = overstated.first();
    assert!(overstated.is_empty(), "{} of {accepted}; {first:?}", overstated.len());
}
