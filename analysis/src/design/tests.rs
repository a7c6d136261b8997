use super::*;
use crate::file::{Format, parse, write};
use firmware::scene::{Device, Timing};

fn scene(environment: Environment) -> Scene {
    Scene {
        device: Device { inertia: 2.2e-5, damping: 0.022, passivity: None },
        timing: Timing { period: 0.001, worst_period: None },
        coupling: Coupling::Rigid,
        environment,
        torque_limit: None,
    }
}

fn wall(stiffness: f64, damping: f64, delay: usize) -> Environment {
    let one_sided = false;
    Environment::DamperWall(Wall { stiffness, damping, filter: None, delay, face: 0.0, one_sided })
}

fn limit<T>(answer: Answer<T>) -> (f64, T) {
    match answer {
        Answer::Limit(value, scene) => (value, scene),
        _ => panic!("no limit"),
    }
}

fn near(is: f64, should: f64) {
    assert!((is / should - 1.0).abs() < 1e-9, "{is} instead of {should}");
}

/// `K T / 2 + B < b` (theory, section 5).
#[test]
fn papers_wall_in_all_directions() {
    let paper = scene(wall(22.0, 0.01, 1));
    let terms = Terms::default();
    near(limit(largest(&paper, Quantity::Stiffness, &terms)).0, 24.0);
    near(limit(largest(&paper, Quantity::Damping, &terms)).0, 0.011);
    assert_eq!(limit(largest(&paper, Quantity::Delay, &terms)).0, 1.0);
    near(limit(device(&[paper, scene(wall(30.0, 0.0, 1))], &terms)).0, 0.021);
    near(limit(period(&[paper], &terms)).0, 0.012 / 11.0);
    let careful = Terms { safety: 0.95, ..terms };
    near(limit(largest(&paper, Quantity::Stiffness, &careful)).0, 21.8);
    near(limit(device(&[paper], &careful)).0, 0.021 / 0.95);
    let mut late = paper;
    late.timing.worst_period = Some(0.002);
    near(limit(largest(&late, Quantity::Stiffness, &terms)).0, 2.0);
}

#[test]
fn what_has_no_limit_and_what_has_no_such_number() {
    let terms = Terms::default();
    let undelayed = scene(wall(22.0, 0.01, 0));
    assert_eq!(largest(&undelayed, Quantity::Stiffness, &terms), Answer::Unlimited);
    let free = scene(Environment::FreeMode { residual: 0.01, delay: 0 });
    assert_eq!(largest(&free, Quantity::Stiffness, &terms), Answer::NoSuchNumber);
    near(limit(largest(&free, Quantity::Cancellation, &terms)).0, 0.022);
}

#[test]
fn answers_are_files_that_certify_and_nothing_more_would() {
    for delay in 1..4 {
        let (value, found) = limit(largest(
            &scene(wall(1.0, 0.002, delay)),
            Quantity::Stiffness,
            &Terms { safety: 0.9, ..Terms::default() },
        ));
        let text = write::toml("stiffest", &found);
        let read = parse("stiffest.toml", Format::Toml, &text).unwrap();
        assert!(passes(&read.scene), "{text}");
        let more = Quantity::Stiffness.set(&found, value.next_up()).unwrap();
        assert!(!passes(&more));
    }
}

#[test]
fn border_of_stiffness_and_damping() {
    let points = border(
        &scene(wall(22.0, 0.01, 1)),
        [Quantity::Stiffness, Quantity::Damping],
        5,
        &Terms::default(),
    );
    assert_eq!(points.len(), 5);
    for &(stiffness, damping) in &points[..4] {
        near(stiffness * 0.0005 + damping, 0.022);
    }
}
