//! No certified scene gives energy away.

use std::time::Duration;

use adversary::scenes::Choice;
use adversary::search::{Effort, Search};

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
