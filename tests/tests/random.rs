//! Random environments of every kind against the exact reference: each enclosure holds the index,
//! no rule passes or fails where the reference says the contrary, and `undecided` is rare.
//!
//! A rounding in the wrong direction, a lost box of the subdivision, a sign in the cross terms of
//! the real part: each puts the index outside its enclosure for some of these scenes.

use firmware::certificate::assess;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use tests::agreement::check;
use tests::scenes::{self, Drawn, Poles};

/// Judges `count` scenes and returns how many the exact and the paper's rule left open.
fn judge(count: u64, draw: impl Fn(&mut ChaCha8Rng) -> Drawn) -> (u64, u64) {
    let (mut exact, mut paper, mut passed) = (0, 0, 0);
    for seed in 0..count {
        let drawn = draw(&mut ChaCha8Rng::seed_from_u64(seed));
        let assessment = assess(&drawn.scene);
        let open = check(&assessment, &drawn.exact)
            .unwrap_or_else(|why| panic!("seed {seed}: {why}\n{:?}\n{assessment:?}", drawn.scene));
        exact += u64::from(open.exact);
        paper += u64::from(open.paper);
        passed += u64::from(assessment.outcome.is_ok());
    }
    println!("scenes={count} certified={passed} undecided exact={exact} paper={paper}");
    assert!(passed * 10 > count, "only {passed} of {count} scenes were certified");
    (exact, paper)
}

fn rare(count: u64, open: (u64, u64)) {
    assert!(open.0 * 50 < count, "the exact rule left {} of {count} open", open.0);
    assert!(open.1 * 50 < count, "the paper's rule left {} of {count} open", open.1);
}

#[test]
fn poles_well_inside() {
    let poles = Poles { count: 8, nearest: 1e-2, delay: 8 };
    rare(600, judge(600, |rng| scenes::rational(rng, poles)));
}

#[test]
fn poles_ten_thousandths_from_the_circle() {
    let poles = Poles { count: 6, nearest: 1e-4, delay: 8 };
    rare(400, judge(400, |rng| scenes::rational(rng, poles)));
}

/// Here being undecided is no fault; being wrong is.
#[test]
fn poles_millionths_from_the_circle() {
    let poles = Poles { count: 8, nearest: 1e-6, delay: 8 };
    judge(300, |rng| scenes::rational(rng, poles));
}

#[test]
fn walls_and_springs() {
    rare(600, judge(600, scenes::wall));
}

#[test]
fn free_modes() {
    rare(600, judge(600, scenes::free));
}
