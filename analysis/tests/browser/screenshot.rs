//! The picture with which the README opens: the page with the preset of a knob. With `PICTURES=overwrite` it
//! is taken anew.
//!
//! Browsers and fonts differ, and with them every line of text. So the kept file has the words of the page,
//! too, which have to be those of today to the letter; of its pixels only the large is compared.

use std::fs::File;
use std::io::{BufReader, BufWriter, Cursor};
use std::path::{Path, PathBuf};

use data_encoding::BASE64;
use serde_json::json;

use crate::common::{WALL, root};
use crate::devtools::Page;
use crate::explore::explore;
use crate::picture::Picture;
use crate::verdict_page::choose;

/// Pixels of the picture.
const SIZE: [u32; 2] = [1280, 1120];

/// The entry of the file with the words of the page.
const WORDS: &str = "Description";

/// Sides of the squares in pixels of which the mean colours are compared.
const SQUARE: usize = 20;

/// Mean colours differ where red, green or blue differs by more than this, of 255. Text on its ground does
/// not.
const FAR: f64 = 60.0;

/// Largest part of squares of another colour: with another font, sliders and lines are elsewhere.
const PART: f64 = 0.1;

fn write(picture: &Picture, file: &Path) {
    let file = BufWriter::new(File::create(file).unwrap());
    let mut encoder = png::Encoder::new(file, picture.size[0], picture.size[1]);
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_compression(png::Compression::Best);
    encoder.add_itxt_chunk(WORDS.to_owned(), picture.words.clone()).unwrap();
    encoder.write_header().unwrap().write_image_data(picture.pixels.as_flattened()).unwrap();
}

/// The mean colour of each square.
fn squares(picture: &Picture) -> Vec<[f64; 3]> {
    let [width, height] = picture.size.map(|pixels| pixels as usize);
    let corners =
        (0..height / SQUARE).flat_map(|row| (0..width / SQUARE).map(move |column| [column, row]));
    let mean = |[column, row]: [usize; 2]| {
        let mut sum = [0.0; 3];
        for (y, x) in (0..SQUARE).flat_map(|y| (0..SQUARE).map(move |x| (y, x))) {
            let pixel = picture.pixels[(row * SQUARE + y) * width + column * SQUARE + x];
            (0..3).for_each(|colour| sum[colour] += f64::from(pixel[colour]));
        }
        sum.map(|sum| sum / (SQUARE * SQUARE) as f64)
    };
    corners.map(mean).collect()
}

/// The part of the squares in which two pictures of one size have another colour.
fn differing(one: &Picture, other: &Picture) -> f64 {
    let (own, others) = (squares(one), squares(other));
    let is_far =
        |(a, b): (&[f64; 3], &[f64; 3])| (0..3).any(|colour| (a[colour] - b[colour]).abs() > FAR);
    own.iter().zip(&others).filter(|pair| is_far(*pair)).count() as f64 / own.len() as f64
}

/// Takes the handle of the knob at its top, turns it an eighth of a turn, and keeps it there.
fn turn_the_knob(page: &mut Page) {
    const RADIUS: f64 = 80.0;
    let [x, y] = page.middle("#handle-drawing");
    let at = |part: f64| {
        let (sine, cosine) = (part * std::f64::consts::FRAC_PI_4).sin_cos();
        [x + RADIUS * sine, y - RADIUS * cosine]
    };
    page.mouse("mouseMoved", at(0.0));
    page.mouse("mousePressed", at(0.0));
    (1..=20).for_each(|step| page.mouse("mouseMoved", at(f64::from(step) / 20.0)));
    page.value(
        "(async () => { const angle = () => \
         document.getElementById('handle-drawing').getAttribute('aria-valuenow'); \
         for (let last; last !== angle();) { last = angle(); \
         await new Promise((resolve) => setTimeout(resolve, 500)); } })()",
    );
}

/// The words of the page but those that move with the handle: titles, fields with their values, the verdict.
fn words(page: &mut Page) -> String {
    let words = page.value(
        "[...document.querySelectorAll('h1, header button, #preset option, #verdict-word, #margin-words, h2, \
         legend, #fields label, #fields .unit, #fields input, #fields select, #verdict-rows dt, \
         #verdict-rows dd, #handle-state')] \
         .filter((one) => one.checkVisibility() || one.tagName === 'OPTION') \
         .map((one) => (one.type === 'checkbox' ? one.checked : one.value) ?? one.textContent) \
         .map(String).filter((words) => words !== '').join('\\n')",
    );
    words.as_str().unwrap().to_owned()
}

/// The page with a knob in a hand.
fn taken() -> Picture {
    let folder = tempfile::tempdir().unwrap();
    let mut page = Page::start(SIZE[0]);
    let [width, height] = SIZE;
    let screen =
        json!({ "width": width, "height": height, "deviceScaleFactor": 1, "mobile": false });
    page.call("Emulation.setDeviceMetricsOverride", screen);
    page.call("Emulation.setScrollbarsHidden", json!({ "hidden": true }));
    let light = json!([{ "name": "prefers-color-scheme", "value": "light" }]);
    page.call("Emulation.setEmulatedMedia", json!({ "features": light }));
    page.open_file(&explore(folder.path(), WALL));
    choose(&mut page, "knob");
    turn_the_knob(&mut page);
    page.value("scrollTo({ top: 0, behavior: 'instant' }) ?? new Promise(requestAnimationFrame)");
    let shot = page.call("Page.captureScreenshot", json!({ "format": "png" }));
    let shot = BASE64.decode(shot["data"].as_str().unwrap().as_bytes()).unwrap();
    let words = words(&mut page);
    page.assert_silent();
    Picture { words, ..Picture::read(Cursor::new(shot), WORDS) }
}

fn kept() -> PathBuf {
    root().join("analysis/pictures/explore.png")
}

pub fn the_readme_opens_with_the_page_of_today() {
    const HOW: &str =
        "PICTURES=overwrite cargo test -p analysis --test browser readme takes it anew";
    let taken = taken();
    assert_eq!(taken.size, SIZE);
    if std::env::var_os("PICTURES").is_some_and(|value| value == "overwrite") {
        write(&taken, &kept());
    }
    let kept = Picture::read(BufReader::new(File::open(kept()).unwrap()), WORDS);
    assert_eq!(kept.size, SIZE, "{HOW}");
    assert_eq!(kept.words, taken.words, "the picture is of another page; {HOW}");
    let differing = differing(&kept, &taken);
    assert!(differing <= PART, "{differing} of the picture is another; {HOW}");
}
