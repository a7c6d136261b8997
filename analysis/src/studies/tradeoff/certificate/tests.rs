use super::*;

/// Ways that need a grid of tens of thousands of points are left out: they take long, and are the
/// same code.
fn is_quick(method: &IndexMethod) -> bool {
    !matches!(method, IndexMethod::Grid(grid) if grid.count() > 1000)
}

/// All that does not depend on the machine is in the kept table as it is found today. What ordinary
/// arithmetic finds depends on the last places of sines and square roots.
#[test]
fn the_kept_errors_and_verdicts_are_those_that_are_found() {
    let kept = Tradeoff::kept(&COMPARISON).unwrap();
    let mut compared = 0;
    for kind in Kind::ALL {
        for candidate in candidates().iter().filter(|candidate| is_quick(&candidate.method)) {
            let is_it = |row: &&Method| row.case == kind.as_str() && row.name == candidate.name;
            let Some(was) = kept.methods.iter().find(is_it) else {
                assert!(
                    evaluated(&candidate.method, kind, 0).is_none(),
                    "{kind:?} {}",
                    candidate.name
                );
                continue;
            };
            let found =
                MethodErrors::of(&candidate.method, kind, 0..EACH).row(kind, candidate, 1.0);
            let proves = !matches!(candidate.method, IndexMethod::Grid(_) | IndexMethod::Roots);
            for (column, (is, was)) in found.values.iter().zip(&was.values).enumerate().skip(1) {
                let (Some(is), Some(was)) = (is, was) else {
                    assert_eq!(is, was);
                    continue;
                };
                let is_count = (2..=4).contains(&column);
                let slack = match (proves, is_count) {
                    (true, true) => 0.0,
                    (false, true) => 5.0 + 0.02 * was,
                    (_, false) => 0.05 * was + 1e-15,
                };
                let same = is == was || (is - was).abs() <= slack;
                assert!(same, "{kind:?} {}, column {column}: {is} was {was}", candidate.name);
            }
            compared += 1;
        }
    }
    assert!(compared > 40, "{compared}");
}

/// No enclosure of any width has a false positive or a false negative, and the certificate's own
/// leaves almost none undecided away from the border. Grids and roots have false positives.
#[test]
fn a_proof_is_never_wrong_and_grids_and_roots_are() {
    let count = |row: &Method, column: usize| row.values[column].unwrap();
    for row in &Tradeoff::kept(&COMPARISON).unwrap().methods {
        let [wrong_yes, wrong_no, open] = [2, 3, 4].map(|column| count(row, column));
        let is_far = row.case != Kind::Border.as_str();
        match (&*row.family, &*row.name) {
            ("closed form", _) => assert_eq!(wrong_yes + wrong_no + open, 0.0, "{row:?}"),
            ("enclosure", name) => {
                assert_eq!(wrong_yes + wrong_no, 0.0, "{row:?}");
                let is_own = name.ends_with("1e-13");
                assert!(!is_own || !is_far || open < 0.005 * EACH as f64, "{row:?}");
            }
            ("decision", _) => {
                assert_eq!(wrong_yes + open, 0.0, "{row:?}");
                assert!(!is_far || wrong_no < 0.005 * EACH as f64, "{row:?}");
            }
            _ if row.case == Kind::Narrow.as_str() => assert!(wrong_yes > 0.0, "{row:?}"),
            _ => {}
        }
    }
}
