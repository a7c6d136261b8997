//! Torque profiles: scene files that have them, and the commands that take such a file.

use std::f64::consts::TAU;

use crate::common::{answer, haptic_reading, program};
use analysis::file::{self, FileError, Format, Purpose, SceneFile, parse_for, write};
use haptic_servo::environment::{Ends, Profile};
use haptic_servo::parameter::Parameter;

const HEAD: &str = "name = \"knob\"\n[device]\ninertia = 2.2e-5\ndamping = 0.022\n[servo]\n\
                    period = 0.001\n[coupling]\nstiffness = 44.0\n";

/// The first line of `[environment]`, below the head.
const FIRST: usize = 9;

fn text(environment: &str) -> String {
    format!("{HEAD}[environment]\ntype = \"profile\"\n{environment}")
}

fn read(environment: &str) -> Result<SceneFile, FileError> {
    file::parse("knob.toml", Format::Toml, &text(environment))
}

fn profile(environment: &str) -> Profile {
    let file = read(environment).unwrap_or_else(|error| panic!("{error}\n{environment}"));
    *file.scene.environment.profile().unwrap()
}

fn shape(name: &str, keys: &str) -> String {
    format!("[[environment.shape]]\ntype = \"{name}\"\n{keys}\n")
}

const DETENTS: &str =
    "delay = 1\n[[environment.shape]]\ntype = \"detents\"\ncount = 24\ntorque = 0.05\n";
const KNOTS: &str = "delay = 1\nknots = [[0.0, 0.0], [0.1, 0.02], [0.3, -0.02], [0.4, 0.0]]\n";
const STOPS: &str = "from = -1.0\nto = 1.5\nstiffness = 4.0\n";

#[test]
fn shapes_add_up_to_one_table() {
    let detents = profile(DETENTS);
    assert_eq!((detents.count, detents.torque, detents.ends), (24.0, 0.05, None));
    assert_eq!((detents.delay, detents.damping, detents.units().len()), (1, None, 16));
    let stops = shape("end_stops", "from = -2\nto = 2\nstiffness = 15");
    let knob = profile(&format!("damping = 1e-4\n{DETENTS}{stops}"));
    assert_eq!(knob.ends, Some(Ends { from: -2.0, to: 2.0, stiffness: 15.0 }));
    assert_eq!((knob.count, knob.damping, knob.outline().wraps), (24.0, Some(1e-4), true));
    // The keys of the environment override those of the shapes.
    let keys = format!("torque = 0.02\ncount = 30\ncentre = 0.1\nto = 1.5\n{DETENTS}{stops}");
    let changed = profile(&keys);
    assert_eq!((changed.torque, changed.count, changed.centre), (0.02, 30.0, 0.1));
    assert_eq!(changed.ends, Some(Ends { from: -2.0, to: 1.5, stiffness: 15.0 }));
    assert_eq!(profile(&format!("{STOPS}{DETENTS}")).ends.unwrap().to, 1.5);
    for (name, keys) in [
        ("centre", "width = 0.3\nstiffness = 2"),
        ("bistable", "distance = 0.3\ntorque = 0.1"),
        ("texture", "pitch = 0.05\namplitude = 0.003"),
        ("magnet", "angle = 0.5\nwidth = 0.2\ntorque = 0.1"),
        ("table", "knots = [[-1, 0.1], [0, -0.1], [1, 0.1]]"),
        ("table", "knots = [[0, 0], [0.1, 0.1], [0.3, -0.1], [0.4, 0]]\nperiod = 0.4"),
    ] {
        let alone = profile(&format!("delay = 0\n{STOPS}{}", shape(name, keys)));
        assert!(alone.torque > 0.0, "{name}");
        let beside = profile(&format!("{STOPS}{DETENTS}{}", shape(name, keys)));
        assert!(beside.torque > 0.05, "{name}");
    }
}

