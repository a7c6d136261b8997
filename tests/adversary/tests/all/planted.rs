//! The search finds what wrong rules let pass.

use adversary::planted::Planted;

#[test]
fn the_search_finds_what_every_planted_rule_lets_pass() {
    let mut missed = Vec::new();
    for planted in Planted::ALL {
        let found = planted.search(600).run();
        let count = found.counterexamples.len();
        println!("{planted:?}: {found} counterexamples={count}");
        if let Some(first) = found.counterexamples.first() {
            println!("  scene {}, {}", first.number, first.drawn.kind);
        }
        if count == 0 {
            missed.push(planted);
        }
    }
    assert!(missed.is_empty(), "the search misses {missed:?}");
}
