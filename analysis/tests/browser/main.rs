//! The page as its reader sees it, in a browser. Where there is no browser, and none can be installed,
//! these tests report this and count as ignored; see `ignorable.rs`.

#[allow(dead_code)]
#[path = "../all/common/mod.rs"]
mod common;
mod devtools;
mod explore;
mod exports;
mod handle;
mod ignorable;
mod keyboard;
mod picture;
mod scene_page;
mod screenshot;
mod serve;
mod verdict_page;

use std::process::ExitCode;

use analysis::toolchain::set_up_tool;

use devtools::NAME;

macro_rules! tests {
    ($($module:ident::$test:ident)*) => {
        vec![
            $((stringify!($test), $module::$test as fn())),*,
            ("without_a_browser_these_tests_are_ignored", ignored_without_a_browser as fn()),
        ]
    };
}

/// Each test with its name.
fn all() -> Vec<(&'static str, fn())> {
    tests! {
        explore::the_numbers_of_the_page_are_those_of_the_program
        scene_page::on_paper_there_is_nothing_to_operate
        explore::the_root_says_the_verdict_for_programs
        handle::the_handle_of_the_page_runs_the_servo_of_the_program
        handle::the_encoder_of_the_handle_is_exchanged
        handle::a_refused_handle_has_no_torque_until_the_check_is_off
        handle::a_hostile_host_gives_its_budget_and_without_a_tank_more
        serve::a_board_is_watched_tuned_armed_and_recorded
        serve::a_link_is_lost_and_back_and_a_second_page_is_refused
        serve::a_foreign_page_does_not_reach_the_board
        serve::a_virtual_board_is_watched_and_armed
        scene_page::a_field_changes_the_verdict_and_a_remedy_certifies
        scene_page::a_link_is_the_scene_and_a_bad_one_is_named
        scene_page::a_narrow_page_is_not_cut_off_and_every_field_has_a_label
        scene_page::the_map_is_drawn_and_moves_the_scene
        verdict_page::the_rows_of_the_page_are_those_of_the_program
        verdict_page::each_preset_is_certified_where_it_should_be
        exports::what_the_page_exports_is_the_scene_to_the_bit
        exports::each_picture_is_saved_as_a_png_of_its_size
        exports::a_copied_link_is_the_scene_and_has_no_token
        keyboard::the_page_is_operated_by_its_keyboard_in_light_and_dark
        screenshot::the_readme_opens_with_the_page_of_today
    }
}

const KIND: &str = "no chromium";

fn main() -> ExitCode {
    let what = "tests/browser looks at pages with chromium";
    ignorable::run(KIND, what, 1, all(), || set_up_tool(NAME))
}

fn ignored_without_a_browser() {
    ignorable::assert_ignored_without_tools(KIND, all().len(), "chromium");
}