/// The smallest power of two whose cells are at most half as wide as the narrowest piece.
#[test]
fn a_table_has_as_many_cells_as_show_every_piece() {
    let cells = |environment: &str| profile(environment).units().len();
    let table = |n: usize| {
        let step = TAU / 8.0 / n as f64;
        let knots = (0..=n).map(|i| {
            format!("[{:?}, {}]", i as f64 * step, ((i % n) as f64 * TAU / n as f64).sin())
        });
        format!(
            "delay = 1\nknots = [{}]\nperiod = {:?}\n",
            knots.collect::<Vec<_>>().join(", "),
            TAU / 8.0
        )
    };
    assert_eq!([8, 9, 16, 17, 100].map(|n| cells(&table(n))), [16, 32, 32, 64, 256]);
    assert_eq!(cells(&format!("cells = 64\n{DETENTS}")), 64);
    // A texture of 40 ridges in the range: an eighth of one, in 2.5 rad.
    let texture = shape("texture", "pitch = 0.0625\namplitude = 0.01");
    assert_eq!(cells(&format!("delay = 1\n{STOPS}{texture}")), 512);
}

#[test]
fn what_is_written_reads_back_as_the_same_scene() {
    let again = |file: &SceneFile| {
        let written = write::toml(file);
        parse_for(Purpose::Simulate, "b.toml", Format::Toml, &written)
            .unwrap_or_else(|error| panic!("{error}\n{written}"))
    };
    let stops = shape("end_stops", "from = -2.1\nto = 2\nstiffness = 15");
    for environment in [
        DETENTS.to_owned(),
        format!("damping = 0.001\ncells = 128\n{DETENTS}{stops}"),
        format!("torque = 0.3\ncount = 7\ncentre = -0.0\n{DETENTS}"),
        format!("stiffness = 3.0000000000000004\n{DETENTS}{stops}"),
        format!("period = 0.4\n{STOPS}{KNOTS}"),
        format!("{STOPS}{KNOTS}"),
        format!("{STOPS}{KNOTS}{}", shape("magnet", "width = 0.2\ntorque = 0.1")),
        format!("delay = 2\n{}{stops}", shape("table", "knots = [[-1, 0.1], [1, 0.1]]")),
        format!("delay = 0\n{}", shape("bistable", "distance = 0.3\ntorque = 0.1")),
        format!("delay = 0\n{}", shape("centre", "width = 0.3\nstiffness = 0.1")),
        format!("delay = 0\n{STOPS}{}", shape("texture", "pitch = 0.1\namplitude = 0.01")),
    ] {
        let file = read(&environment).unwrap_or_else(|error| panic!("{error}\n{environment}"));
        assert_eq!(again(&file), file, "{environment}");
        // A design changes the scene beside its shapes.
        for parameter in [Parameter::ProfileTorque, Parameter::Stiffness, Parameter::Damping] {
            let Some(value) = file.scene.get(parameter) else { continue };
            let scene = file.scene.with(parameter, value * 0.7 + 1e-5).unwrap();
            let changed = SceneFile { scene, ..file.clone() };
            assert_eq!(again(&changed).scene, scene, "{environment}");
        }
    }
    let json = r#"{"name": "knob", "device": {"inertia": 2.2e-5, "damping": 0.022},
        "servo": {"period": 0.001}, "coupling": {"stiffness": 44}, "environment": {"type": "profile",
        "delay": 1, "shape": [{"type": "detents", "count": 24, "torque": 0.05}]}}"#;
    assert_eq!(file::parse("knob.json", Format::Json, json).unwrap(), read(DETENTS).unwrap());
}

/// The message for a bad profile: the line below `[environment]`, and the words.
fn refused(environment: &str, line: usize, words: &[&str]) {
    let message = read(environment).expect_err(environment).to_string();
    // In line 0 is the table itself.
    let place = format!("knob.toml:{}:", FIRST + line + usize::from(line > 0));
    assert!(message.starts_with(&place), "{place}: {message}");
    assert!(!message.contains('\n'), "{message}");
    for word in words {
        assert!(message.contains(word), "{word:?} is not in {message:?}");
    }
}

