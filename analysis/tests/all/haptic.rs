//! The program as a process: exit status, standard output, standard error.

use std::io::{Read, Write};
use std::process::{Output, Stdio};

use nalgebra::Complex;

use crate::common::{complaint, haptic_reading as haptic, program};
use serde_json::Value;

const WALL: &str = r#"{"name": "wall", "device": {"inertia": 2.2e-5, "damping": 0.022}, "servo": {"period": 0.001}, "coupling": {"stiffness": 44}, "environment": {"type": "damper-wall", "stiffness": 22, "damping": 0.01, "delay": 1}}"#;

fn lines(output: &Output) -> Vec<Value> {
    let text = String::from_utf8(output.stdout.clone()).unwrap();
    text.lines().map(|line| serde_json::from_str(line).unwrap()).collect()
}

#[test]
fn yes_no_and_a_bad_question_have_their_exit_status() {
    let status = |scene: &str| haptic(&["certify", "-"], scene.as_bytes()).status.code();
    assert_eq!(status(WALL), Some(0));
    assert_eq!(status(&WALL.replace("0.01", "0.02")), Some(1));
    // The wall at the line itself: never a yes.
    assert_eq!(status(&WALL.replace("\"stiffness\": 22", "\"stiffness\": 24")), Some(1));
    assert_eq!(status(&WALL.replace("0.001", "0")), Some(2));
    assert_eq!(status(""), Some(2));
    assert_eq!(haptic(&["certify", "no such file"], b"").status.code(), Some(2));
    assert_eq!(haptic(&["certify"], b"").status.code(), Some(2));
    assert_eq!(haptic(&["conjure"], b"").status.code(), Some(2));
}

/// A supply that takes nothing back and rises to its fault level is a negative verdict, with what would be enough.
#[test]
fn a_supply_that_rises_too_far_has_its_exit_status() {
    let supply = |capacitance: &str| {
        let scene = WALL.strip_suffix('}').expect("an object");
        format!(
            r#"{scene}, "limits": {{"torque": 1}}, "supply": {{"voltage": 24, "fault_voltage": 25.2,
            "capacitance": {capacitance}, "largest_speed": 25}}}}"#
        )
    };
    for (capacitance, status, stays) in [("1e-3", Some(1), false), ("1e-2", Some(0), true)] {
        let text = supply(capacitance);
        let output = haptic(&["certify", "--json", "-"], text.as_bytes());
        assert_eq!(output.status.code(), status);
        let report = &lines(&output)[0];
        assert_eq!(report["verdict"], "certified");
        assert_eq!(report["supply"]["stays_below"], stays, "{report}");
    }
    let output = haptic(&["certify", "-"], supply("1e-3").as_bytes());
    let said = String::from_utf8(output.stdout).unwrap();
    for part in
        ["take at least", "a supply of at most", "a torque limit of at most", "brake resistor"]
    {
        assert!(said.contains(part), "{part}: {said}");
    }
    let said = complaint(haptic(&["certify", "-"], supply("-1.0").as_bytes()));
    assert!(said.contains("`supply.capacitance` = -1.0 is out of bounds"), "{said}");
}

/// The program with a standard output that takes nothing, opened by a shell.
fn status_into(output: &str, arguments: &[&str]) -> Option<i32> {
    let words = format!("exec \"$@\" {output}");
    let mut shell = std::process::Command::new("sh");
    shell.args(["-c", &words, "sh", env!("CARGO_BIN_EXE_haptic")]).args(arguments);
    let output = shell.stdin(Stdio::null()).stderr(Stdio::piped()).output().unwrap();
    assert_eq!(output.status.code() == Some(2), !output.stderr.is_empty(), "{output:?}");
    output.status.code()
}

#[test]
fn an_answer_that_cannot_be_written_is_a_failure() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("wall.json");
    std::fs::write(&path, WALL).unwrap();
    let wall = path.to_str().unwrap();
    let kept = concat!(env!("CARGO_MANIFEST_DIR"), "/pictures/tradeoff");
    let picture = folder.path().join("a.svg");
    let picture = ["--picture", picture.to_str().unwrap(), "-o", kept];
    for arguments in [
        &["--help"][..],
        &["--version"],
        &["chart", "map", "--help"],
        &["certify", wall],
        &["certify", "--json", wall],
        &["stability", wall],
        &["schema"],
        &["schema", "--reference"],
        &["schema", "--example", "damper-wall"],
        &["run", "damper_wall", "--csv"],
        &[&["chart", "tradeoff", "servo", "--draw-only"][..], &picture].concat(),
    ] {
        for (output, status) in [(">/dev/full", 2), (">/dev/null", 0)] {
            assert_eq!(status_into(output, arguments), Some(status), "{arguments:?} {output}");
        }
    }
}

