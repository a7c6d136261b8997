use super::*;

fn integration(method: Method, substeps: u32) -> Integration {
    Integration { method, substeps }
}

/// The timed steps equal the program's own simulation.
#[test]
fn steps_on_the_stack_are_the_programs_own() {
    for case in cases() {
        for integration in strides().into_iter().filter(|integration| integration.substeps <= 5) {
            let Ok(found) = simulate(&case.experiment, integration) else { continue };
            let angles = runner(&case, integration)(SAMPLES);
            // Where the motion grows so does what rounding made of it.
            for (is, should) in angles.iter().zip(&found.position) {
                assert!((is - should).abs() <= 1e-9 * should.abs().max(1e-3), "{integration:?}");
            }
        }
    }
}

/// Theory, section 9: `b / (T/2 + h/2)` and `b / (T/2 - h/2)` for one mass, and what the others make
/// of two.
#[test]
fn apparent_limits_are_those_of_theory() {
    let [rigid, chain] = cases();
    let limit = |case: &Case, method, substeps| {
        critical_stiffness(&case.experiment, integration(method, substeps)).unwrap()
    };
    for substeps in SUBSTEPS {
        let (b, t) = (0.5, 1e-3);
        let h = t / f64::from(substeps);
        let euler = limit(&rigid, Method::Euler, substeps).unwrap();
        assert!((euler * 0.5 * (t + h) / b - 1.0).abs() < 0.003, "{substeps} {euler}");
        // At one step the formula has no limit, and the method a very large one.
        let semi = limit(&rigid, Method::SemiImplicit, substeps).unwrap();
        let formula = b / (0.5 * (t - h)).max(1e-9);
        assert!(semi > 1e5 || (semi / formula - 1.0).abs() < 0.003, "{substeps} {semi}");
    }
    let truth = limit(&chain, Method::Exact, 1).unwrap();
    let part = |method| limit(&chain, method, 1).map(|found| found / truth - 1.0);
    assert!((0.12..0.16).contains(&part(Method::Rk4).unwrap()));
    assert!((-0.06..-0.04).contains(&part(Method::Tustin).unwrap()));
    assert_eq!(part(Method::Euler), None);
}

#[test]
fn the_exact_exponential_is_on_every_front() {
    let kept = Tradeoff::kept(&COMPARISON).unwrap();
    for case in kept.cases() {
        for error in 0..COMPARISON.errors.len() {
            assert!(kept.front(case, error).iter().any(|method| method.name == "exact"));
        }
    }
}

/// All that does not depend on the machine is in the kept table as it is found today.
#[test]
fn the_kept_errors_are_those_that_are_found() {
    let kept = Tradeoff::kept(&COMPARISON).unwrap();
    let mut kept = kept.methods.iter();
    for case in cases() {
        let truth = Truth::of(&case).unwrap();
        for integration in strides() {
            let (found, kept) = (truth.row(&case, integration, 1.0).unwrap(), kept.next().unwrap());
            let words = |row: &Row| [row.case.clone(), row.family.clone(), row.name.clone()];
            assert_eq!(words(kept), words(&found));
            for (error, axis) in COMPARISON.errors.iter().enumerate() {
                let [is, was] = [&found, kept].map(|row| row.error(error).unwrap());
                let same = is == was || (is - was).abs() <= 0.01 * was + axis.floor;
                assert!(same, "{} {}: {is} was {was}", found.case, found.name);
            }
            assert_eq!(found.values[3], kept.values[3]);
        }
    }
    assert_eq!(kept.next(), None);
}
