//! What leaves the page: a scene file, constants of a program, pictures, and a link.

use std::fs;
use std::io::Cursor;

use analysis::file::constant::constants;

use crate::common::WALL;
use crate::common::board::Running;
use crate::devtools::{Page, saved};
use crate::explore::{explore, opened};
use crate::picture::Picture;
use crate::serve;
use crate::verdict_page::{certified, certified_by_page, choose, presets};

/// The text that a button of the page shows.
fn exported(page: &mut Page, button: &str) -> String {
    page.click(button);
    let text = page.value("document.querySelector('#export textarea').value");
    page.value("document.getElementById('export').close()");
    page.wait_for("document.getElementById('export') === null");
    text.as_str().unwrap().to_owned()
}

pub fn what_the_page_exports_is_the_scene_to_the_bit() {
    let (folder, mut page) = opened(1280, WALL);
    let file = folder.path().join("exported.toml");
    for name in presets(&mut page) {
        choose(&mut page, &name);
        let of_page = certified_by_page(&mut page);
        assert!(of_page.contains("\"alpha\":{\"lo\":"), "{of_page}");
        fs::write(&file, exported(&mut page, "#export-toml")).unwrap();
        // Numbers are printed so that each stands for one double only.
        assert_eq!(certified(file.to_str().unwrap()), of_page, "{name}");
        // Constants like these are compiled beside the page's sources.
        let scene = analysis::file::load(file.to_str().unwrap()).unwrap();
        assert_eq!(exported(&mut page, "#export-rust"), constants(&scene).unwrap(), "{name}");
    }
    page.assert_silent();
}

/// Pixels of a PNG to one of the page.
const SCALE: f64 = 2.0;

/// Rows of the page above a picture, which have its title, and the least below it.
const ABOVE: f64 = 32.0;
const BELOW: f64 = 8.0;

pub fn each_picture_is_saved_as_a_png_of_its_size() {
    let (folder, mut page) = opened(1280, WALL);
    page.save_into(folder.path());
    let names = page.value("[...document.querySelectorAll('.picture')].map((one) => one.id)");
    let names: Vec<String> = serde_json::from_value(names).unwrap();
    let expected = ["handle", "map", "nyquist", "profile", "motion"];
    assert_eq!(names, expected.map(|name| format!("picture-{name}")));
    let mut drawn = Vec::new();
    for name in expected {
        let canvas = format!("#picture-{name} > canvas");
        page.middle(&canvas);
        // The handle's picture has no words but those beside it, and is drawn as time goes by.
        let drawn_of = match name {
            "handle" => "window.haptic.dragged().counts.length > 100".to_owned(),
            _ => format!(
                "document.querySelector('{canvas}').getAttribute('aria-label').includes('. ')"
            ),
        };
        page.wait_for(&drawn_of);
        let size = page.value(&format!(
            "(({{ clientWidth, clientHeight }}) => [clientWidth, clientHeight])\
             (document.querySelector('{canvas}'))"
        ));
        let [wide, high] = [0, 1].map(|axis| size[axis].as_f64().unwrap());
        page.click(&format!("#picture-{name} button[aria-label^='Save as PNG']"));
        let file = saved(&folder.path().join(format!("delayed-wall-{name}.png")));
        let bytes = Cursor::new(file);
        let Picture { size: [width, height], pixels, .. } = Picture::read(bytes, "");
        assert_eq!(f64::from(width), SCALE * wide.max(480.0), "{name}");
        assert!(f64::from(height) >= SCALE * (ABOVE + high + BELOW), "{name}: {height}, {high}");
        // Of the picture itself, without title and legend: neither blank nor nothing but ground.
        let rows = (SCALE * ABOVE) as usize * width as usize
            ..(SCALE * (ABOVE + high)) as usize * width as usize;
        let picture = pixels[rows].to_vec();
        let ground = picture[0];
        let inked = picture.iter().filter(|pixel| **pixel != ground).count();
        assert!(inked * 200 > picture.len(), "{name}: {inked} of {}", picture.len());
        assert!(!drawn.contains(&picture), "{name} is another one");
        drawn.push(picture);
    }
    page.assert_silent();
}

/// Has the page copy its link, with a clipboard of the test's own: the machine's clipboard belongs to its
/// user.
fn copied_link(page: &mut Page) -> String {
    page.value(
        "Object.defineProperty(navigator, 'clipboard', { configurable: true, value: \
         { writeText: async (text) => { window.copied = text; } } }) && undefined",
    );
    page.click("#copy-link");
    page.wait_for("window.copied");
    page.value("window.copied").as_str().unwrap().to_owned()
}

pub fn a_copied_link_is_the_scene_and_has_no_token() {
    let folder = tempfile::tempdir().unwrap();
    let mut page = Page::start(1280);
    let file = explore(folder.path(), WALL);
    page.open_file(&file);
    choose(&mut page, "knob");
    let link = copied_link(&mut page);
    assert!(link.starts_with(&format!("file://{}#scene=", file.display())), "{link}");
    let mut other = Page::start(360);
    other.open(&link);
    let [shown, linked] = [&mut page, &mut other].map(|page| page.value("window.haptic.scene()"));
    assert_eq!(shown, linked);

    // A client with the token has the board.
    let board = serve::board(folder.path());
    let (_server, address) = Running::start(&["serve", "--port", &board.address().to_string()]);
    let (server, token) = address.split_once("?token=").expect("an address with a token");
    let mut served = Page::start(1280);
    served.open(&address);
    choose(&mut served, "knob");
    let of_served = copied_link(&mut served);
    assert!(!of_served.contains("token") && !of_served.contains(token), "{of_served}");
    let (_, scene) = link.split_once('#').unwrap();
    assert_eq!(of_served, format!("{server}#{scene}"));
    for page in [page, other, served] {
        page.assert_silent();
    }
}
