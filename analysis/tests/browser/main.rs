//! The page as its reader sees it, in a browser. Where there is no browser, and none can be installed,
//! these tests report this and count as ignored. All but the first are also ignored, unless they are asked for
//! by a part of a name or `--include-ignored`.

mod bench;
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

use std::process::ExitCode;

use analysis::browser::NAME;
use analysis::toolchain::set_up_tool;
use libtest_mimic::{Arguments, Completion, Trial};

/// Each test with its name.
const TESTS: [(&str, fn()); 24] = [
    (
        "the_numbers_of_the_page_are_those_of_the_program",
        explore::the_numbers_of_the_page_are_those_of_the_program,
    ),
    ("on_paper_there_is_nothing_to_operate", scene_page::on_paper_there_is_nothing_to_operate),
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
    let missing = looks.then(|| set_up_tool(NAME)).and_then(Result::err);
    if let Some(why) = &missing {
        eprintln!("skipped: tests/browser looks at pages with chromium: {why}");
    }
    let trial = |(name, test): (&str, fn())| {
        let is_missing = missing.is_some();
        let run = move || {
            if is_missing {
                return Ok(Completion::ignored());
            }
            test();
            Ok(Completion::Completed)
        };
        let is_wanted = arguments.filter.is_some() || name == TESTS[0].0;
        let trial = Trial::ignorable_test(name, run).with_ignored_flag(is_missing || !is_wanted);
        if is_missing { trial.with_kind("no chromium") } else { trial }
    };
    libtest_mimic::run(&arguments, TESTS.map(trial).into()).exit_code()
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