#[test]
fn bad_knots_are_named_with_index_value_and_bound() {
    let knots = |knots: &str, words: &[&str]| {
        refused(&format!("delay = 1\nknots = {knots}\n{STOPS}"), 2, words);
        let table = shape("table", &format!("knots = {knots}"));
        let words = words
            .iter()
            .map(|word| word.replace("environment.knots", "environment.shape[0].knots"));
        let words: Vec<String> = words.collect();
        let words: Vec<&str> = words.iter().map(String::as_str).collect();
        refused(&format!("delay = 1\n{STOPS}{table}"), 7, &words);
    };
    let order = "above the angle of the knot before, which is 0.3";
    knots("[[0, 0], [0.3, 1], [0.1, 0]]", &["`environment.knots[2][0]` = 0.1", order]);
    knots("[[0, 0], [0.3, 1], [0.3, 0]]", &["`environment.knots[2][0]` = 0.3", order]);
    let finite = "a finite number";
    knots("[[0, 0.0], [nan, 1.0]]", &["`environment.knots[1][0]` = nan", finite]);
    knots("[[0, 0.0], [1.0, -inf]]", &["`environment.knots[1][1]` = -inf", finite]);
    knots("[[0, 0.0], [1.0, 1e9]]", &["`environment.knots[1][1]` = 1e9", "up to a million"]);
    knots(
        "[[0, 0], [1]]",
        &["`environment.knots[1]` = [1]", "another length", "[angle in rad, torque in N m]"],
    );
    knots("[[0, 0], 3]", &["`environment.knots[1]` = 3 is a number", "pair"]);
    knots("[[0, \"a\"], [1, 2]]", &["`environment.knots[0][1]` = \"a\" is a string", finite]);
    knots("[[0, 0]]", &["`environment.knots` = [[0, 0]] are 1 knots", "2 to 2048"]);
    let many = (0..2049).map(|i| format!("[{i}, 0]")).collect::<Vec<_>>().join(",");
    knots(&format!("[{many}]"), &["are 2049 knots", "2 to 2048"]);
    knots("true", &["`environment.knots` = true", "a list of 2 to 2048 pairs"]);
}

#[test]
fn a_period_that_does_not_close_is_named() {
    let periodic = |knots: &str, period: &str, line: usize, words: &[&str]| {
        refused(&format!("delay = 1\nknots = {knots}\nperiod = {period}\n"), line, words);
    };
    let good = "[[0.0, 0.0], [0.1, 0.1], [0.3, -0.1], [0.4, 0.0]]";
    let last = "`environment.knots[3][0]` = 0.4";
    periodic(good, "0.5", 2, &[last, "0.5, where the period of 0.5 rad ends"]);
    let open = "[[0.0, 0.0], [0.1, 0.1], [0.3, -0.1], [0.4, 0.02]]";
    periodic(open, "0.4", 2, &["`environment.knots[3][1]` = 0.02", "closes the period: 0"]);
    periodic(good, "0.4", 2, &["`environment`", "end stops"]);
    periodic(good, "-0.4", 3, &["`environment.period` = -0.4", "greater than 0"]);
    let motor = "[[0.0, 0.0], [0.1, 0.1], [0.3, -0.05], [0.39269908169872414, 0.0]]";
    periodic(motor, "0.39269908169872414", 2, &["`environment.knots`", "mean", "must be 0"]);
    refused(
        &format!("delay = 1\nperiod = 1\n{STOPS}"),
        2,
        &["`environment.period` = 1", "`environment.knots`"],
    );
    refused("delay = 1\nknots = [[0, 0], [1, 0.1]]\n", 2, &["`environment`", "needs end stops"]);
}

