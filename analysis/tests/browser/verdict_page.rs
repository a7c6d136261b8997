//! The page shows the output of `haptic certify` for a scene, letter for letter: for its presets, and for
//! scenes with longer and shorter answers.

use std::path::Path;
use std::time::{Duration, Instant};

use serde_json::{Value, json};

use crate::common::{WALL, haptic};
use crate::devtools::Page;
use crate::explore::opened;

/// The simulation of the wall, for a report that shows it.
const MOTION: &str = r#"
[simulation]
samples = 300
torque_sine = { amplitude = 1.5, omega = 60.0, phase = 0.0 }
[human]
inertia = 1e-4
damping = 0.02
stiffness = 4.0
[limits]
torque = 0.5
"#;

/// Columns of a label that `haptic certify` prints.
const LABEL: usize = 18;

/// Longest that the search for remedies may take behind a change, on a slow machine.
const PATIENCE: Duration = Duration::from_secs(30);

/// The preset that is there to be refused; all others are certified.
pub const REFUSED: &str = "beyond the limit";

/// Names of the presets.
pub fn presets(page: &mut Page) -> Vec<String> {
    let names = page.value(
        "[...document.querySelectorAll('#preset option')].slice(1).map((one) => one.textContent)",
    );
    let names: Vec<String> = serde_json::from_value(names).unwrap();
    assert!(names.len() >= 6, "{names:?}");
    names
}

/// Chooses a preset as a person does, and waits until it is judged.
pub fn choose(page: &mut Page, name: &str) {
    page.value(&format!(
        "(() => {{ const list = document.getElementById('preset'); \
         list.value = [...list.options].find((one) => one.textContent === {name:?}).value; \
         list.dispatchEvent(new Event('change')); }})()"
    ));
    wait_until_judged(page, name);
}

/// Pastes the text of a scene file.
fn paste(page: &mut Page, name: &str, toml: &str) {
    let toml = json!(toml);
    page.value(&format!(
        "(() => {{ const clipboardData = new DataTransfer(); clipboardData.setData('text/plain', {toml}); \
         document.body.dispatchEvent(new ClipboardEvent('paste', {{ clipboardData, bubbles: true }})); }})()"
    ));
    wait_until_judged(page, name);
}

/// Waits until the rows are of the scene of that name.
fn wait_until_judged(page: &mut Page, name: &str) {
    page.wait_for(&format!("document.querySelector('#verdict-rows dd')?.textContent === {name:?}"));
    page.wait_for("document.documentElement.dataset.verdict !== undefined");
}

/// Writes the scene that the page shows.
pub fn write_scene(page: &mut Page, folder: &Path) -> String {
    let file = folder.join("shown.json");
    std::fs::write(&file, page.value("window.haptic.scene()").as_str().unwrap()).unwrap();
    file.to_str().unwrap().to_owned()
}

/// The output of `haptic certify --json` for a scene file.
pub fn certified(file: &str) -> String {
    let run = haptic(&["certify", file, "--json"]);
    assert!(run.stderr.is_empty(), "{run:?}");
    String::from_utf8(run.stdout).unwrap().trim_end().to_owned()
}

/// The same of the scene that the page shows, by the page's program.
pub fn certified_by_page(page: &mut Page) -> String {
    let text = page.value("String(window.haptic.certify(window.haptic.scene()))");
    text.as_str().unwrap().to_owned()
}

/// Label and value of each row that the page shows.
fn shown(page: &mut Page) -> Vec<[String; 2]> {
    let rows = page.value(
        "(() => { const all = [...document.getElementById('verdict-rows').children]; \
         return all.filter((one) => one.tagName === 'DT').map((term) => \
         [term.textContent, term.nextElementSibling.textContent]); })()",
    );
    serde_json::from_value(rows).unwrap()
}

/// Label and value of each row that `haptic certify -v` prints.
fn printed(file: &str) -> Vec<[String; 2]> {
    let text = String::from_utf8(haptic(&["certify", "-v", file]).stdout).unwrap();
    let row = |line: &str| {
        let (label, value) = line.split_at(LABEL);
        [label.trim_end(), value.strip_prefix(' ').unwrap()].map(ToOwned::to_owned)
    };
    text.lines().map(row).collect()
}

