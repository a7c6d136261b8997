use firmware::certificate::Answer;

use super::border::closed_form_border;
use super::*;
use crate::file::{Format, parse};
use crate::stability;

fn file(environment: &str, coupling: &str) -> SceneFile {
    let text = format!(
        "name = \"a wall\"\n[device]\ninertia = 2.2e-5\ndamping = 0.022\n[servo]\nperiod = 0.001\n\
         {coupling}\n[environment]\n{environment}\n"
    );
    parse("wall.toml", Format::Toml, &text).unwrap()
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
                let closed = stability::closed_loop(&still, Stride::default()).unwrap();
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
fn certified_walls_are_stable_without_a_hand() {
    for (delay, coupling) in [(1, STANDARD), (2, SOFT), (2, ""), (4, STANDARD)] {
        let family = Family::of(&wall(delay, coupling)).unwrap();
        let (stiffness, damping) = family.usual_ranges();
        let map = Map::new(&family, stiffness, damping, 40, || {});
        for region in Region::ALL {
            let is_rare = region == Region::Exact && coupling == STANDARD;
            let is_void = region == Region::Paper && coupling.is_empty();
            assert!(map.share(region) > 0.0 || is_rare || is_void, "{delay} {region:?}");
        }
        let part = |range: &Range<f64>, index: usize| {
            range.start + (range.end - range.start) * (index as f64 + 0.5) / 40.0
        };
        for (column, row) in (0..40).flat_map(|column| (0..40).map(move |row| (column, row))) {
            let scene = family.member(part(&map.stiffness, column), part(&map.damping, row));
            let assessment = assess(&scene);
            let certified = [assessment.paper, assessment.exact].contains(&Answer::Pass);
            assert_eq!(map.at(column, row) >= Region::Exact, certified, "{scene:?}");
            assert!(!certified || family.plant.is_stable_under(&scene).unwrap(), "{scene:?}");
        }
    }
}

#[test]
fn the_closed_form_is_the_border_of_the_papers_rule() {
    for (delay, coupling) in [(1, STANDARD), (1, SOFT), (2, STANDARD), (3, SOFT)] {
        let family = Family::of(&wall(delay, coupling)).unwrap();
        let (stiffness, damping) = family.usual_ranges();
        let map = Map::new(&family, stiffness, damping, 2, || {});
        let border = closed_form_border(&family, &map);
        assert!(border.len() > 50, "{delay}");
        for (k, b) in border {
            assert_eq!(family.region(k * (1.0 - 1e-9), b), Region::Paper, "{delay} {k} {b}");
            assert_ne!(family.region(k * (1.0 + 1e-9), b), Region::Paper, "{delay} {k} {b}");
        }
    }
}

#[test]
fn an_environment_without_a_wall_has_no_map() {
    let free = file("type = \"free-mode\"\nresidual = 0.001", STANDARD);
    let error = Family::of(&free).unwrap_err().to_string();
    assert!(error.starts_with("a wall: a map is drawn over"), "{error}");
}