/// Next to the line a number and its coefficient in fixed point lie on different sides of it.
#[test]
fn coefficients_are_judged_as_a_format_rounds_them() {
    let judge = |text: &str, format: &str| {
        let output = haptic(&["certify", "--json", "--format", format, "-"], text.as_bytes());
        let [answer] = &lines(&output)[..] else { panic!("one object") };
        assert_eq!(answer["verdict"] == "certified", output.status.code() == Some(0));
        (answer["verdict"].clone(), answer["message"].as_str().unwrap().to_owned())
    };
    // A coupling that is rounded to be softer leaves less than K T / 2 of a spring needs.
    let spring = crate::common::WALL
        .replace("damper-wall", "delayed-spring")
        .replace("damping = 0.01\n", "")
        .replace("stiffness = 22.0", "stiffness = 43.99999978");
    assert_eq!(judge(&spring, "f64").0, "certified");
    let (verdict, message) = judge(&spring, "I16F16");
    assert_eq!(verdict, "rejected");
    assert!(
        message.starts_with("with its coefficients rounded to Q16.16: rejected: "),
        "{message}"
    );
    // Without a coupling 3/2 K T may be used up; the stiffness is rounded to below that.
    let rigid = spring
        .replace("[coupling]\nstiffness = 44.0\n", "")
        .replace("43.99999978", "14.6666666674");
    assert_eq!(judge(&rigid, "f64").0, "rejected");
    assert_eq!(judge(&rigid, "q16.16").0, "certified");

    let refused = |text: &str, format: &str, words: &[&str]| {
        let output = haptic(&["certify", "--format", format, "-"], text.as_bytes());
        assert_eq!(output.status.code(), Some(2));
        let said = String::from_utf8(output.stderr).unwrap();
        assert!(words.iter().all(|word| said.contains(word)), "{said}");
    };
    refused(crate::common::WALL, "i16f17", &["i16f17", "i8f24"]);
    let strong = format!("{}[limits]\ntorque = 1.5\n", crate::common::WALL);
    refused(&strong, "i1f31", &["limits.torque", "1.5", "Q1.31"]);
}

/// Other properties of the machine decide whether it comes to rest; a failed check is a warning.
#[test]
fn steps_are_held_against_friction() {
    let judge = |friction: &str, limits: &str| {
        let scene = crate::common::WALL.replace("[servo]", &format!("{friction}\n[servo]"));
        let scene = format!("{scene}[limits]\n{limits}\n");
        let output = haptic(&["certify", "--json", "-"], scene.as_bytes());
        let [answer] = &lines(&output)[..] else { panic!("one object") };
        answer.clone()
    };
    let steps = "encoder_step = 1e-4\nfull_scale = 1.791";
    let said = judge("", steps);
    // The paper's wall makes at most 924 N m of 1 rad, and half of each step is an error.
    let hum = 0.5e-4 * 924.0 + 0.5e-3;
    assert!((said["rest"]["hum"].as_f64().unwrap() / hum - 1.0).abs() < 1e-9);
    let message = said["message"].as_str().unwrap();
    let unless = "at rest errors of torque of up to 0.0468 N m make a limit cycle possible unless the device has \
         0.0468 N m of Coulomb friction";
    assert!(message.ends_with(unless), "{message}");
    assert!(said["rest"]["comes_to_rest"].is_null() && said.get("warnings").is_none());
    assert_eq!(judge("friction = 0.0468", steps)["rest"]["comes_to_rest"], true);
    let weak = judge("friction = 0.0467", steps);
    assert_eq!(weak["rest"]["comes_to_rest"], false);
    let warning = weak["warnings"][0].as_str().unwrap();
    assert!(warning.contains("0.0467 N m is lower") && warning.contains("(DAC)"), "{warning}");
    // A number that is not stated is not judged, and the assumption states that.
    let some = judge("friction = 0.05", "encoder_step = 1e-4");
    assert!(some["rest"]["comes_to_rest"].is_null());
    let assumptions = some["assumptions"].to_string();
    assert!(assumptions.contains("the step of the DAC is not stated"), "{assumptions}");
    // There is no current loop, so that no number of it is missing.
    assert!(!assumptions.contains("current loop"), "{assumptions}");
    let strong = judge("", "torque = 3.0\nfull_scale = 2.0");
    assert!(strong["warnings"][0].as_str().unwrap().contains("full scale of 2 N m"));
}