/// Compares the rows, which have their remedies a moment after the verdict.
fn compare(page: &mut Page, folder: &Path) -> Vec<[String; 2]> {
    let printed = printed(&write_scene(page, folder));
    let start = Instant::now();
    while shown(page) != printed && start.elapsed() < PATIENCE {
        std::thread::sleep(Duration::from_millis(50));
    }
    assert_eq!(shown(page), printed);
    printed
}

/// The values of a label, with the rows that go on with it.
fn values<'r>(rows: &'r [[String; 2]], label: &str) -> Vec<&'r str> {
    let begins = rows.iter().skip_while(|[found, _]| found != label);
    let goes_on = |(index, row): &(usize, &[String; 2])| *index == 0 || row[0].is_empty();
    begins.enumerate().take_while(goes_on).map(|(_, [_, value])| value.as_str()).collect()
}

pub fn the_rows_of_the_page_are_those_of_the_program() {
    let (folder, mut page) = opened(1280, WALL);
    let wall = |changes: &[(&str, &str)]| {
        changes.iter().fold(WALL.to_owned(), |wall, (from, to)| {
            assert!(wall.contains(from), "{from}");
            wall.replace(from, to)
        })
    };
    let lag = ("damping = 0.022", "damping = 0.022\nactuator_lag = 1e-4");
    let stiff = ("stiffness = 22.0", "stiffness = 60.0");
    let jitter = ("period = 0.001", "period = 0.001\noutput_delay = [0.0, 2e-4]");
    let no_coupling = ("[coupling]\nstiffness = 44.0\n", "");
    let (start, _) = WALL.split_once("type").unwrap();
    let detents = format!(
        "{start}type = \"profile\"\ndelay = 1\n[[environment.shape]]\ntype = \"detents\"\ncount = 24\n\
         torque = 0.05\n"
    );
    // Updates that are missed beside two lags.
    let sensor = ("damping = 0.022", "damping = 0.022\nsensor_lag = 2e-4");
    let missed = ("period = 0.001", "period = 0.001\nworst_period = 0.002");
    let undecided = [lag, sensor, missed, no_coupling]
        .iter()
        .fold(detents, |text, (from, to)| text.replace(from, to));
    let scenes = [
        ("certified", format!("{WALL}{MOTION}")),
        ("certified", wall(&[("damping = 0.022", "damping = 0.022\nactuator_lag = 1e-5")])),
        ("rejected", wall(&[stiff])),
        ("rejected", wall(&[stiff, lag])),
        ("rejected", wall(&[jitter, ("44.0", "30.0"), ("22.0", "15.0"), ("0.01", "0.008")])),
        ("undecided", wall(&[jitter])),
        ("undecided", undecided),
    ];
    for (number, (verdict, scene)) in scenes.into_iter().enumerate() {
        let name = format!("{verdict} {number}");
        paste(&mut page, &name, &scene.replace("delayed wall", &name));
        let rows = compare(&mut page, folder.path());
        assert_eq!(values(&rows, "verdict")[0], verdict.to_uppercase(), "{rows:?}");
        assert!(!values(&rows, "assumes").is_empty(), "{rows:?}");
        let [remedies, margin] = ["remedies", "margin"].map(|label| values(&rows, label).len());
        assert!(verdict != "rejected" || remedies > 0, "{rows:?}");
        assert!(verdict != "certified" || (remedies, margin) == (0, 1), "{rows:?}");
        // Remedies are buttons, which show no more than the rows.
        let buttons = page.value("document.querySelectorAll('#verdict-rows button').length");
        assert_eq!(buttons == json!(0), remedies == 0, "{rows:?}");
    }
    page.assert_silent();
}

pub fn each_preset_is_certified_where_it_should_be() {
    let (folder, mut page) = opened(1280, WALL);
    for name in presets(&mut page) {
        choose(&mut page, &name);
        let expected = if name == REFUSED { "rejected" } else { "certified" };
        assert_eq!(page.value("document.documentElement.dataset.verdict"), expected, "{name}");
        // Other values are shown neither as a word nor as a number.
        let strange = "/\\[object|undefined|NaN/.exec(document.querySelector('main').textContent)";
        assert_eq!(page.value(strange), Value::Null, "{name}");
        let printed = certified(&write_scene(&mut page, folder.path()));
        assert_eq!(certified_by_page(&mut page), printed, "{name}");
        let printed: Value = serde_json::from_str(&printed).unwrap();
        assert_eq!([&printed["verdict"], &printed["name"]], [&json!(expected), &json!(name)]);
        compare(&mut page, folder.path());
    }
    page.assert_silent();
}