#[test]
fn bad_shapes_are_named_with_index_value_and_bound() {
    let second = |name: &str, keys: &str, line: usize, words: &[&str]| {
        refused(&format!("{DETENTS}{}", shape(name, keys)), 5 + line, words);
    };
    second(
        "detent",
        "count = 3\ntorque = 1",
        2,
        &["`environment.shape[1].type` = \"detent\"", "\"detents\", \"end_stops\""],
    );
    second(
        "detents",
        "count = 2.5\ntorque = 1",
        3,
        &["`environment.shape[1].count` = 2.5", "whole number from 1 to 4096"],
    );
    second(
        "detents",
        "count = 4097\ntorque = 1",
        3,
        &["`environment.shape[1].count` = 4097", "from 1 to 4096"],
    );
    second(
        "detents",
        "count = 2\ntorque = -1",
        4,
        &["`environment.shape[1].torque` = -1", "greater than 0"],
    );
    second(
        "detents",
        "count = 2",
        1,
        &["`environment.shape[1].torque` is missing", "greater than 0"],
    );
    second("magnet", "torque = 2", 1, &["`environment.shape[1].width` is missing"]);
    second(
        "magnet",
        "torque = 2\nwidth = 4",
        4,
        &["`environment.shape[1].width` = 4", "half a turn"],
    );
    second(
        "texture",
        "pitch = 0.1\namplitude = nan",
        4,
        &["`environment.shape[1].amplitude` = nan"],
    );
    second(
        "end_stops",
        "from = 2\nto = 1\nstiffness = 1",
        3,
        &["`environment.shape[1].from` = 2", "below `to`"],
    );
    second(
        "centre",
        "width = 1\nstiffness = 1\ntorque = 3",
        5,
        &["`environment.shape[1].torque` is not a key of a centre"],
    );
    second(
        "bistable",
        "distance = \"a\"\ntorque = 1",
        3,
        &["`environment.shape[1].distance` = \"a\" is a string"],
    );
    second("table", "", 1, &["environment.shape[1].knots` is missing"]);
    second("texture", "pitch = 0.1\namplitude = 1", 2, &["`environment.shape[1]`", "end stops"]);
    refused("delay = 1\n", 0, &["`environment.shape` is missing"]);
    refused("delay = 1\nshape = []\n", 2, &["are 0 shapes", "1 to 16"]);
    let detent = "[[environment.shape]]\ntype = \"detents\"\ncount = 3\ntorque = 1\n";
    refused(&format!("delay = 1\n{}", detent.repeat(17)), 2, &["are 17 shapes", "1 to 16"]);
}

#[test]
fn bad_keys_of_the_environment_are_named() {
    refused(&DETENTS.replace("delay = 1\n", ""), 0, &["`environment.delay` is missing"]);
    refused(&format!("face = 1\n{DETENTS}"), 1, &["`environment.face` is not a key of a profile"]);
    refused(&format!("cells = 24\n{DETENTS}"), 1, &["`environment.cells` = 24", "16 and 32"]);
    refused(&format!("cells = 8\n{DETENTS}"), 1, &["`environment.cells` = 8", "from 16 to 4096"]);
    refused(&format!("from = 1\n{DETENTS}"), 0, &["`environment.to` is missing"]);
    refused(
        &format!("from = 1\nto = 0\nstiffness = 1\n{DETENTS}"),
        1,
        &["`environment.from` = 1", "below `to`"],
    );
    refused(
        &format!("from = 0\nto = 1\nstiffness = 0\n{DETENTS}"),
        3,
        &["`environment.stiffness` = 0", "greater than 0"],
    );
    let alone = shape("bistable", "distance = 0.3\ntorque = 0.1");
    refused(
        &format!("delay = 1\ncount = 3\n{alone}"),
        2,
        &["`environment.count` = 3", "do not repeat"],
    );
    let texture = shape("texture", "pitch = 0.001\namplitude = 0.01");
    refused(&format!("delay = 1\n{STOPS}{texture}"), 6, &["`environment.cells`", "16 to 4096"]);
    let narrow = "delay = 1\nknots = [[0, 0], [0.5, 0.1], [0.50001, 0.0], [1, 0]]\n";
    refused(
        &format!("{narrow}{STOPS}"),
        2,
        &["`environment.cells`: are 4096", "1e-5 rad from `environment.knots[1]` to [2], takes"],
    );
    refused(
        &format!("cells = 16\ndelay = 1\n{STOPS}{}", texture.replace("0.001", "0.1")),
        7,
        &["`environment.cells`: are 16"],
    );
}

