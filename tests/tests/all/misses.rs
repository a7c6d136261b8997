//! What a worst period costs, against the rules in exact numbers.
//!
//! Where each torque belongs to the instant of its count, a longest period of `k T` leaves
//! `delta / k` and changes nothing else (theory, section 8). Where torques are latched a period after
//! their counts, the coupling absorbs the tick of the nominal period: an index behind the standard
//! coupling of the declared `delta` has to be below `delta / k`, and behind a spring of
//! `c = K_vc T / 2` below `1 / ((k - 1) / delta + 1 / c)`. A scene has to pass both.

use haptic_servo::certificate::{RuleAnswer, assess};
use num_traits::One;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use std::cmp::Ordering;
use tests::exact::{Q, q};
use tests::rules::Exact;
use tests::scenes;

struct Judged {
    passes_paper: bool,
    passes_exact: bool,
}

/// Both rules for a scene that is latched, in exact numbers.
fn latched(exact: &Exact, factor: &Q) -> Judged {
    let slow = &exact.delta / factor;
    let index = exact.alpha_coupled();
    let limit = exact.coupling.as_ref().map(|stiffness| {
        let damping = stiffness * &exact.period / Q::from_integer(2.into());
        let inverse = (factor - Q::one()) / &exact.delta + Q::one() / damping;
        Q::one() / inverse
    });
    let below = |index: &tests::index::Index, limit: &Q| index.compare(limit) == Ordering::Less;
    Judged {
        passes_paper: limit.is_some_and(|l| exact.alpha().is_ok_and(|alpha| below(&alpha, &l))),
        passes_exact: index.is_ok_and(|alpha| below(&alpha, &slow)),
    }
}

fn agrees(rule: &str, seed: u64, answer: RuleAnswer, truth: bool) {
    let wrong = if truth { RuleAnswer::Fail } else { RuleAnswer::Pass };
    assert_ne!(answer, wrong, "{seed}: {rule}");
}

#[test]
fn a_worst_period_holds_where_torques_are_latched_and_where_they_are_not() {
    let (mut late, mut only_at_once) = (0, 0);
    for seed in 0..700 {
        let drawn = scenes::any(&mut ChaCha8Rng::seed_from_u64(seed));
        let factor = [1.0, 1.5, 2.0, 4.0][usize::try_from(seed % 4).unwrap()];
        let mut slow = drawn.scene;
        slow.timing.worst_period = Some(factor * slow.timing.period);
        let assessment = assess(&slow);
        let factor = q(factor);
        let mut at_once = drawn.exact.clone();
        at_once.delta /= &factor;
        if factor.is_one() || !slow.environment.is_late() {
            tests::agreement::check(&assessment, &at_once)
                .unwrap_or_else(|why| panic!("{seed}: {why}"));
            continue;
        }
        late += 1;
        let latched = latched(&drawn.exact, &factor);
        let paper = at_once.passes_paper() && latched.passes_paper;
        let exact = at_once.passes_exact() && latched.passes_exact;
        agrees("paper", seed, assessment.paper, paper);
        agrees("exact", seed, assessment.exact, exact);
        only_at_once += usize::from(at_once.passes_exact() && !latched.passes_exact);
    }
    println!("late={late} only at once={only_at_once}");
    assert!(late > 50 && only_at_once > 1, "{late} {only_at_once}");
}
