//! The page of `haptic explore`: its sources, and the program that they run, as one file.

use std::io::{self, Write};

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

/// The sources of the page's program, each after those that it uses. They form one program: no name is
/// defined twice.
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
    source!("served.js"),
    source!("strips.js"),
    source!("board.js"),
    source!("main.js"),
];

/// The sources of its worker, which draws pictures that take longer than a frame.
const WORKER: &[&str] = &[source!("engine.js"), source!("map_worker.js")];

/// The page that starts with a scene, which is a scene file as JSON, around the program of the package
/// `haptic-explore`.
pub fn page(module: &[u8], scene: &Value) -> io::Result<String> {
    let start = json!({ "scene": scene, "version": env!("CARGO_PKG_VERSION") });
    let parts = [
        // No text of the style has such a space in it.
        ("/*STYLE*/", without_comments(&[STYLE]).replace(": ", ":").replace(" {", "{")),
        ("/*BEGIN*/", source!("start.js").to_owned()),
        ("<!--PROGRAM-->", packed(without_comments(PROGRAM).as_bytes())?),
        ("<!--WORKER-->", packed(without_comments(WORKER).as_bytes())?),
        ("<!--START-->", start.to_string().replace('<', "\\u003c")),
        ("<!--MODULE-->", packed(module)?),
    ];
    let mut page = PAGE.to_owned();
    for (place, part) in parts {
        page = page.replacen(place, &part, 1);
    }
    Ok(page)
}

/// Sources without indentation, and without their comments, each of which has lines of its own: a tenth of the
/// page that the browser does not need.
fn without_comments(sources: &[&str]) -> String {
    let mut is_within = false;
    let lines = sources.iter().flat_map(|source| source.lines()).map(str::trim_start);
    let kept = lines.filter(|line| {
        is_within |= line.starts_with("/*");
        let is_comment = is_within || line.starts_with("//");
        is_within &= !line.ends_with("*/");
        !is_comment && !line.is_empty()
    });
    kept.flat_map(|line| [line, "\n"]).collect()
}

/// The bytes, compressed and in the letters of a page.
fn packed(bytes: &[u8]) -> io::Result<String> {
    // Beyond the best of zlib, which this package has in Rust.
    const MOST: Compression = Compression::new(10);
    let mut encoder = GzEncoder::new(Vec::new(), MOST);
    encoder.write_all(bytes)?;
    Ok(letters(&encoder.finish()?))
}

/// Number of letters in a page's script: all visible ASCII characters except `<`, which would end the script.
const LETTERS: u32 = 93;

/// Bytes as letters, two for 13 bits, the lowest first: 8 % less than in base 64. Up to six bits that are
/// left at the end are one letter. `start.js` reads it.
fn letters(bytes: &[u8]) -> String {
    let letter = |digit: u32| {
        let beyond = u32::from(digit >= u32::from(b'<' - b'!'));
        char::from_u32(u32::from(b'!') + digit + beyond).unwrap_or('!')
    };
    let mut text = String::with_capacity(bytes.len() * 16 / 13 + 2);
    let (mut held, mut bits) = (0, 0);
    for byte in bytes {
        held |= u32::from(*byte) << bits;
        bits += 8;
        if bits >= 13 {
            let pair = held & 0x1fff;
            text.extend([letter(pair % LETTERS), letter(pair / LETTERS)]);
            (held, bits) = (held >> 13, bits - 13);
        }
    }
    match bits {
        0 => {}
        1..=6 => text.push(letter(held)),
        _ => text.extend([letter(held % LETTERS), letter(held / LETTERS)]),
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    /// By the definition of the letters alone: a row of bits.
    fn bytes_of(text: &str) -> Vec<u8> {
        let digit = |letter: u8| u32::from(letter) - if letter < b'<' { 33 } else { 34 };
        let mut row = Vec::new();
        for pair in text.as_bytes().chunks(2) {
            let (number, bits) = match *pair {
                [low, high] => (digit(low) + 93 * digit(high), 13),
                _ => (digit(pair[0]), 6),
            };
            row.extend((0..bits).map(|bit| (number >> bit & 1) as u8));
        }
        row.chunks_exact(8).map(|byte| (0..8).map(|bit| byte[bit] << bit).sum()).collect()
    }

    /// A comment that shares a line with code, or a text of several lines, would not survive this.
    #[test]
    fn only_comments_are_left_out() {
        let lean = without_comments(&["a();\n  /** b\n   * c */\n  // d\n\n  e(`f // g`);\n"]);
        assert_eq!(lean, "a();\ne(`f // g`);\n");
        for source in [PROGRAM, WORKER].into_iter().flatten() {
            for line in source.lines().map(str::trim) {
                let begins = line.starts_with("/*") || line.starts_with("* ");
                assert!(!begins || !line.contains("*/") || line.ends_with("*/"), "{line}");
                let is_comment = begins || line.starts_with("//");
                assert!(is_comment || line.matches('`').count() % 2 == 0, "{line}");
            }
        }
    }

    #[test]
    fn letters_are_those_of_a_script_and_hold_the_bytes() {
        let mut random = fastrand::Rng::with_seed(93);
        for length in 0..200_usize {
            let mut bytes: Vec<u8> = (0..length).map(|_| random.u8(..)).collect();
            if length % 3 == 0 {
                bytes.fill(0xff);
            }
            let text = letters(&bytes);
            assert_eq!(bytes_of(&text), bytes);
            assert!(text.len() <= (16 * length).div_ceil(13), "{length}: {}", text.len());
            assert!(
                text.bytes().all(|letter| letter.is_ascii_graphic() && letter != b'<'),
                "{text}"
            );
        }
    }
}
