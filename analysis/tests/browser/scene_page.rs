//! A user on the page of `haptic explore`: changes a field, applies a remedy, makes a mistake, follows a
//! link, moves the scene on its map.

use serde_json::{Value, json};

use crate::common::WALL;
use crate::devtools::Page;
use crate::explore::{explore, opened};

/// Types a value into a field.
fn enter(page: &mut Page, field: &str, value: &str) {
    page.value(&format!(
        "(() => {{ const field = document.querySelector({field:?}); field.value = {value:?}; \
         field.dispatchEvent(new Event('input', {{ bubbles: true }})); \
         field.dispatchEvent(new Event('change', {{ bubbles: true }})); }})()"
    ));
}

/// The scene that the page shows.
pub fn scene(page: &mut Page) -> Value {
    let text = page.value("window.haptic.scene()");
    serde_json::from_str(text.as_str().unwrap()).unwrap()
}

const VERDICT: &str = "document.documentElement.dataset.verdict";

pub fn a_field_changes_the_verdict_and_a_remedy_certifies() {
    let (_folder, mut page) = opened(1280, WALL);
    assert_eq!(page.value(VERDICT), "certified");
    enter(&mut page, "#field-environment-stiffness", "60");
    page.wait_for(&format!("{VERDICT} === 'rejected'"));
    assert_eq!(scene(&mut page)["environment"]["stiffness"], 60);
    page.wait_for("document.querySelector('#verdict-rows button')");
    page.click("#verdict-rows button");
    page.wait_for(&format!("{VERDICT} === 'certified'"));

    // A text that is not a number is named, and stays.
    enter(&mut page, "#field-device-inertia", "1,5");
    page.wait_for(&format!("{VERDICT} === undefined"));
    let named = page.value("document.querySelector('#field-device-inertia-error').textContent");
    assert!(named.as_str().unwrap().contains("1,5"), "{named}");
    let field = "document.querySelector('#field-device-inertia')";
    assert_eq!(page.value(&format!("{field}.value")), "1,5");
    assert_eq!(page.value(&format!("{field}.getAttribute('aria-invalid')")), "true");
    enter(&mut page, "#field-device-inertia", "2.2e-5");
    page.wait_for(&format!("{VERDICT} === 'certified'"));
    page.assert_silent();
}

pub fn on_paper_there_is_nothing_to_operate() {
    let (_folder, mut page) = opened(1280, WALL);
    page.call("Emulation.setEmulatedMedia", json!({ "media": "print" }));
    let mut shown = |what: &str| {
        let all = format!("[...document.querySelectorAll({what:?})]");
        page.value(&format!("{all}.filter((one) => one.checkVisibility()).length"))
    };
    assert_eq!(shown("button, input[type=range], #handle, #board, #whole"), 0);
    for kept in ["#verdict-word", "#verdict-rows dd", "#fields input", ".picture > canvas"] {
        assert_ne!(shown(kept), 0, "{kept}");
    }
}

pub fn a_link_is_the_scene_and_a_bad_one_is_named() {
    let folder = tempfile::tempdir().unwrap();
    let file = explore(folder.path(), WALL);
    let mut page = Page::start(360);
    page.open_file(&file);
    enter(&mut page, "#field-environment-stiffness", "17.25");
    page.wait_for("location.hash.startsWith('#scene=')");
    let shown = scene(&mut page);
    let link = page.value("location.href");
    let mut other = Page::start(360);
    other.open(link.as_str().unwrap());
    assert_eq!(scene(&mut other), shown);
    assert_eq!(shown["environment"]["stiffness"], 17.25);

    let mut bad = Page::start(360);
    bad.open(&format!("file://{}#scene=%%%", file.display()));
    bad.wait_for("!document.querySelector('#notice').hidden");
    assert_eq!(scene(&mut bad)["environment"]["stiffness"], 22);
    for page in [page, other, bad] {
        page.assert_silent();
    }
}

pub fn a_narrow_page_is_not_cut_off_and_every_field_has_a_label() {
    let (_folder, mut page) = opened(360, WALL);
    let width = page.value("document.documentElement.scrollWidth");
    assert!(width.as_f64().unwrap() <= 360.0, "{width}");
    let order = page.value(
        "['summary', 'handle', 'verdict', 'parameters', 'pictures', 'board'].map((id) => \
         document.getElementById(id).getBoundingClientRect().top)",
    );
    let tops: Vec<f64> = serde_json::from_value(order).unwrap();
    assert!(tops.is_sorted() && tops[0] < 20.0 && tops[1] < 120.0, "{tops:?}");
    let words = page.value("document.body.textContent");
    assert!(!words.as_str().unwrap().contains("[object"), "{words}");
    let unnamed = page.value(
        "[...document.querySelectorAll('input, select, textarea, button')].filter((one) => \
         one.offsetParent && \
         !(one.labels?.length || one.ariaLabel || one.textContent.trim() || \
         one.getAttribute('aria-labelledby'))).map((one) => one.outerHTML)",
    );
    assert_eq!(unnamed, Value::Array(Vec::new()));
    let double = page.value(
        "(() => { const ids = [...document.querySelectorAll('[id]')].map((one) => one.id); \
         return ids.filter((id, index) => ids.indexOf(id) !== index); })()",
    );
    assert_eq!(double, Value::Array(Vec::new()));
}

pub fn the_map_is_drawn_and_moves_the_scene() {
    let (_folder, mut page) = opened(1280, WALL);
    page.wait_for("document.querySelector('#picture-map').dataset.progress === 'all'");
    let before = scene(&mut page);
    let place = page.middle("#picture-map > canvas");
    page.mouse("mousePressed", place);
    page.mouse("mouseReleased", place);
    page.wait_for(&format!("window.haptic.scene() !== {:?}", before.to_string()));
    page.wait_for(&format!("{VERDICT} !== undefined"));
    let after = scene(&mut page);
    let moved = |key: &str| before["environment"][key] != after["environment"][key];
    assert!(moved("stiffness") || moved("damping"), "{after}");
    assert_eq!(before["device"], after["device"]);
    for picture in ["map", "nyquist", "profile", "motion"] {
        let label = format!(
            "document.querySelector('#picture-{picture} > canvas').getAttribute('aria-label')"
        );
        page.wait_for(&label);
    }
    page.assert_silent();
}
