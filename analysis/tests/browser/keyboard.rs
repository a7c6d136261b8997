//! The page by its keyboard alone: every control is reached and visibly focused, and handles that a mouse
//! drags move by arrow keys. In light and in dark, and on a narrow page.

use serde_json::{Value, json};

use crate::common::WALL;
use crate::devtools::Page;
use crate::explore::explore;
use crate::scene_page::scene;

/// Most presses of a key until all is reached.
const PRESSES: usize = 400;

/// Least contrast of a mark of the focus with its ground, as WCAG 2.2 has it (1.4.11).
const CONTRAST: f64 = 3.0;

/// Presses a key that the browser itself acts on, by its name and its code.
fn press(page: &mut Page, key: &str, code: u32) {
    for what in ["rawKeyDown", "keyUp"] {
        let event = json!({ "type": what, "key": key, "code": key, "windowsVirtualKeyCode": code });
        page.call("Input.dispatchKeyEvent", event);
    }
}

fn tab(page: &mut Page) {
    press(page, "Tab", 9);
}

fn arrow_right(page: &mut Page) {
    press(page, "ArrowRight", 39);
}

/// Defines `reachable()`, the controls that a user can operate, and `focused()`, the description of the
/// focused control.
const DEFINITIONS: &str = r#"
window.reachable = () => [...document.querySelectorAll(
    "button, input, select, textarea, summary, [tabindex]")]
  .filter((one) => one.tabIndex >= 0 && !one.disabled && one.checkVisibility({ visibilityProperty: true }));
window.nameOf = (one) => one.id || one.getAttribute("aria-label") || one.outerHTML.slice(0, 120);
const light = (colour) => {
  const parts = colour.match(/[\d.]+/g).slice(0, 3).map((part) => part / 255);
  const [r, g, b] = parts.map((part) => (part <= 0.04045 ? part / 12.92 : ((part + 0.055) / 1.055) ** 2.4));
  return 0.2126 * r + 0.7152 * g + 0.0722 * b + 0.05;
};
window.focused = async () => {
  const one = document.activeElement;
  if (!one || one === document.body) return null;
  await new Promise(requestAnimationFrame);
  one.wasReached = true;
  const [style, box] = [getComputedStyle(one), one.getBoundingClientRect()];
  const [ink, ground] = [style.outlineColor, getComputedStyle(document.body).backgroundColor].map(light);
  const at = document.elementFromPoint(box.x + box.width / 2, box.y + box.height / 2);
  return {
    name: nameOf(one),
    outline: style.outlineStyle === "none" ? 0 : parseFloat(style.outlineWidth),
    contrast: Math.max(ink, ground) / Math.min(ink, ground),
    over: at && nameOf(at),
    isSeen: at !== null && (one.contains(at) || at.contains(one)),
  };
};
undefined
"#;

/// Goes through the page, and returns the number of elements that had the focus.
fn walk(page: &mut Page) -> usize {
    page.value(DEFINITIONS);
    page.value("for (const one of document.querySelectorAll('details')) one.open = true");
    let left = "reachable().filter((one) => !one.wasReached).map(nameOf)";
    let mut seen = 0;
    for _ in 0..PRESSES {
        tab(page);
        let focused = page.value("focused()");
        if focused.is_null() {
            // Behind the last element the browser itself has the focus.
            if page.value(left) == json!([]) {
                break;
            }
            continue;
        }
        seen += 1;
        assert!(focused["outline"].as_f64().unwrap() >= 1.0, "no outline: {focused}");
        assert!(focused["contrast"].as_f64().unwrap() >= CONTRAST, "hardly seen: {focused}");
        assert_eq!(focused["isSeen"], true, "it is behind something: {focused}");
    }
    assert_eq!(page.value(left), json!([]), "not reached");
    seen
}

fn focus(page: &mut Page, selector: &str) {
    page.value(&format!("document.querySelector({selector:?}).focus()"));
}

/// Arrow keys move all that a mouse drags.
fn move_by_arrows(page: &mut Page) {
    let before = scene(page);
    focus(page, "[data-key='environment.stiffness'] input[type='range']");
    arrow_right(page);
    page.wait_for(&format!("window.haptic.scene() !== JSON.stringify({before})"));
    let after = scene(page);
    let stiffness = |scene: &Value| scene["environment"]["stiffness"].as_f64().unwrap();
    assert!(stiffness(&after) > stiffness(&before), "{after}");

    let angle = "Number(document.getElementById('handle-drawing').getAttribute('aria-valuenow'))";
    let at = page.value(angle);
    focus(page, "#handle-drawing");
    (0..5).for_each(|_| arrow_right(page));
    page.wait_for(&format!("{angle} > {at}"));

    page.wait_for("document.querySelector('#picture-map').dataset.progress === 'all'");
    focus(page, "#picture-map > canvas");
    arrow_right(page);
    page.wait_for(&format!("window.haptic.scene() !== JSON.stringify({after})"));
}

/// A dialogue takes the focus, and gives it back.
fn export_by_keys(page: &mut Page) {
    focus(page, "#export-toml");
    press(page, " ", 32);
    page.wait_for("document.getElementById('export')?.contains(document.activeElement)");
    press(page, "Escape", 27);
    page.wait_for("document.getElementById('export') === null");
    assert_eq!(page.value("document.activeElement.id"), "export-toml");
}

pub fn the_page_is_operated_by_its_keyboard_in_light_and_dark() {
    let folder = tempfile::tempdir().unwrap();
    let file = explore(folder.path(), WALL);
    let mut grounds = Vec::new();
    for (scheme, width) in [("light", 1280), ("dark", 1280), ("light", 360)] {
        let mut page = Page::start(width);
        let feature = json!({ "name": "prefers-color-scheme", "value": scheme });
        page.call("Emulation.setEmulatedMedia", json!({ "features": [feature] }));
        page.open_file(&file);
        page.wait_for("document.getElementById('preset')");
        let reached = walk(&mut page);
        assert!(reached > 40, "{scheme}: {reached}");
        move_by_arrows(&mut page);
        export_by_keys(&mut page);
        grounds.push(page.value("getComputedStyle(document.body).backgroundColor"));
        page.assert_silent();
    }
    assert_ne!(grounds[0], grounds[1]);
}
