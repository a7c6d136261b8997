//! The report as its reader sees it.

#[path = "page/chromium.rs"]
mod chromium;

use std::path::Path;

use crate::common::{WALL, complaint, haptic};
use base64::Engine;
use serde_json::Value;

const MEASURE: &str = include_str!("page/measure.js");

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

/// Writes the report of a scene; its text and the program's exit status.
fn report(folder: &Path, scene: &str) -> (String, Option<i32>) {
    let (file, page) = (folder.join("scene.toml"), folder.join("report.html"));
    std::fs::write(&file, scene).unwrap();
    let run = haptic(&["report", file.to_str().unwrap(), "-o", page.to_str().unwrap()]);
    assert!(run.stderr.is_empty(), "{run:?}");
    let said = String::from_utf8(run.stdout).unwrap();
    let word = if run.status.code() == Some(0) {
        "report.html: certified"
    } else {
        "report.html: rejected"
    };
    assert!(said.contains(word), "{said}");
    (std::fs::read_to_string(page).unwrap(), run.status.code())
}

/// What a browser finds on a page, in a window so many pixels wide.
fn measure(folder: &Path, page: &str, width: u32) -> Value {
    let copy = folder.join("measured.html");
    std::fs::write(&copy, page.replace("</body>", &format!("<script>{MEASURE}</script></body>")))
        .unwrap();
    let dom = chromium::dom(&copy, width);
    let (_, rest) = dom.split_once("<pre id=\"measured\">").expect("the page was measured");
    let (measured, _) = rest.split_once("</pre>").unwrap();
    let json = base64::engine::general_purpose::STANDARD.decode(measured).unwrap();
    serde_json::from_slice(&json).unwrap()
}

#[test]
fn nothing_is_missing_cut_off_or_in_the_way() {
    let folder = tempfile::tempdir().unwrap();
    let long = "a name so long that no picture has room for all of it, as people write them";
    let cases = [
        (format!("{WALL}{MOTION}"), 0, 3),
        (
            format!(
                "{}{MOTION}",
                WALL.replace("delayed wall", &format!("<b>&amp; {long}"))
                    .replace("delay = 1", "delay = 2")
            ),
            1,
            3,
        ),
        (
            WALL.replace("delayed wall", "still").replace("stiffness = 44.0", "stiffness = 30.0"),
            1,
            2,
        ),
        (
            format!(
                "{}\ntype = \"free-mode\"\nresidual = 0.001\n",
                WALL.split_once("type").unwrap().0
            ),
            0,
            1,
        ),
    ];
    for (scene, status, pictures) in cases {
        let (page, code) = report(folder.path(), &scene);
        assert_eq!(code, Some(status), "{scene}");
        for width in [1200, 500] {
            let seen = measure(folder.path(), &page, width);
            assert_eq!(seen["found"], serde_json::json!([]), "{width} pixels: {scene}");
            assert_eq!(seen["pictures"], pictures, "{scene}");
            let text = |id: &str| seen["texts"][id].as_str().unwrap_or_default().to_owned();
            let verdict = if status == 0 { "CERTIFIED" } else { "REJECTED" };
            assert!(text("verdict").starts_with(verdict), "{}", text("verdict"));
            assert!(text("numbers").contains("N m s/rad"));
            assert!(text("assumptions").lines().count() >= 3);
            assert_eq!(text("remedies").is_empty(), status == 0);
            for id in ["nyquist", "map", "motion"] {
                assert!(!text(id).is_empty(), "{id}");
            }
            assert!(scene.contains(seen["title"].as_str().unwrap()));
        }
    }
}

#[test]
fn the_measurement_finds_what_it_looks_for() {
    let folder = tempfile::tempdir().unwrap();
    let text = |x: i32, words: &str| format!("<text x='{x}' y='40'>{words}</text>");
    let bad = [
        ("off the page", "<p style='width: 3000px'>wide</p>".to_owned()),
        (
            "wider than its box",
            "<p style='width: 3em; overflow: hidden'>unbreakable</p>".to_owned(),
        ),
        ("cut off", format!("<svg width='200' height='60'>{}</svg>", text(180, "too far"))),
        (
            "overlap",
            format!("<svg width='200' height='60'>{}{}</svg>", text(9, "one"), text(12, "two")),
        ),
    ];
    for (what, body) in bad {
        let page = format!("<!DOCTYPE html><html><body>{body}</body></html>");
        let found = measure(folder.path(), &page, 800)["found"].to_string();
        assert!(found.contains(what), "{what}: {found}");
    }
}

#[test]
fn the_page_stands_alone() {
    let folder = tempfile::tempdir().unwrap();
    let (page, _) = report(folder.path(), &format!("{WALL}{MOTION}"));
    let links = page.replace("http://www.w3.org/2000/svg", "");
    for outside in ["http:", "https:", "src=", "href=", "@import", "url(", "<script"] {
        assert!(!links.contains(outside), "{outside}");
    }
}

#[test]
fn the_page_says_what_was_judged_where_from_and_when() {
    let folder = tempfile::tempdir().unwrap();
    let (file, page) = (folder.path().join("scene.toml"), folder.path().join("report.html"));
    std::fs::write(&file, format!("{WALL}{MOTION}")).unwrap();
    let [file, page] = [&file, &page].map(|path| path.to_str().unwrap());
    let write = |epoch: &str| {
        let mut report = crate::common::program(&["report", file, "-o", page]);
        let run = report.env("SOURCE_DATE_EPOCH", epoch).output().unwrap();
        (run, crate::common::read(page))
    };
    let (run, first) = write("951782400");
    assert_eq!(run.status.code(), Some(0), "{run:?}");
    let version = env!("CARGO_PKG_VERSION");
    for part in [
        format!("Of {file}, by haptic {version}, on 2000-02-29."),
        "damper-wall".to_owned(),
        "22 N m/rad".to_owned(),
        "0.0001 kg m\u{b2}, 0.02 N m s/rad, 4 N m/rad".to_owned(),
    ] {
        assert!(first.contains(&part), "{part}");
    }
    assert!(first == write("951782400").1, "the same input gives the same page");
    assert_eq!(write("soon").0.status.code(), Some(2));
}

#[test]
fn a_page_that_cannot_be_is_a_bad_question() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("scene.toml");
    std::fs::write(&file, WALL).unwrap();
    for (page, words) in [("page.pdf", "must end in .html"), ("no/such/page.html", "No such file")]
    {
        let page_path = folder.path().join(page);
        let question = ["report", file.to_str().unwrap(), "-o", page_path.to_str().unwrap()];
        let said = complaint(haptic(&question));
        assert!(said.contains(page) && said.contains(words), "{said}");
    }
}
