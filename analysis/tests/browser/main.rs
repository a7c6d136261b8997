//! The report as its reader sees it, in a browser. Where there is no browser, and none can be installed,
//! these tests report this and count as ignored.

mod bench;
mod chromium;
#[allow(dead_code)]
#[path = "../all/common/mod.rs"]
mod common;
mod devtools;
mod explore;
mod exports;
mod handle;
mod keyboard;
mod scene_page;
mod screenshot;
mod serve;
mod verdict_page;

use std::path::Path;
use std::process::ExitCode;

use base64::Engine;
use libtest_mimic::{Arguments, Trial};
use serde_json::Value;

use self::common::{MOTION, WALL, report};

const MEASURE: &str = include_str!("measure.js");

/// Each test with its name.
const TESTS: [(&str, fn()); 25] = [
    ("nothing_is_missing_cut_off_or_in_the_way", nothing_is_missing_cut_off_or_in_the_way),
    ("the_measurement_finds_what_it_looks_for", the_measurement_finds_what_it_looks_for),
    (
        "the_numbers_of_the_page_are_those_of_the_program",
        explore::the_numbers_of_the_page_are_those_of_the_program,
    ),
    ("the_root_says_the_verdict_for_programs", explore::the_root_says_the_verdict_for_programs),
    (
        "the_handle_of_the_page_runs_the_servo_of_the_program",
        handle::the_handle_of_the_page_runs_the_servo_of_the_program,
    ),
    (
        "a_refused_handle_has_no_torque_until_the_check_is_off",
        handle::a_refused_handle_has_no_torque_until_the_check_is_off,
    ),
    (
        "a_board_is_watched_tuned_armed_and_recorded",
        serve::a_board_is_watched_tuned_armed_and_recorded,
    ),
    (
        "a_link_is_lost_and_back_and_a_second_page_is_refused",
        serve::a_link_is_lost_and_back_and_a_second_page_is_refused,
    ),
    ("a_foreign_page_does_not_reach_the_board", serve::a_foreign_page_does_not_reach_the_board),
    ("a_virtual_board_is_watched_and_armed", serve::a_virtual_board_is_watched_and_armed),
    (
        "a_field_changes_the_verdict_and_a_remedy_certifies",
        scene_page::a_field_changes_the_verdict_and_a_remedy_certifies,
    ),
    (
        "a_link_is_the_scene_and_a_bad_one_is_named",
        scene_page::a_link_is_the_scene_and_a_bad_one_is_named,
    ),
    (
        "a_narrow_page_is_not_cut_off_and_every_field_has_a_label",
        scene_page::a_narrow_page_is_not_cut_off_and_every_field_has_a_label,
    ),
    ("the_map_is_drawn_and_moves_the_scene", scene_page::the_map_is_drawn_and_moves_the_scene),
    (
        "the_rows_of_the_page_are_those_of_the_program",
        verdict_page::the_rows_of_the_page_are_those_of_the_program,
    ),
    (
        "each_preset_is_certified_where_it_should_be",
        verdict_page::each_preset_is_certified_where_it_should_be,
    ),
    (
        "what_the_page_exports_is_the_scene_to_the_bit",
        exports::what_the_page_exports_is_the_scene_to_the_bit,
    ),
    (
        "each_picture_is_saved_as_a_png_of_its_size",
        exports::each_picture_is_saved_as_a_png_of_its_size,
    ),
    (
        "a_copied_link_is_the_scene_and_has_no_token",
        exports::a_copied_link_is_the_scene_and_has_no_token,
    ),
    (
        "the_page_is_operated_by_its_keyboard_in_light_and_dark",
        keyboard::the_page_is_operated_by_its_keyboard_in_light_and_dark,
    ),
    (
        "the_readme_opens_with_the_page_of_today",
        screenshot::the_readme_opens_with_the_page_of_today,
    ),
    ("each_figure_of_the_page_has_its_reference", bench::each_figure_of_the_page_has_its_reference),
    ("without_a_browser_no_page_is_measured", bench::without_a_browser_no_page_is_measured),
    ("what_goes_wrong_on_a_page_is_an_error", bench::what_goes_wrong_on_a_page_is_an_error),
    ("without_a_browser_these_tests_are_ignored", without_a_browser_these_tests_are_ignored),
];

fn main() -> ExitCode {
    let arguments = Arguments::from_args();
    // A list of the tests, or other tests, need no browser.
    let wanted = |name: &str| arguments.filter.as_ref().is_none_or(|part| name.contains(part));
    let looks = !arguments.list && TESTS.iter().any(|(name, _)| wanted(name));
    let missing = looks.then(chromium::set_up).and_then(Result::err);
    if let Some(why) = &missing {
        eprintln!("skipped: tests/browser looks at pages with chromium: {why}");
    }
    let trial = |(name, test): (&str, fn())| {
        let run = move || {
            test();
            Ok(())
        };
        let trial = Trial::test(name, run).with_ignored_flag(missing.is_some());
        if missing.is_some() { trial.with_kind("no chromium") } else { trial }
    };
    libtest_mimic::run(&arguments, TESTS.map(trial).into()).exit_code()
}

/// The measurements of a browser on a page, in a window of this width in pixels.
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

/// They do not count as passed: runs this program again, with a path that has no programs.
fn without_a_browser_these_tests_are_ignored() {
    let this = std::env::current_exe().unwrap();
    let run = std::process::Command::new(this).env("PATH", "/nowhere").output().unwrap();
    assert!(run.status.success(), "{run:?}");
    let (shown, said) =
        (String::from_utf8(run.stdout).unwrap(), String::from_utf8(run.stderr).unwrap());
    assert_eq!(shown.matches("test [no chromium] ").count(), TESTS.len(), "{shown}");
    let all = format!("0 passed; 0 failed; {} ignored", TESTS.len());
    assert!(shown.contains(&all), "{shown}");
    assert!(said.contains("skipped: ") && said.contains("apt install chromium"), "{said}");
}