#[test]
fn no_torque_is_beyond_the_dac() {
    let limits = "[limits]\nfull_scale = 0.1\n";
    let bound = "a torque of at most `limits.full_scale` = 0.1 N m";
    let strong = |environment: &str, line: usize, name: &str| {
        refused(&format!("{environment}{limits}"), line, &[name, bound]);
    };
    strong(&DETENTS.replace("0.05", "0.5"), 5, "`environment.shape[0].torque` = 0.5");
    strong(&format!("torque = 0.2\n{DETENTS}"), 1, "`environment.torque` = 0.2");
    let knots = "delay = 1\nknots = [[-1, 0.05], [0, -0.3], [1, 0]]\n";
    strong(&format!("{knots}{STOPS}"), 2, "`environment.knots[1][1]` = -0.3");
    let both =
        format!("{DETENTS}{}", shape("magnet", "width = 0.0654\ntorque = 0.09\nangle = 0.0"));
    strong(&both, 3, "`environment.shape`: the shapes add up to 0.10");
    assert!(read(&format!("{DETENTS}{limits}")).is_ok());
}

const TRAILER: &str = "[simulation]\nsamples = 300\nvelocity = 20.0\n[human]\ninertia = 1e-4\n\
                       damping = 0.02\n[limits]\nencoder_step = 0.0015339807878856412\nfull_scale = 5.0\n";

fn run(arguments: &[&str], environment: &str) -> std::process::Output {
    haptic_reading(arguments, format!("{}{TRAILER}", text(environment)).as_bytes())
}

#[test]
fn a_bad_file_has_exit_status_2_and_one_that_is_too_steep_1() {
    let status = |environment: &str| run(&["certify", "-"], environment).status.code();
    assert_eq!(status(DETENTS), Some(0));
    assert_eq!(status(&DETENTS.replace("0.05", "4")), Some(1));
    assert_eq!(status(&DETENTS.replace("0.05", "nan")), Some(2));
    assert_eq!(status("delay = 1\nknots = [[0, 0], [0, 1]]\n"), Some(2));
}

/// A turn has room for 65536 cells; a number that is out of range leaves nothing to compute.
#[test]
fn a_piece_that_is_too_narrow_for_a_table_is_refused_where_it_stands() {
    let step = |width: f64| {
        let knots = format!("[[-0.06, -5], [-{width}, -5], [0, 0], [0.06, 0]]");
        format!("delay = 1\nfrom = -0.06\nto = 0.06\nstiffness = 100\nknots = {knots}\n")
    };
    let refused = read(&step(1e-4)).unwrap_err().to_string();
    let said = "`environment.cells`: would be 4096 for the narrowest straight piece, 0.0001 rad from \
                `environment.knots[1]` to [2], or 214309 in a turn, and a turn has at most 65536: the \
                piece must be at least about 0.000235 rad wide";
    assert!(refused.contains(said), "{refused}");
    assert!(read(&step(2.4e-4)).is_ok());
    let often = run(&["certify", "-"], &format!("count = 5000\n{DETENTS}"));
    let text = String::from_utf8(often.stdout).unwrap();
    assert_eq!(often.status.code(), Some(1), "{text}");
    assert!(
        text.contains("repetitions in a turn is 5000, and must be") && text.contains("4096"),
        "{text}"
    );
    assert!(!text.contains("NaN") && !text.contains("alpha") && !text.contains("delta"), "{text}");
}

/// The keys of a wall's answer, and the remedies of a profile.
#[test]
fn the_answer_in_json_has_the_keys_of_every_scene() {
    let wall = haptic_reading(&["certify", "-", "--json"], crate::common::WALL.as_bytes());
    let steep = run(&["certify", "-", "--json"], &DETENTS.replace("0.05", "4"));
    let (wall, steep) = (answer(&wall), answer(&steep));
    let missing: Vec<_> =
        wall.as_object().unwrap().keys().filter(|key| steep.get(key).is_none()).collect();
    assert!(missing.is_empty(), "{missing:?}");
    assert_eq!(steep["verdict"], "rejected");
    // `2 pi K / (4 n)` and `2 pi K / (4 F)` behind 44 N m/rad: 2.87979 N m, and 17.2 a turn.
    let remedies = steep["remedies"].as_array().unwrap();
    assert!(remedies.iter().any(|it| it == "profile torque <= 2.87 N m"), "{remedies:?}");
    assert!(
        remedies.iter().any(|it| it == "number of repetitions in a turn <= 17"),
        "{remedies:?}"
    );
    let certified = answer(&run(&["certify", "-", "--json"], DETENTS));
    // Half a count of a 4096th turn times `M / (1 - M / 44)`.
    let slope = 4.0 * 24.0 * 0.05 / TAU;
    let expected = 0.5 * TAU / 4096.0 * slope / (1.0 - slope / 44.0);
    let found = certified["rest"]["encoder"].as_f64().unwrap();
    assert!((found / expected - 1.0).abs() < 1e-3, "{found} {expected}");
}

