//! The page of `haptic explore`: its sources, and the program that they run, as one file.

use std::io::{self, Write};

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use flate2::Compression;
use flate2::write::GzEncoder;
use serde_json::{Value, json};

/// A source of the page.
macro_rules! source {
    ($name:literal) => {
        include_str!(concat!("../explore/page/", $name))
    };
}

const PAGE: &str = source!("index.html");
const STYLE: &str = source!("style.css");

/// The sources of the page's program, each after those that it uses. They are one program: none has a name
/// that another one has.
const PROGRAM: &[&str] = &[
    source!("elements.js"),
    source!("engine.js"),
    source!("store.js"),
    source!("slider_scale.js"),
    source!("field.js"),
    source!("fields.js"),
    source!("verdict.js"),
    source!("link.js"),
    source!("theme.js"),
    source!("exchange.js"),
    source!("plot.js"),
    source!("png.js"),
    source!("nyquist.js"),
    source!("map.js"),
    source!("profile.js"),
    source!("pictures.js"),
    source!("sound.js"),
    source!("hand_input.js"),
    source!("handle_drawing.js"),
    source!("force_bar.js"),
    source!("hand_settings.js"),
    source!("handle.js"),
    source!("serial.js"),
    source!("socket.js"),
    source!("strips.js"),
    source!("board.js"),
    source!("main.js"),
];

/// Those of its worker, which draws what takes longer than a frame.
const WORKER: &[&str] = &[source!("engine.js"), source!("map_worker.js")];

/// The page that starts with a scene, which is a scene file as JSON, around the program of the package
/// `haptic-explore`.
///
/// # Errors
/// Where memory cannot be written to, which is never so.
pub fn page(module: &[u8], scene: &Value) -> io::Result<String> {
    let start = json!({ "scene": scene, "version": env!("CARGO_PKG_VERSION") });
    let parts = [
        ("/*STYLE*/", STYLE.to_owned()),
        ("/*BEGIN*/", source!("start.js").to_owned()),
        ("<!--PROGRAM-->", packed(PROGRAM.concat().as_bytes())?),
        ("<!--WORKER-->", WORKER.concat()),
        ("<!--START-->", start.to_string().replace('<', "\\u003c")),
        ("<!--MODULE-->", packed(module)?),
    ];
    let mut page = PAGE.to_owned();
    for (place, part) in parts {
        page = page.replacen(place, &part, 1);
    }
    Ok(page)
}

/// Compressed, in the letters of a page.
fn packed(bytes: &[u8]) -> io::Result<String> {
    let mut encoder = GzEncoder::new(Vec::new(), Compression::best());
    encoder.write_all(bytes)?;
    Ok(STANDARD.encode(encoder.finish()?))
}
