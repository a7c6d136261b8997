use haptic_servo::scene::TimeRange;

use super::border::closed_form_border;
use super::plane::Plane;
use super::*;
use crate::fixture::file_on_paddle;
use crate::stability;

fn file(environment: &str, coupling: &str) -> SceneFile {
    file_on_paddle(&format!("{coupling}\n[environment]\n{environment}\n"))
}

fn wall(delay: usize, coupling: &str) -> SceneFile {
    let wall = format!("type = \"damper-wall\"\nstiffness = 1\ndamping = 0\ndelay = {delay}");
    file(&wall, coupling)
}

const STANDARD: &str = "[coupling]\nstiffness = 44.0";
const SOFT: &str = "[coupling]\nstiffness = 30.0";

#[test]
fn stability_is_that_of_the_eigenvalues() {
    let mut compared = 0;
    for (delay, coupling) in [(0, ""), (1, STANDARD), (2, SOFT), (3, STANDARD), (8, "")] {
        let file = wall(delay, coupling);
        let family = Family::of(&file).unwrap();
        for k in 1..12 {
            for b in -5..9 {
                let (k, b) = (7.3 * f64::from(k), 0.0047 * f64::from(b));
                let scene = family.member(k, b);
                let still = Experiment::still(&scene);
                let closed = stability::closed_loop(&still, Integration::default()).unwrap();
                let radius = stability::radius(&stability::eigenvalues(&closed.matrix).unwrap());
                if (radius - 1.0).abs() > 1e-6 {
                    compared += 1;
                    let stable = family.plant.is_stable_under(&scene).unwrap();
                    assert_eq!(stable, radius < 1.0, "{delay} {coupling} {k} {b} {radius}");
                }
            }
        }
    }
    assert!(compared > 700, "{compared}");
}

#[test]
fn an_environment_without_a_wall_has_no_map() {
    let free = file("type = \"free-mode\"\nresidual = 0.001", STANDARD);
    let error = Family::of(&free).unwrap_err().to_string();
    assert!(error.starts_with("a wall: a map shows stiffness and damping"), "{error}");
}

/// Couplings and walls of every kind, one-sided ones and such as may miss updates among them.
#[test]
fn nothing_that_the_dashed_border_encloses_is_rejected() {
    let stiff = "[coupling]\nstiffness = 70.0";
    let mut drawn = Vec::new();
    for coupling in ["", SOFT, STANDARD, stiff] {
        for (delay, one_sided, worst) in [
            (0, false, false),
            (1, false, false),
            (1, true, false),
            (1, false, true),
            (2, true, true),
        ] {
            let mut file = wall(delay, coupling);
            if one_sided && let Some(wall) = file.scene.environment.wall_mut() {
                *wall = wall.behind(0.0);
            }
            file.scene.timing.worst_period = worst.then_some(0.0015);
            let family = Family::of(&file).unwrap();
            let (stiffness, damping) = family.usual_ranges();
            let map = Map::new(&family, stiffness.clone(), damping, 2, || {});
            let Some(border) = closed_form_border(&family, &map) else { continue };
            for &(k, b) in &border.points {
                for part in [0.1, 0.5, 0.9, 1.0 - 1e-9] {
                    let region = family.region(k * part, b);
                    assert!(region >= Region::Exact, "{file:?} {k} {b} {part} {region:?}");
                }
                // A soft coupling has walls beyond the paper's border that the exact rule passes.
                let beyond = family.region(k * (1.0 + 1e-9), b);
                assert!(beyond < Region::Paper, "{file:?} {k} {b} {beyond:?}");
                assert!(coupling == SOFT || beyond < Region::Exact, "{file:?} {k} {b}");
            }
            drawn.push((coupling, border.name));
        }
    }
    // The paper's rule passes nothing behind these; the border of the rigid coupling is that of the exact
    // rule.
    assert!(drawn.iter().all(|(coupling, _)| *coupling != stiff), "{drawn:?}");
    assert!(drawn.iter().any(|(coupling, _)| coupling.is_empty()) && drawn.len() > 5, "{drawn:?}");
}