#[test]
fn a_design_says_the_most_torque_the_most_detents_and_the_longest_period() {
    let largest = |quantity: &str| {
        let arguments = ["design", "largest", quantity, "-", "--json"];
        answer(&run(&arguments, DETENTS))["value"].as_f64().unwrap()
    };
    assert!((largest("torque") / (44.0 * TAU / 96.0) - 1.0).abs() < 1e-3);
    assert_eq!(largest("count"), (44.0 * TAU / 0.2).floor());
    let longest = run(&["design", "period", "-", "--json"], DETENTS);
    let found = answer(&longest)["value"].as_f64().unwrap();
    // Behind the standard coupling `2 delta / T`, which has to be stiffer than the steepest rise.
    assert!((found / (0.044 / (4.0 * 24.0 * 0.05 / TAU)) - 1.0).abs() < 1e-3, "{found}");
    let lowest = answer(&run(&["design", "lowest", "rate", "-", "--json"], DETENTS));
    assert_eq!((&lowest["quantity"], &lowest["unit"]), (&"rate".into(), &"Hz".into()));
    let rate = lowest["value"].as_f64().unwrap();
    // A scene of this very rate certifies, and of the next number below does not.
    let judge = |rate: f64| {
        let scene = text(DETENTS).replace("period = 0.001", &format!("period = {:?}", 1.0 / rate));
        let scene = scene.replace("44.0", &format!("{:?}", 0.044 * rate));
        haptic_reading(&["certify", "-"], scene.as_bytes()).status.code()
    };
    assert_eq!((judge(rate), judge(rate * (1.0 - 1e-9))), (Some(0), Some(1)), "{rate}");
    assert!((rate * found - 1.0).abs() < 1e-12, "{rate} {found}");
    let border = run(&["design", "border", "count", "torque", "-", "--points", "4"], DETENTS);
    let text = String::from_utf8(border.stdout).unwrap();
    let rows: Vec<(f64, f64)> = text
        .lines()
        .skip(1)
        .map(|line| {
            let (count, torque) = line.split_once(',').unwrap();
            (count.parse().unwrap(), torque.parse().unwrap())
        })
        .collect();
    assert_eq!(rows.len(), 4, "{text}");
    for (count, torque) in rows {
        assert!((torque * 4.0 * count / TAU / 44.0 - 1.0).abs() < 1e-3, "{text}");
    }
    let alone = shape("bistable", "distance = 0.3\ntorque = 0.1");
    let none = run(&["design", "largest", "count", "-"], &format!("delay = 1\n{alone}"));
    assert_eq!(none.status.code(), Some(2), "{none:?}");
}

/// A type of scene whose instructions no board has counted is reported as such.
#[test]
fn advice_about_a_profile_has_no_infinite_numbers() {
    let stops = shape("end_stops", "from = -2\nto = 2\nstiffness = 15");
    for (damping, known) in [("", true), ("damping = 0.001\n", false)] {
        let question = ["advise", "-", "--max-limit-cycle", "0.5", "--rate", "1000"];
        let advised = run(&question, &format!("{damping}{DETENTS}{stops}"));
        let text = String::from_utf8(advised.stdout).unwrap();
        assert!(!text.contains("inf") && !text.contains("none %"), "{text}");
        let is_unknown = text.contains("instructions of its tick are not known");
        assert_eq!(
            (advised.status.code(), is_unknown),
            (Some(i32::from(!known)), !known),
            "{text}"
        );
    }
}