#[test]
fn json_has_the_fields_of_the_contract_and_nothing_else_is_printed() {
    let output = haptic(&["certify", "--json", "-"], WALL.as_bytes());
    assert!(output.stderr.is_empty());
    let [answer] = &lines(&output)[..] else { panic!("one object") };
    let keys = answer.as_object().unwrap().keys().map(String::as_str).collect::<Vec<_>>();
    let mut fields = [
        "name",
        "verdict",
        "rules",
        "reason",
        "alpha",
        "alpha_coupled",
        "delta",
        "margin",
        "theta",
        "assumptions",
        "message",
        "remedies",
    ];
    fields.sort_unstable();
    assert_eq!(keys, fields);
    assert_eq!(answer["verdict"], "certified");
    assert_eq!(answer["rules"], serde_json::json!({"paper": "pass", "exact": "pass"}));
    assert_eq!(answer["reason"], "ok");
    assert_eq!(answer["delta"], 0.022);
    let alpha = |end: &str| answer["alpha"][end].as_f64().unwrap();
    assert!(alpha("lo") <= 0.021 && 0.021 <= alpha("hi") && alpha("hi") - alpha("lo") < 1e-14);
    assert!((answer["margin"].as_f64().unwrap() / margin_of_the_wall() - 1.0).abs() < 1e-6);
    assert!((answer["theta"].as_f64().unwrap() - std::f64::consts::PI).abs() < 1e-9);
    assert!(answer["assumptions"].as_array().unwrap().len() >= 3);
    assert_eq!(answer["remedies"], serde_json::json!([]));
}

#[test]
fn a_certified_scene_that_no_board_renders_says_why() {
    let late = WALL
        .replace("\"stiffness\": 22", "\"stiffness\": 15")
        .replace("0.01,", "0,")
        .replace("\"delay\": 1", "\"delay\": 2")
        .replace("44", "33");
    let undelayed = WALL.replace("\"delay\": 1", "\"delay\": 0");
    for (scene, why) in [(late, "never limited"), (undelayed, "not late by a whole sample")] {
        let output = haptic(&["certify", "--json", "-"], scene.as_bytes());
        assert_eq!(output.status.code(), Some(0), "{output:?}");
        let board = lines(&output)[0]["board"].as_str().unwrap().to_owned();
        assert!(board.contains(why), "{board}");
        let output = haptic(&["certify", "-"], scene.as_bytes());
        let text = String::from_utf8(output.stdout).unwrap();
        assert!(text.contains("not on a board") && text.contains(why), "{text}");
        assert!(!text.contains("margin on a board"), "{text}");
    }
}

/// A wall beyond a face, undelayed behind the matched coupling, with this output delay.
fn phased_wall(output_delay: &str) -> String {
    format!(
        r#"{{"name": "phased", "device": {{"inertia": 2.2e-5, "damping": 0.022, "actuator_lag": 5.3e-5}},
            "servo": {{"period": 0.001, "output_delay": {output_delay}, "output_jitter": 1e-6}},
            "coupling": {{"type": "matched"}},
            "environment": {{"type": "damper-wall", "stiffness": 100, "damping": 0.01, "delay": 0,
                             "one_sided": true}}}}"#
    )
    .replace('\n', " ")
}

/// A board has a phase where the scene has an output delay; if no board can have that delay, the answer gives
/// the reason.
#[test]
fn a_scene_with_an_output_delay_is_judged_as_on_a_board_with_that_phase() {
    for (delay, why) in [
        ("1e-5", None),
        ("[1e-5, 2e-5]", Some("is between 0.00001 s and 0.00002 s")),
        ("1e-6", Some("the phase must be between 5e-6 s and 0.000999 s")),
        ("0.0012", Some("the phase must be between")),
    ] {
        let output = haptic(&["certify", "--json", "-"], phased_wall(delay).as_bytes());
        assert_eq!(output.status.code(), Some(0), "{delay}: {output:?}");
        let answer = lines(&output).remove(0);
        let board = answer["board"].as_str();
        assert_eq!(board.is_some(), why.is_some(), "{delay}: {board:?}");
        assert!(why.is_none_or(|why| board.unwrap().contains(why)), "{delay}: {board:?}");
        // No allowed loss of damping is known, and the message names none.
        assert_eq!(answer["margin"], 0.0, "{delay}");
        assert!(!answer["message"].as_str().unwrap().contains("may lose"), "{answer}");
        let output = haptic(&["certify", "-"], phased_wall(delay).as_bytes());
        let text = String::from_utf8(output.stdout).unwrap();
        assert!(text.contains("none is known: where torques lag"), "{text}");
        assert!(!text.contains("margin on a board"), "{text}");
    }
}

