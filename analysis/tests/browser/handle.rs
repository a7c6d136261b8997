//! The handle of the page in a browser: its codes are those of `haptic run`, to the bit.

use serde_json::Value;

use crate::common::{WALL, haptic};
use crate::devtools::Page;
use crate::explore::{explore, opened};

const DRAWING: &str = "#handle-drawing";

fn numbers(list: &Value) -> Vec<i64> {
    list.as_array().unwrap().iter().map(|number| number.as_f64().unwrap() as i64).collect()
}

/// Drags the handle to the right by this many pixels, and keeps it there.
fn drag(page: &mut Page, pixels: f64) {
    let [x, y] = page.middle(DRAWING);
    page.mouse("mouseMoved", [x, y]);
    page.mouse("mousePressed", [x, y]);
    for step in 1..=10 {
        page.mouse("mouseMoved", [x + pixels * f64::from(step) / 10.0, y]);
    }
}

pub fn the_handle_of_the_page_runs_the_servo_of_the_program() {
    let (folder, mut page) = opened(1280, WALL);
    drag(&mut page, 120.0);
    page.wait_for("Math.min(...window.haptic.dragged().codes) < 2000");
    let [x, y] = page.middle(DRAWING);
    page.mouse("mouseReleased", [x, y]);
    page.wait_for("document.getElementById('handle-hold').textContent === 'Hold'");
    for key in ["ArrowRight", "ArrowRight", "ArrowLeft"] {
        page.value("document.getElementById('handle-drawing').focus()");
        page.key(key);
    }
    page.wait_for("document.getElementById('handle-hold').textContent === 'Let go'");

    let dragged = page.value("window.haptic.dragged()");
    let (counts, codes) = (numbers(&dragged["counts"]), numbers(&dragged["codes"]));
    assert_eq!(counts.len(), codes.len());
    let [scene, replay] = ["dragged.json", "counts.csv"].map(|name| folder.path().join(name));
    std::fs::write(&scene, dragged["scene"].as_str().unwrap()).unwrap();
    let lines = counts.iter().map(|count| format!("{count}\n")).collect::<String>();
    std::fs::write(&replay, format!("count\n{lines}")).unwrap();
    let [scene, replay] = [&scene, &replay].map(|path| path.to_str().unwrap());
    let run = haptic(&["run", scene, "--replay", replay, "--csv"]);
    assert_eq!(run.status.code(), Some(0), "{run:?}");
    let printed = String::from_utf8(run.stdout).unwrap();
    let of_program: Vec<i64> = printed
        .lines()
        .skip(1)
        .map(|line| line.split(',').nth(4).unwrap().parse().unwrap())
        .collect();
    assert_eq!(of_program, codes);
    let again = page.value(&format!(
        "(() => {{ const d = window.haptic.dragged(); \
         return window.haptic.handle(d.scene, d.counts.slice(0, {}), d.countsPerTurn); }})()",
        counts.len()
    ));
    assert_eq!(numbers(&again), codes);
    page.assert_silent();
}

/// The buttons change the counts that the servo reads; the fields of the cogging and of the share of it that is opposed
/// say so. Readings that fail take the torque, and the page says why.
pub fn the_encoder_of_the_handle_is_exchanged() {
    const KNOB: &str = include_str!("../../explore/src/presets/gimbal_knob.toml");
    let (folder, mut page) = opened(1280, KNOB);
    page.click("#handle-settings summary");
    let counts = "window.haptic.dragged().countsPerTurn";
    page.wait_for(&format!("{counts} === 16384"));
    page.click("#handle-fine-encoder");
    page.wait_for(&format!("{counts} === 10000"));
    page.click("#handle-own-encoder");
    page.wait_for(&format!("{counts} === 16384"));
    for (field, words) in [
        ("device-cogging-torque", "cogging torque"),
        ("device-cogging-count", "cogging count"),
        ("anticogging-share", "share"),
    ] {
        let label = format!("document.querySelector('[for=field-{field}]').textContent");
        assert_eq!(page.value(&label), words);
    }
    page.assert_silent();
    let failing = format!("{KNOB}\n[simulation]\nsamples = 1000\ndropped = {{ every = 7 }}\n");
    page.open_file(&explore(folder.path(), &failing));
    page.click("#handle-push");
    page.wait_for(
        "document.getElementById('handle-state').textContent.includes('No torque. The fault encoder-reading: more \
         readings of the encoder in a row have failed than `encoder.dropped` = 0')",
    );
    page.assert_silent();
}