/// Nothing panics, and if there is no answer, the sentence gives the reason.
#[test]
fn every_command_answers_or_says_why_not() {
    let folder = tempfile::tempdir().unwrap();
    let stops = shape("end_stops", "from = -2\nto = 2\nstiffness = 15");
    let bistable = shape("bistable", "distance = 0.3\ntorque = 0.1");
    let scenes = [
        DETENTS.to_owned(),
        DETENTS.replace("delay = 1", "delay = 0"),
        format!("damping = 0.001\n{DETENTS}{stops}"),
        format!("delay = 1\n{bistable}"),
        DETENTS.replace("0.05", "4"),
    ];
    let why = [
        "no transfer function",
        "no wall",
        "does not repeat",
        "as a tick",
        "rejected",
        "no delay",
        "tick",
    ];
    for (number, environment) in scenes.iter().enumerate() {
        let file = folder.path().join(format!("{number}.toml"));
        std::fs::write(&file, format!("{}{TRAILER}", text(environment))).unwrap();
        let name = file.to_str().unwrap();
        let commands: [&[&str]; 13] = [
            &["certify", name, "--format", "f32"],
            &["simulate", name],
            &["simulate", name, "--json"],
            &["stability", name],
            &["worst-hand", name],
            &["device", name],
            &["run", name, "--ticks", "200"],
            &["chart", "profile", name, "-o", "profile.svg"],
            &["chart", "map", name, "-o", "map.svg"],
            &["chart", "trace", name, "-o", "trace.svg"],
            &["chart", "nyquist", name, "-o", "nyquist.svg"],
            &["chart", "bode", name, "-o", "bode.svg"],
            &["advise", name, "--model"],
        ];
        for arguments in commands {
            let run = program(arguments).current_dir(folder.path()).output().unwrap();
            let said = String::from_utf8_lossy(&run.stderr).into_owned();
            assert!(!said.contains("panicked"), "{arguments:?}: {said}");
            match run.status.code() {
                Some(0 | 1) => {}
                Some(2) => {
                    assert!(why.iter().any(|why| said.contains(why)), "{arguments:?}: {said}")
                }
                other => panic!("{arguments:?}: {other:?} {said}"),
            }
        }
        let drawn = std::fs::read_to_string(folder.path().join("profile.svg")).unwrap();
        for word in ["torque (N m)", "potential (mJ)", "steepest rise", "certifies"] {
            assert!(drawn.contains(word), "{word}");
        }
    }
    let map = std::fs::read_to_string(folder.path().join("map.svg")).unwrap();
    for word in ["repetitions in a turn", "torque (N m)", "delay of 2", "the scene"] {
        assert!(map.contains(word), "{word}");
    }
    // A wall has no profile.
    let wall = folder.path().join("wall.toml");
    std::fs::write(&wall, crate::common::WALL).unwrap();
    let drawn = program(&["chart", "profile"]).arg(&wall).args(["-o", "x.svg"]).output().unwrap();
    assert_eq!(drawn.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&drawn.stderr).contains("not a torque profile"), "{drawn:?}");
    let count = program(&["design", "largest", "count"]).arg(&wall).output().unwrap();
    assert_eq!(count.status.code(), Some(2));
}

/// Without a coupling there is no bound for a profile where updates are missed and two lags follow each
/// other; the message names the remedy.
#[test]
fn a_profile_without_a_bound_is_undecided_by_every_rule() {
    let lagging = text(DETENTS)
        .replace("damping = 0.022", "damping = 0.022\nactuator_lag = 1e-4\nsensor_lag = 2e-4")
        .replace("period = 0.001", "period = 0.001\nworst_period = 0.002")
        .replace("[coupling]\nstiffness = 44.0\n", "");
    let judged = haptic_reading(&["certify", "-", "--json"], lagging.as_bytes());
    assert_eq!(judged.status.code(), Some(1));
    let judged = answer(&judged);
    assert_eq!(judged["verdict"], "undecided");
    assert_eq!(judged["rules"], serde_json::json!({"paper": "undecided", "exact": "undecided"}));
    assert_eq!(judged["alpha"], serde_json::json!({"lo": null, "hi": null}));
    let message = judged["message"].as_str().unwrap();
    assert!(
        message.contains("without a coupling no bound") && message.contains("matched coupling"),
        "{message}"
    );
}
