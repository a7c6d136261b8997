//! The search finds what wrong rules let pass.

use adversary::planted::Planted;
use adversary::scenes::Choice;
use adversary::search::{Effort, Search};

use super::SCENES;

/// The same scenes, hands and patterns as in the search for what the product lets pass.
#[test]
fn the_search_finds_what_every_planted_rule_lets_pass() {
    let mut missed = Vec::new();
    for planted in Planted::ALL {
        let search = Search {
            seed: 1,
            scenes: SCENES,
            time: None,
            choice: Choice { planted: Some(planted), ..Choice::ANY },
            enough: 1,
            effort: Effort::USUAL,
        };
        let found = search.run();
        println!("{planted:?}: {found} refuted={}", found.refuted());
        if let Some(first) = found.counterexamples.first() {
            println!("  scene {}, {}", first.number, first.drawn.kind);
        }
        if let Some(first) = found.motions.first() {
            println!("  scene {}, {}: {}", first.number, first.drawn.kind, first.energy);
        }
        if found.refuted() == 0 {
            missed.push(planted);
        }
    }
    assert!(missed.is_empty(), "the search misses {missed:?}");
}