pub fn a_refused_handle_has_no_torque_until_the_check_is_off() {
    let folder = tempfile::tempdir().unwrap();
    let mut page = Page::start(360);
    let stiff = WALL.replace("stiffness = 22.0", "stiffness = 120.0");
    page.open_file(&explore(folder.path(), &stiff));
    let rendering =
        |page: &mut Page| page.value("document.getElementById('handle').dataset.rendering");
    let said = |page: &mut Page| page.value("document.getElementById('handle-state').textContent");
    assert_eq!(rendering(&mut page), "off");
    assert!(
        said(&mut page)
            .as_str()
            .unwrap()
            .contains("No torque. Rejected: the environment needs alpha")
    );
    drag(&mut page, 60.0);
    page.wait_for("window.haptic.dragged().counts.at(-1) > 10");
    assert_eq!(page.value("window.haptic.dragged().codes.every((code) => code === 2048)"), true);
    let [x, y] = page.middle(DRAWING);
    page.mouse("mouseReleased", [x, y]);

    page.click("#handle-check");
    page.wait_for("document.getElementById('handle').dataset.rendering === 'unchecked'");
    assert!(said(&mut page).as_str().unwrap().contains("simulation only"));
    page.click("#handle-stays");
    drag(&mut page, 40.0);
    page.wait_for("document.getElementById('handle').dataset.oscillates === 'true'");
    let words = page.value("document.getElementById('handle-oscillation').textContent");
    assert!(words.as_str().unwrap().starts_with("Oscillates: "), "{words}");
    page.assert_silent();
}

/// Of a host that pushes along the velocity the hand takes no more than the budget; without the tank, the same
/// hand takes more.
pub fn a_hostile_host_gives_its_budget_and_without_a_tank_more() {
    let host = "energy = 0.05\npower = 0.1\ndamping = 0.004\ntorque = 0.5\ntimeout = 0.05";
    let soft = WALL.replace("stiffness = 22.0", "stiffness = 10.0");
    let soft = soft.replace("damping = 0.01", "damping = 0.002");
    let scene = format!("{soft}[limits]\ntorque = 1.0\n[host]\n{host}\n");
    let (_folder, mut page) = opened(1280, &scene);
    let taken = "document.getElementById('handle-taken')";
    assert_eq!(page.value(&format!("{taken}.textContent")), "");
    page.value(
        "(() => { const law = document.getElementById('handle-host'); law.value = 'pump'; \
         law.dispatchEvent(new Event('change')); })()",
    );
    page.click("#handle-push");
    // The budget rises by 0.1 W: after a second it is more than 150 mJ.
    let budget = format!("Number({taken}.textContent.match(/budget of ([0-9.]+) mJ/)?.[1] ?? 0)");
    page.wait_for(&format!("{budget} > 150"));
    let said = page.value(&format!("{taken}.textContent"));
    assert!(said.as_str().unwrap().starts_with("The hand took "), "{said}");
    assert_eq!(page.value(&format!("{taken}.classList.contains('error')")), false, "{said}");
    page.click("#handle-tank");
    page.wait_for(&format!("{taken}.classList.contains('error')"));
    let said = page.value(&format!("{taken}.textContent"));
    assert!(said.as_str().unwrap().contains("more than that; 0 % refused"), "{said}");
    // A scene without a budget has no switch.
    let (_folder, mut page_without) = opened(1280, WALL);
    assert_eq!(page_without.value("document.getElementById('handle-hosted').hidden"), true);
    page.assert_silent();
}