/// A board that latches its torques reads counts late, too, which a scene with a lag has to state as its
/// jitter.
#[test]
fn a_latched_scene_with_a_lag_is_for_boards_with_its_jitter() {
    let latched = phased_wall("0").replace("\"delay\": 0", "\"delay\": 1");
    let latched = latched.replace("\"stiffness\": 100", "\"stiffness\": 15");
    let still = latched.replace("\"output_jitter\": 1e-6", "\"output_jitter\": 0");
    let at_once = latched.replace("\"actuator_lag\": 5.3e-5", "\"actuator_lag\": 0");
    for (scene, why) in
        [(&latched, None), (&at_once, None), (&still, Some("which is jitter where torques lag"))]
    {
        let output = haptic(&["certify", "--json", "-"], scene.as_bytes());
        assert_eq!(output.status.code(), Some(0), "{output:?}");
        let answer = lines(&output).remove(0);
        let board = answer["board"].as_str();
        assert_eq!(board.is_some(), why.is_some(), "{board:?}");
        assert!(why.is_none_or(|why| board.unwrap().contains(why)), "{board:?}");
    }
    // Without a sample, the torque would come before its count.
    let early = latched.replace("\"delay\": 1", "\"delay\": 0");
    let said = complaint(haptic(&["certify", "-"], early.as_bytes()));
    assert!(said.contains("no torque comes before its count"), "{said}");
}