#[test]
fn a_wrong_verdict_and_none_at_all_are_told_from_no() {
    // A torque that is nearly a sample later than the certificate assumes.
    let latency = "type = \"damper-wall\"\nstiffness = 1\ndamping = 0\ndelay = 0\n[simulation]\nsamples = 1\n\
                   latency = 0.0009";
    let family = Family::of(&self::file(latency, STANDARD)).unwrap();
    let map = Map::new(&family, 1.0..200.0, 0.0..0.01, 20, || {});
    assert!(map.share(Region::Wrong) > 0.05, "{}", map.share(Region::Wrong));
    for (k, b, region) in map.cells() {
        let certified = assess(&family.member(k, b)).outcome.is_ok();
        assert_eq!(region == Region::Wrong || region >= Region::Exact, certified, "{k} {b}");
    }
    // A rejected wall is not taken for undecided.
    let rigid = Family::of(&wall(1, "")).unwrap();
    let (stiffness, damping) = rigid.usual_ranges();
    let map = Map::new(&rigid, stiffness, damping, 12, || {});
    for (k, b, region) in map.cells().filter(|cell| cell.2 == Region::Undecided) {
        let undecided = assess(&rigid.member(k, b)).outcome.is_err_and(|why| why.is_undecided());
        assert!(undecided, "{k} {b} {region:?}");
    }
    // On the border itself the certificate is undecided.
    let family = Family::of(&wall(1, STANDARD)).unwrap();
    for (stiffness, undecided) in [(43.0, false), (44.0, true), (45.0, false)] {
        let outcome = assess(&family.member(stiffness, 0.0)).outcome;
        assert_eq!(outcome.is_err_and(|why| why.is_undecided()), undecided, "{stiffness}");
        assert_eq!(family.region(stiffness, 0.0) == Region::Undecided, undecided, "{stiffness}");
    }
}

/// Delays and lags of every kind: known, in ranges, by their ends, and of updates.
fn latencies() -> [Latency; 5] {
    let ranges = Latency {
        output_delay: TimeRange::between(1e-5, 6e-5),
        sensor_lag: TimeRange::exactly(2e-5),
        ..Latency::NONE.with_actuator_lag(5e-5)
    };
    [
        Latency::delayed(3e-4).with_actuator_lag(2e-4),
        ranges,
        Latency { output_delay: TimeRange::between(8e-4, 1.2e-3), ..ranges },
        Latency::delayed(1e-4).with_actuator_response(1e-4, 9e-4),
        Latency::sampled(4, 1e-4, 1e-3),
    ]
}

#[test]
fn what_walls_have_in_common_changes_no_verdict() {
    let mut kinds = std::collections::BTreeSet::new();
    let mut before = None;
    for latency in latencies() {
        let mut file = wall(1, SOFT);
        file.scene.latency = latency;
        let family = Family::of(&file).unwrap();
        assert!(family.kept.is_some(), "{latency:?}");
        // Behind a rigid coupling the formula is that of prompt torques.
        let mut rigid = wall(1, "");
        rigid.scene.latency = latency;
        let rigid = Family::of(&rigid).unwrap();
        let map = Map::new(&rigid, 0.0..40.0, -0.01..0.02, 2, || {});
        assert!(closed_form_border(&rigid, &map).is_none(), "{latency:?}");
        let alone = Family { kept: None, ..family.clone() };
        // The responses of another family have no effect.
        let foreign = Family { kept: before, ..family.clone() };
        for (k, b) in (1..9).flat_map(|k| (-2..6).map(move |b| (k, b))) {
            let (k, b) = (5.0 * f64::from(k), 0.004 * f64::from(b));
            let region = alone.region(k, b);
            assert_eq!(family.region(k, b), region, "{latency:?} {k} {b}");
            assert_eq!(foreign.region(k, b), region, "{latency:?} {k} {b}");
            let scene = family.member(k, b);
            let is_stable = |scene: &Scene| family.plant.is_stable_under(scene).unwrap();
            assert_eq!(is_stable(&family.prompt(scene)), is_stable(&scene), "{latency:?} {k} {b}");
            let certified = assess(&family.member(k, b)).outcome.is_ok();
            assert_eq!(region >= Region::Exact, certified, "{latency:?} {k} {b}");
            kinds.insert(region);
        }
        before = family.kept;
    }
    assert!(kinds.len() >= 3, "{kinds:?}");
}

/// The device is computed once for a row, and for each member of the turned map.
#[test]
fn a_map_that_is_turned_shows_the_same() {
    for (own, other) in [
        (Parameter::Stiffness, Parameter::Period),
        (Parameter::Damping, Parameter::OutputDelay),
        (Parameter::Stiffness, Parameter::CouplingStiffness),
    ] {
        let stiff = "type = \"damper-wall\"\nstiffness = 22\ndamping = 0.005\ndelay = 1";
        let mut file = self::file(stiff, SOFT);
        file.scene.latency = Latency::delayed(2e-4).with_actuator_lag(1e-4);
        let [plane, turned] =
            [[own, other], [other, own]].map(|axes| Plane::of(&file, axes).unwrap());
        let [across, up] = plane.usual_ranges();
        let mut kinds = std::collections::BTreeSet::new();
        for row in 0..12 {
            let y = middle(&up, row, 12);
            let members = plane.row(y);
            for column in 0..12 {
                let x = middle(&across, column, 12);
                let region = members.region(x);
                assert_eq!(turned.row(x).region(y), region, "{own:?} {other:?} {x} {y}");
                kinds.insert(region);
            }
        }
        let differ = kinds.contains(&Region::Unstable) && kinds.contains(&Region::Exact);
        assert!(differ, "{own:?} {other:?} {kinds:?}");
    }
}