/// Behind a spring such a wall is refused, and the remedy names the other coupling.
#[test]
fn a_face_behind_a_lag_has_the_matched_coupling_for_a_remedy() {
    let spring = phased_wall("1e-5").replace(r#""type": "matched""#, r#""stiffness": 44"#);
    let output = haptic(&["certify", "--json", "-"], spring.as_bytes());
    assert_eq!(output.status.code(), Some(1), "{output:?}");
    assert_eq!(lines(&output)[0]["remedies"][0], "behind the matched coupling");
}

/// `delta` plus the least real part of `T C / (z - 1)` on a fine grid, for the wall's controller `C`
/// behind its coupling.
fn margin_of_the_wall() -> f64 {
    let real_part = |i: u32| {
        let theta = f64::from(i) * 1e-5 * std::f64::consts::PI;
        let z = Complex::from_polar(1.0, theta);
        let environment = (22.0 + 10.0 * (1.0 - 1.0 / z)) / z;
        (0.001 * environment / (1.0 + environment / 44.0) / (z - 1.0)).re
    };
    0.022 + (1..=100_000).map(real_part).fold(f64::INFINITY, f64::min)
}

#[test]
fn an_index_that_does_not_exist_is_null() {
    let spring = WALL
        .replace("damper-wall", "delayed-spring")
        .replace("\"damping\": 0.01, ", "")
        .replace("\"stiffness\": 22", "\"stiffness\": -22");
    let output = haptic(&["certify", "--json", "-"], spring.as_bytes());
    assert_eq!(output.status.code(), Some(1));
    let answer = &lines(&output)[0];
    assert_eq!(answer["reason"], "negative_residue");
    assert_eq!(answer["alpha"], serde_json::json!({"lo": null, "hi": null}));
}

#[test]
fn a_batch_answers_line_for_line_in_order() {
    let scene = |index: usize| WALL.replace("\"wall\"", &format!("\"scene {index}\""));
    let mut input: Vec<Vec<u8>> = (0..3000).map(|index| scene(index).into_bytes()).collect();
    input[7] = b"nonsense".to_vec();
    input[8] = b"".to_vec();
    input[9] = b"{\"name\": \"\xff\"}".to_vec();
    input[10] = vec![b'x'; 200_000];
    let output = haptic(&["certify", "--batch", "-"], &input.join(&b'\n'));
    assert_eq!(output.status.code(), Some(0));
    let answers = lines(&output);
    assert_eq!(answers.len(), input.len());
    for (index, answer) in answers.iter().enumerate() {
        if (7..=10).contains(&index) {
            let error = answer["error"].as_str().unwrap();
            assert!(error.starts_with(&format!("<stdin>:{}:", index + 1)), "{error}");
            assert!(error.len() < 300);
        } else {
            assert_eq!(answer["name"], format!("scene {index}"));
        }
    }
}

#[test]
fn a_batch_answers_before_its_input_ends() {
    let mut child = program(&["certify", "--batch", "-"])
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .spawn()
        .unwrap();
    let mut stdin = child.stdin.take().unwrap();
    let mut stdout = child.stdout.take().unwrap();
    for _ in 0..3 {
        stdin.write_all(format!("{WALL}\n").as_bytes()).unwrap();
        let mut byte = [0];
        while byte != *b"\n" {
            stdout.read_exact(&mut byte).unwrap();
        }
    }
    // The reader closes the pipe: no error.
    drop(stdout);
    drop(stdin.write_all(format!("{WALL}\n").repeat(10).as_bytes()));
    drop(stdin);
    assert_eq!(child.wait().unwrap().code(), Some(0));
}

#[test]
fn a_recording_runs_on_the_host_tick_by_tick() {
    let folder = tempfile::tempdir().unwrap();
    let recording = folder.path().join("counts.csv");
    let counts: String = (0..200).map(|tick| format!("{},{}\n", tick, tick * 5)).collect();
    std::fs::write(&recording, format!("time,count\n{counts}")).unwrap();
    let path = recording.to_str().unwrap();
    let output = haptic(&["run", "damper_wall", "--replay", path, "--csv"], b"");
    assert_eq!(output.status.code(), Some(0));
    let mut reader = csv::Reader::from_reader(&output.stdout[..]);
    assert_eq!(
        reader.headers().unwrap(),
        vec!["tick", "count", "angle", "torque", "code", "limit"]
    );
    let rows: Vec<csv::StringRecord> = reader.records().map(Result::unwrap).collect();
    assert_eq!(rows.len(), 200);
    assert_eq!((&rows[199][0], &rows[199][1]), ("199", "995"));
    // Deeper into the wall the motor pushes harder back.
    assert!(rows[199][4].parse::<u16>().unwrap() < rows[100][4].parse::<u16>().unwrap());
    std::fs::write(&recording, "time,count\n0,1\n1,many\n").unwrap();
    let said = complaint(haptic(&["run", "damper_wall", "--replay", path], b""));
    assert!(said.contains(":3: column 2, `count`: `many`"), "{said}");
}

#[test]
fn a_replay_states_the_ticks_that_its_recording_lacks() {
    let folder = tempfile::tempdir().unwrap();
    let recording = folder.path().join("counts.csv");
    let path = recording.to_str().unwrap();
    let replay = |text: &str| {
        std::fs::write(&recording, text).unwrap();
        let output = haptic(&["run", "damper_wall", "--replay", path, "--json"], b"");
        assert_eq!(output.status.code(), Some(0), "{output:?}");
        let gaps = serde_json::from_slice::<serde_json::Value>(&output.stdout).unwrap();
        (String::from_utf8(output.stderr).unwrap(), gaps["replay_gaps"].clone())
    };
    let (said, gaps) = replay("tick,count\n10,1\n11,2\n14,3\n15,4\n17,4\n");
    let note = "note: 3 ticks are missing in 2 gaps; the first is after tick 11; the replay plays";
    assert!(said.starts_with(note), "{said}");
    assert_eq!((&gaps["missing"], &gaps["first_after"]), (&3.into(), &11.into()), "{gaps}");
    assert!(
        replay("time,count\n0,1\n0.001,2\n0.003,3\n").0.starts_with("note: 1 ticks are missing")
    );
    let (said, gaps) = replay("tick,count\n10,1\n11,2\n");
    assert_eq!((said.as_str(), &gaps["missing"]), ("", &0.into()));
    assert!(replay("count\n1\n2\n").1.is_null());
}

#[test]
fn a_bad_option_is_named_with_its_value_and_bound() {
    for number in ["-5", "0", "nan", "1e400"] {
        let question = ["run", "free_mode", "--counts-per-rev", number];
        let said = complaint(haptic(&question, b""));
        assert!(said.contains(number) && said.contains("greater than 0"), "{said}");
    }
}

#[test]
fn scene_files_and_programs_run_on_the_host() {
    for arguments in [&["run", "-"][..], &["run", "free_mode", "--format", "fixed"]] {
        let output = haptic(arguments, WALL.as_bytes());
        assert_eq!(output.status.code(), Some(0), "{arguments:?}");
        assert!(String::from_utf8(output.stdout).unwrap().starts_with("ticks: 5000\n"));
    }
    // Refused, unknown, and a file where a program is needed.
    let rejected = WALL.replace("0.01", "0.02");
    assert_eq!(haptic(&["run", "-"], rejected.as_bytes()).status.code(), Some(1));
    assert_eq!(haptic(&["run", "nothing"], b"").status.code(), Some(2));
    assert_eq!(haptic(&["run", "-", "--target", "qemu"], WALL.as_bytes()).status.code(), Some(2));
    let other = ["run", "damper_wall", "--target", "qemu", "--counts-per-rev", "4096"];
    assert_eq!(haptic(&other, b"").status.code(), Some(2));
}

#[test]
fn failures_are_rows_and_objects_by_name() {
    let output = haptic(&["failures", "--case", "semi-implicit-euler", "--csv"], b"");
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    let text = String::from_utf8(output.stdout).unwrap();
    let rows: Vec<&str> = text.lines().collect();
    assert_eq!(rows[0], "case,by,says,failure,figure,because");
    let first = "semi-implicit-euler,\"semi-implicit Euler, 1 step a tick\",safe,dangerous,";
    let (limit, _) = rows[1].strip_prefix(first).and_then(|rest| rest.split_once(',')).unwrap();
    assert!((limit.parse::<f64>().unwrap() - 199_000.0).abs() < 1e-3, "{limit}");
    assert_eq!(rows.len(), 1 + 3 + 2);
    let output = haptic(&["failures", "--case", "missed-ticks", "--json"], b"");
    let [answer] = &lines(&output)[..] else { panic!("one object") };
    let case = &answer["cases"][0];
    assert_eq!(
        (&case["name"], &case["claims"][0]["failure"]),
        (&"missed-ticks".into(), &"dangerous".into())
    );
    assert_eq!(case["certificate"]["says"], "unsafe");
    assert_eq!(case["trials"][1]["simulated"]["last"], 0.0);
    assert_eq!(answer["walls"].as_array().unwrap().len(), 0);
    let output = haptic(&["failures", "--case", "luck"], b"");
    assert_eq!(output.status.code(), Some(2));
    assert!(complaint(output).contains("luck"));
}

#[test]
fn the_usage_of_advice_has_what_it_cannot_do_without() {
    let help = haptic(&["advise", "--help"], b"");
    let help = String::from_utf8(help.stdout).unwrap();
    for usage in
        ["<SCENE> --max-limit-cycle <TORQUE> --rate <HZ> [OPTIONS]", "<SCENE> --model [OPTIONS]"]
    {
        assert!(help.contains(&format!("haptic advise {usage}\n")), "{help}");
    }
}

#[test]
fn advice_names_the_cheapest_format_and_why_not_the_others() {
    let advise = |more: &[&str]| {
        let question = [&["advise", "-", "--rate", "2000", "--json"], more].concat();
        haptic(&question, WALL.as_bytes())
    };
    let format = |answer: &Value, name: &str| {
        let formats = answer["formats"].as_array().unwrap();
        formats.iter().find(|format| format["format"] == name).unwrap().clone()
    };
    let output = advise(&["--max-limit-cycle", "0.0005"]);
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    let answer = &lines(&output)[0];
    assert_eq!(
        (&answer["format"], answer["formats"].as_array().unwrap().len()),
        (&"f32".into(), 8)
    );
    let simulation = &answer["simulation"];
    assert!(simulation["verdict_error"].as_f64().unwrap() <= 0.01, "{simulation}");
    assert!(simulation["substeps"].as_f64().unwrap() >= 1.0, "{simulation}");
    // 2 delta / T at this rate.
    assert!((answer["coupling_stiffness"].as_f64().unwrap() - 88.0).abs() < 1e-6);
    let coarse = format(answer, "i16f16")["rejected"].to_string();
    assert!(coarse.contains("limit cycle") && coarse.contains("is above 0.0005 N m"), "{coarse}");
    // The rounding error of f32 at 1 rad is too large for this bound, that of 31 bits is not.
    let output = advise(&["--hum", "0.0005", "--error", "2e-6"]);
    let answer = &lines(&output)[0];
    assert_eq!(answer["format"], "i1f31-truncated", "{answer}");
    assert!(answer["message"].as_str().unwrap().contains("angles in 4 rad"), "{answer}");
    assert!(format(answer, "f32")["rejected"].to_string().contains("error"), "{answer}");
    // With a very small share of the core, most formats take too much time.
    let output = advise(&["--hum", "1e-9", "--share", "0.001"]);
    assert_eq!(output.status.code(), Some(1), "{output:?}");
    let answer = &lines(&output)[0];
    assert!(answer["format"].is_null());
    assert!(format(answer, "f64")["rejected"].to_string().contains("share of the core"));
    // A too coarse encoder is not the fault of a format, but the answer is still no.
    let output = advise(&["--hum", "0.0005", "--counts-per-rev", "1000"]);
    assert_eq!(output.status.code(), Some(1), "{output:?}");
    let answer = &lines(&output)[0];
    assert_eq!(answer["format"], "f32");
    assert!(answer["encoder_hum"].as_f64().unwrap() > 0.0005);
    assert!(answer["message"].as_str().unwrap().contains("counts per turn instead of 1000"));
}

/// The DAC's largest code is the file's full-scale torque, with any torque limit of the scene.
#[test]
fn a_file_says_what_the_converter_gives() {
    let limits = r#""limits": {"torque": 0.5, "full_scale": 2}, "environment""#;
    let scene = WALL.replace(r#""environment""#, limits);
    let output = haptic(&["run", "-", "--ticks", "1000", "--csv"], scene.as_bytes());
    let text = String::from_utf8(output.stdout).unwrap();
    let rows: Vec<Vec<&str>> = text.lines().skip(1).map(|row| row.split(',').collect()).collect();
    assert_eq!(rows.len(), 1000);
    for row in &rows {
        let (torque, code): (f64, f64) = (row[3].parse().unwrap(), row[4].parse().unwrap());
        assert!((2048.0 - torque * 1791.0 / 2.0 - code).abs() < 0.51, "{row:?}");
    }
    assert!(rows.iter().any(|row| row[4].parse::<f64>().unwrap() < 2000.0), "it pushes");
}

#[test]
fn advice_needs_figures_that_make_sense_and_a_scene_that_certifies_at_the_rate() {
    let advise = |scene: &str, hum: &str, rate: &str| {
        let output = haptic(&["advise", scene, "--hum", hum, "--rate", rate], WALL.as_bytes());
        (output.status.code(), String::from_utf8(output.stderr).unwrap())
    };
    for (scene, hum, rate, said) in [
        ("-", "-1", "1000", "'-1'"),
        ("-", "nan", "1000", "'nan'"),
        ("-", "0.005", "0", "'0'"),
        ("-", "0.005", "1e9", "must be at most 200000"),
        ("wrist", "0.005", "1000", "there is no scene wrist"),
        ("no.toml", "0.005", "1000", "no.toml"),
    ] {
        let (status, words) = advise(scene, hum, rate);
        assert_eq!(status, Some(2), "{words}");
        assert!(words.contains(said), "{words}");
    }
    // K T/2 + B = 0.12 N m s/rad, of which the device has 0.022.
    let (status, words) = advise("-", "0.005", "100");
    assert_eq!(status, Some(1), "{words}");
    assert!(words.contains("rejected") && words.contains("0.12"), "{words}");
}

/// Every type of environment, on every side and with a delay that no table has.
#[test]
fn advice_has_an_answer_to_every_type_of_scene() {
    let wall = &WALL[WALL.find(r#"{"type""#).unwrap()..WALL.len() - 1];
    for environment in [
        r#"{"type": "delayed-spring", "stiffness": 5, "delay": 3}"#,
        r#"{"type": "damper-wall", "stiffness": 5, "damping": 0.005, "delay": 0, "face": 0.1}"#,
        r#"{"type": "damper-wall", "stiffness": 1, "damping": 0.005, "delay": 5, "filter": 0.3,
            "one_sided": true}"#,
        r#"{"type": "free-mode", "residual": 0.01}"#,
        r#"{"type": "free-mode", "residual": 0.01, "delay": 2}"#,
        r#"{"type": "free-mode-wall", "residual": 0.018, "stiffness": 5, "damping": 0.003,
            "delay": 1, "one_sided": true}"#,
        r#"{"type": "free-mode-wall", "residual": 0.018, "stiffness": 5, "damping": 0.003,
            "delay": 0, "face": 0.1, "filter": 0.5}"#,
        r#"{"type": "rational", "numerator": [5, -2], "denominator": [1, -0.3, 0.1, 0]}"#,
    ] {
        let scene = WALL.replace(wall, environment);
        let question = ["advise", "-", "--hum", "1", "--rate", "1000", "--json"];
        let output = haptic(&question, scene.as_bytes());
        assert_eq!(output.status.code(), Some(0), "{environment}: {output:?}");
        let answer = &lines(&output)[0];
        assert_eq!(answer["format"], "f32", "{answer}");
        for format in answer["formats"].as_array().unwrap() {
            let instructions = format["instructions"].as_f64().unwrap();
            assert!(instructions > 30.0 && instructions < 5000.0, "{environment}: {format}");
        }
    }
}

/// Theory, sections 6 and 8: the paper's wall, whose peak torque a position is 924 N m/rad, needs
/// half a count times that of friction, and the shares of DAC and numbers.
#[test]
fn friction_of_the_device_ends_a_hum() {
    let advise = |friction: f64| {
        let device = format!(r#""damping": 0.022, "friction": {friction}}}"#);
        let limits = r#""limits": {"encoder_step": 1e-4, "full_scale": 2}, "environment""#;
        let scene = WALL.replace(r#""damping": 0.022}"#, &device);
        let scene = scene.replace(r#""environment""#, limits);
        let output =
            haptic(&["advise", "-", "--hum", "1e-5", "--rate", "1000", "--json"], scene.as_bytes());
        (output.status.code(), lines(&output).remove(0))
    };
    let encoder = 924.0 * 1e-4 / 2.0;
    let (status, answer) = advise(1.1 * encoder);
    assert_eq!((status, &answer["format"]), (Some(0), &"f32".into()), "{answer}");
    let message = answer["message"].as_str().unwrap();
    assert!(
        message.contains("the device's friction of 0.0508")
            && message.contains("prevents a limit cycle")
    );
    assert!(answer["encoder_hum"].as_f64().unwrap() > 1e-3, "without friction it hums");
    let formats = answer["formats"].as_array().unwrap();
    for format in formats {
        let rest = &format["rest"];
        let found = rest["encoder"].as_f64().unwrap();
        assert!((found / encoder - 1.0).abs() < 0.02, "{format}");
        // A code of 2 N m in 1791.
        let converter = rest["converter"].as_f64().unwrap();
        assert!((converter / (1.0 / 1791.0) - 1.0).abs() < 1e-3, "{format}");
    }
    // A coarse format's rounding needs more friction than there is: the limit cycle stays.
    let coarse = formats.iter().find(|format| format["format"] == "i16f16").unwrap();
    assert_eq!(coarse["rest"]["comes_to_rest"], false, "{coarse}");
    let reasons = coarse["rejected"].to_string();
    assert!(reasons.contains("limit cycle 0.00") && reasons.contains("N m is lower"), "{coarse}");
    // Too little for the encoder alone.
    let (status, answer) = advise(0.99 * encoder);
    assert_eq!(status, Some(1), "{answer}");
    let message = answer["message"].as_str().unwrap();
    assert!(message.starts_with("no:") && message.contains("friction of 0.0457"), "{message}");
    assert!(message.contains("N m is lower"), "{message}");
    // A program's scene does not state its friction: 924 N m/rad times half of its count are 0.0473 N m.
    let program = |friction: &str| {
        let question = ["advise", "damper_wall", "--hum", "0.001", "--rate", "1000"];
        haptic(&[&question[..], &["--friction", friction]].concat(), b"").status.code()
    };
    assert_eq!([program("0.06"), program("0.047")], [Some(0), Some(1)]);
}

/// Before anything is built or run.
#[test]
fn a_run_of_no_ticks_is_refused_with_its_bounds() {
    for (arguments, bounds) in [
        (["demo", "--ticks", "0"].as_slice(), "0 is not in 2..=10000000"),
        (&["demo", "--ticks", "1"], "1 is not in 2..=10000000"),
        (&["run", "damper_wall", "--ticks", "0"], "0 is not in 1..=10000000"),
        (&["run", "damper_wall", "--ticks", "10000001"], "10000001 is not in 1..=10000000"),
    ] {
        let said = complaint(haptic(arguments, b""));
        assert!(said.contains("--ticks") && said.contains(bounds), "{said}");
    }
}

/// The size is that of the flashed board, and not of the smallest.
#[test]
fn flash_says_how_much_the_board_has() {
    for (board, sentence) in [
        (
            "nucleo-g474re",
            " of 524288 bytes; the linker's map, which fits every board, allows 131072",
        ),
        ("b-g431b-esc1", " of 131072 bytes"),
    ] {
        let built = haptic(&["flash", "damper_wall", "--board", board, "--build-only"], b"");
        assert!(built.status.success(), "{}", String::from_utf8_lossy(&built.stderr));
        let said = String::from_utf8(built.stdout).unwrap();
        let flash = said.lines().find(|line| line.starts_with("flash: ")).unwrap();
        assert!(flash.ends_with(sentence), "{flash}");
    }
}
