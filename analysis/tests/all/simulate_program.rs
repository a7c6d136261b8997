//! The commands that predict the motion of a scene, as programs call them.

use std::path::{Path, PathBuf};

use crate::common::{MOTION, WALL, answer, complaint, haptic, haptic_reading};
use serde_json::Value;
use tempfile::TempDir;

fn json(arguments: &[&str]) -> (i32, Value) {
    let output = haptic(arguments);
    (output.status.code().unwrap(), answer(&output))
}

/// A scene file with more text behind the wall above.
fn scene(folder: &TempDir, more: &str) -> PathBuf {
    let path = folder.path().join("scene.toml");
    std::fs::write(&path, format!("{WALL}{more}")).unwrap();
    path
}

fn name(path: &Path) -> &str {
    path.to_str().unwrap()
}

fn column(value: &Value, name: &str) -> Vec<f64> {
    value[name].as_array().unwrap().iter().map(|number| number.as_f64().unwrap()).collect()
}

#[test]
fn a_motion_as_json_and_the_same_as_csv() {
    let folder = TempDir::new().unwrap();
    let scene = scene(&folder, "[simulation]\nsamples = 9000\nposition = 0.001\nvelocity = 0.2\n");
    let (status, motion) = json(&["simulate", name(&scene), "--json"]);
    assert_eq!(status, 0);
    let position = column(&motion, "position");
    assert_eq!((position.len(), position[0]), (9000, 0.001));
    assert_eq!(column(&motion, "velocity")[0], 0.2);
    // The wall is one sample late.
    assert_eq!(column(&motion, "torque")[0], 0.0);
    assert!((column(&motion, "torque")[1] - 32.0 * 0.001).abs() < 1e-15);
    let output = haptic(&["simulate", name(&scene), "--csv"]).stdout;
    let mut reader = csv::Reader::from_reader(output.as_slice());
    let header = ["time", "position", "velocity", "torque", "limit"];
    assert_eq!(reader.headers().unwrap().iter().collect::<Vec<_>>(), header);
    type Row = (f64, f64, f64, f64, String);
    let rows: Vec<Row> = reader.deserialize().map(Result::unwrap).collect();
    assert_eq!(rows.iter().map(|row| row.1).collect::<Vec<_>>(), position);
    assert!(rows.iter().all(|row| row.4 == "none"));
    assert_eq!(motion["limit"].as_array().unwrap().len(), 9000);
}

#[test]
fn methods_differ_and_agree_as_their_steps_get_small() {
    let folder = TempDir::new().unwrap();
    let scene = scene(&folder, "[simulation]\nsamples = 20\nposition = 0.001\n");
    let last = |arguments: &[&str]| {
        let fixed = ["simulate", name(&scene), "--json"];
        let (_, motion) = json(&[&fixed, arguments].concat());
        column(&motion, "position")[5]
    };
    let exact = last(&["--method", "exact"]);
    for method in ["euler", "semi-implicit", "rk4", "tustin"] {
        let (coarse, fine) =
            (last(&["--method", method]), last(&["--method", method, "--substeps", "1000"]));
        assert!((fine - exact).abs() < 0.02 * (coarse - exact).abs(), "{method}");
    }
}

#[test]
fn hand_torques_come_from_a_file_beside_the_scene() {
    let folder = TempDir::new().unwrap();
    std::fs::write(folder.path().join("push.csv"), "0.1\n0.2\n-0.1\n").unwrap();
    let beside = scene(&folder, "[simulation]\nsamples = 9\ntorque_file = \"push.csv\"\n");
    let (_, from_file) = json(&["simulate", name(&beside), "--json"]);
    let inside = scene(&folder, "[simulation]\nsamples = 9\ntorque = [0.1, 0.2, -0.1]\n");
    assert_eq!(from_file, json(&["simulate", name(&inside), "--json"]).1);
    std::fs::write(folder.path().join("push.csv"), "0.1\nnan\n").unwrap();
    let beside = scene(&folder, "[simulation]\nsamples = 9\ntorque_file = \"push.csv\"\n");
    let message = complaint(haptic(&["simulate", name(&beside)]));
    assert!(message.contains("push.csv:2"), "{message}");
}

#[test]
fn bad_questions_are_named() {
    let folder = TempDir::new().unwrap();
    for (more, expected) in [
        ("", "[simulation]"),
        ("[simulation]\nsamples = 5\nlatency = 0.001\n", "simulation.latency"),
        ("[simulation]\nsamples = 5\nfriction = -1\n", "simulation.friction"),
        ("[simulation]\nsamples = 5\nmissed = { fraction = 1.0 }\n", "simulation.missed.fraction"),
        ("[simulation]\nsamples = 5\nmissed = { every = 2, seed = 1 }\n", "one or the other"),
    ] {
        let scene = scene(&folder, more);
        let message = complaint(haptic(&["simulate", name(&scene)]));
        assert!(message.contains(expected), "{message}");
    }
}

#[test]
fn advice_on_models_as_json_and_bad_questions_named() {
    let folder = TempDir::new().unwrap();
    let run = "[simulation]\nsamples = 100\n";
    let moving = scene(&folder, &format!("{run}position = 0.001\n[human]\nstiffness = 0.001\n"));
    let ask = ["advise", "--model", name(&moving)];
    let (status, advice) = json(&[&ask[..], &["--json", "--bound", "0.05"]].concat());
    assert_eq!((status, &advice["enough"]), (0, &Value::from("rigid")));
    assert_eq!(advice["left_out"], serde_json::json!(["the hand"]));
    assert_eq!(advice["models"].as_array().unwrap().len(), 2);
    for bound in ["0", "-0.1", "nan", "inf", "2", "much"] {
        let message = complaint(haptic(&[&ask[..], &["--bound", bound]].concat()));
        assert!(message.contains(bound) && message.contains("at most 1"), "{message}");
    }
    // About a model or about a format, and not about both or neither.
    let message = complaint(haptic(&[&ask[..], &["--hum", "0.1"]].concat()));
    assert!(message.contains("'--model' cannot be used with"), "{message}");
    let message = complaint(haptic(&["advise", name(&moving)]));
    assert!(message.contains("--max-limit-cycle") && message.contains("--rate"), "{message}");
    for (more, expected) in [("", "[simulation]"), (run, "nothing moves")] {
        let scene = scene(&folder, more);
        let message = complaint(haptic(&["advise", "--model", name(&scene)]));
        assert!(message.contains(expected), "{message}");
    }
}

/// The motion of a loop that grows beyond the range of numbers.
#[test]
fn a_motion_ends_where_the_numbers_do() {
    let folder = TempDir::new().unwrap();
    let more = "[simulation]\nsamples = 20000\nposition = 0.001\n";
    let unstable = format!("{WALL}{more}").replace("stiffness = 22.0", "stiffness = 60.0");
    for friction in ["", "friction = 0.0001\n"] {
        let path = folder.path().join("scene.toml");
        std::fs::write(&path, format!("{unstable}{friction}")).unwrap();
        let output = haptic(&["simulate", name(&path), "--json"]);
        assert_eq!(output.status.code(), Some(1));
        let motion = answer(&output);
        let computed = column(&motion, "position").len();
        assert!(computed > 100 && computed < 20000, "{computed}");
        for other in ["velocity", "torque"] {
            assert_eq!(column(&motion, other).len(), computed);
        }
        assert!(column(&motion, "position").iter().any(|x| x.abs() > 1e300));
        let named = format!("from sample {computed} on");
        let said = String::from_utf8(output.stderr).unwrap();
        assert!(said.contains(&named) && said.contains("unstable"), "{said}");

        let output = haptic(&["simulate", name(&path), "--csv"]);
        let rows = String::from_utf8(output.stdout).unwrap();
        assert_eq!((output.status.code(), rows.lines().count()), (Some(1), computed + 1));
        assert!(!rows.contains("inf") && !rows.contains("NaN"));
        let text = haptic(&["simulate", name(&path)]);
        assert_eq!(text.status.code(), Some(1));
        assert!(String::from_utf8(text.stdout).unwrap().contains(&format!("{computed} over")));

        // The picture shows the part that can be drawn, and names the omitted part.
        let picture = folder.path().join("trace.svg");
        let output = haptic(&["chart", "trace", name(&path), "-o", name(&picture)]);
        assert_eq!(output.status.code(), Some(1));
        assert!(String::from_utf8(output.stderr).unwrap().contains("are not drawn"));
        assert!(std::fs::read_to_string(&picture).unwrap().contains("not drawn from"));
    }
}

/// Each of these would otherwise be computed with infinities, without an answer or without an end.
#[test]
fn numbers_out_of_range_are_said_to_be_so() {
    let folder = TempDir::new().unwrap();
    let path = folder.path().join("scene.toml");
    for (from, to) in [
        ("inertia = 2.2e-5", "inertia = 1e-300"),
        ("period = 0.001", "period = 1e300"),
        ("period = 0.001", "period = 1e-300"),
        ("stiffness = 22.0", "stiffness = 1e300"),
    ] {
        let scene = format!("{WALL}[simulation]\nsamples = 5\n").replace(from, to);
        std::fs::write(&path, scene).unwrap();
        for command in ["simulate", "stability", "worst-hand"] {
            let message = complaint(haptic(&[command, name(&path)]));
            let said = ["range", "differ too much", "does not fit"];
            assert!(said.iter().any(|words| message.contains(words)), "{to} {command}: {message}");
            assert!(message.len() < 400, "{message}");
        }
    }
    // Such a scene is refused for a servo, too.
    std::fs::write(&path, WALL.replace("inertia = 2.2e-5", "inertia = 1e-300")).unwrap();
    assert!(complaint(haptic(&["run", name(&path)])).contains("rates of up to"));
}

#[test]
fn stability_and_its_status() {
    let folder = TempDir::new().unwrap();
    let (status, stable) = json(&["stability", name(&scene(&folder, "")), "--json"]);
    assert_eq!((status, stable["verdict"].as_str()), (0, Some("stable")));
    let critical = stable["critical_stiffness"].as_f64().unwrap();
    let stiffer = WALL.replace("stiffness = 22.0", &format!("stiffness = {}", critical * 1.01));
    let path = folder.path().join("stiffer.toml");
    std::fs::write(&path, stiffer).unwrap();
    let (status, unstable) = json(&["stability", name(&path), "--json"]);
    assert_eq!((status, unstable["verdict"].as_str()), (1, Some("unstable")));
    assert!(unstable["spectral_radius"].as_f64().unwrap() > 1.0);
    let same = unstable["critical_stiffness"].as_f64().unwrap();
    assert!((same / critical - 1.0).abs() < 1e-10);
}

#[test]
fn the_worst_hand_is_found_past_the_line_only() {
    let folder = TempDir::new().unwrap();
    let (status, search) = json(&["worst-hand", name(&scene(&folder, "")), "--json"]);
    assert_eq!((status, search["oscillates"].as_bool()), (0, Some(false)));
    let path = folder.path().join("stiffer.toml");
    std::fs::write(&path, WALL.replace("stiffness = 22.0", "stiffness = 26.0")).unwrap();
    let (status, search) = json(&["worst-hand", name(&path), "--json"]);
    assert_eq!((status, search["oscillates"].as_bool()), (1, Some(true)));
}

const CHAIN: &str = "actuator_lag = 0.0\nencoder = \"motor\"\n[[device.mass]]\ninertia = 1e-5\n\
    damping = 0.022\n[[device.mass]]\ninertia = 1.2e-5\n[[device.link]]\nstiffness = 60.0\n\
    damping = 0.001\n";

#[test]
fn a_design_is_a_scene_that_certifies() {
    let folder = TempDir::new().unwrap();
    let head = WALL.split_once("type").unwrap().0;
    let moving = "[simulation]\nsamples = 9\nlatency = 0.0009\n[human]\nstiffness = 4.0\n\
                  [limits]\nencoder_step = 1e-4\n";
    let rigid = "inertia = 2.2e-5\ndamping = 0.022\n";
    let wall = format!("{WALL}{moving}");
    let chain = wall.replace(rigid, CHAIN);
    let undelayed = wall.replace("delay = 1", "delay = 0");
    let free = format!("{head}type = \"free-mode\"\nresidual = 0.001\n{moving}");
    let cases: [(&str, &[&str], &str); 15] = [
        (&wall, &["largest", "stiffness"], "largest stiffness: 2"),
        (&wall, &["largest", "damping", "--safety", "0.97"], "largest damping: 0.01"),
        (&wall, &["largest", "delay"], "largest delay: 1 sample\n"),
        (&wall, &["device"], "least device damping: 0.021"),
        (&wall, &["period"], "longest period: 0.0010"),
        (&chain, &["largest", "stiffness"], "largest stiffness: 2"),
        (&chain, &["device"], "least damping of the motor's mass: 0.021"),
        (&chain, &["period", "--safety", "0.9"], "longest period: 0.000"),
        (&undelayed, &["largest", "stiffness"], "largest stiffness: any value certifies"),
        (&undelayed, &["largest", "delay"], "largest delay: 1 sample\n"),
        (&wall, &["lowest", "rate"], "lowest rate: 916.66"),
        (&chain, &["lowest", "rate", "--safety", "0.9"], "lowest rate: 1"),
        (&free, &["lowest", "rate"], "lowest rate: any value certifies"),
        (&free, &["period"], "longest period: any value certifies"),
        (&free, &["largest", "cancellation"], "largest cancellation: 0.02"),
    ];
    let path = folder.path().join("scene.toml");
    for (text, question, said) in cases {
        std::fs::write(&path, text).unwrap();
        let question = [&["design"], question, &[name(&path)]].concat();
        let output = haptic(&question);
        assert_eq!(output.status.code(), Some(0), "{output:?}");
        let designed = String::from_utf8(output.stdout).unwrap();
        assert!(designed.starts_with(&format!("# {said}")), "{designed}");
        let certify = haptic_reading(&["certify", "-", "--json"], designed.as_bytes());
        assert_eq!(answer(&certify)["verdict"], "certified", "{designed}");
        // The user's own text stays.
        for table in ["[simulation]", "[human]", "encoder_step = 0.0001"] {
            assert!(designed.contains(table), "{designed}");
        }
        assert_eq!(
            designed.matches("[[device.mass]]").count(),
            text.matches("[[device.mass]]").count()
        );
        let (status, report) = json(&[&question[..], &["--json"]].concat());
        assert_eq!((status, report["scenes"][0].as_str()), (0, Some(designed.as_str())));
    }
    std::fs::write(&path, &wall).unwrap();
    let message = complaint(haptic(&["design", "largest", "cancellation", name(&path)]));
    assert!(message.contains("no cancellation"), "{message}");
}

#[test]
fn a_design_says_what_else_it_has_changed() {
    let folder = TempDir::new().unwrap();
    let path = folder.path().join("scene.toml");
    let soft = WALL.replace("stiffness = 44.0", "stiffness = 30.0");
    std::fs::write(&path, soft.replace("period = 0.001", "period = 0.001\nworst_period = 0.001"))
        .unwrap();
    let run = |arguments: &[&str]| {
        let output = haptic(&[&["design"], arguments, &[name(&path)]].concat());
        let [out, err] = [output.stdout, output.stderr].map(|t| String::from_utf8(t).unwrap());
        (out, err)
    };
    let coupling = "the coupling is 44 N m/rad, the standard 2 delta/T; the file has 30 N m/rad";
    let (out, _) = run(&["largest", "stiffness"]);
    assert!(out.contains(&format!("# note: delayed wall: {coupling}")), "{out}");
    assert!(!run(&["largest", "stiffness", "--keep-coupling"]).0.contains("note:"));
    let (out, err) = run(&["border", "stiffness", "damping"]);
    assert!(err.contains(coupling) && !out.contains("note"), "{err}{out}");
    let (out, _) = run(&["period"]);
    assert!(out.contains("note: delayed wall: worst_period is 0.00"), "{out}");
    let (_, report) = json(&["design", "largest", "stiffness", name(&path), "--json"]);
    assert_eq!(report["notes"].as_array().map(Vec::len), Some(1), "{report}");
}

/// Four times as stiff as the device can render.
#[test]
fn a_device_that_runs_away_is_a_no() {
    let folder = TempDir::new().unwrap();
    let path = folder.path().join("scene.toml");
    let wall = WALL.replace("stiffness = 22.0", "stiffness = 80.0");
    let scene =
        |samples: u32| format!("{wall}[simulation]\nsamples = {samples}\nposition = 0.01\n");
    for more in [&[][..], &["--csv"], &["--json"]] {
        std::fs::write(&path, scene(10)).unwrap();
        let output = haptic(&[&["simulate", name(&path)], more].concat());
        assert_eq!(output.status.code(), Some(0), "{output:?}");
        std::fs::write(&path, scene(100)).unwrap();
        let output = haptic(&[&["simulate", name(&path)], more].concat());
        assert_eq!(output.status.code(), Some(1), "{more:?}");
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(said.contains("more than 1000000 rad from its zero"), "{said}");
    }
}

#[test]
fn a_run_says_what_it_does_not_use_of_a_file() {
    let folder = TempDir::new().unwrap();
    let path = folder.path().join("scene.toml");
    let chain = WALL.replace("inertia = 2.2e-5\ndamping = 0.022\n", CHAIN);
    std::fs::write(&path, format!("{chain}[simulation]\nsamples = 9\n[human]\nstiffness = 4\n"))
        .unwrap();
    let run = |more: &[&str]| {
        let output = haptic(&[&["run", name(&path), "--ticks", "20"], more].concat());
        assert_eq!(output.status.code(), Some(0), "{output:?}");
        String::from_utf8(output.stderr).unwrap()
    };
    let said = run(&[]);
    assert!(said.contains("[simulation] is not used: here a hand pushes in"), "{said}");
    assert!(said.contains("as one rigid body") && !said.contains("[human]"), "{said}");
    let counts = folder.path().join("counts.csv");
    std::fs::write(&counts, "count\n0\n1\n2\n").unwrap();
    let said = run(&["--replay", name(&counts)]);
    assert!(said.contains("[human] is not used: the counts are those of the recording"), "{said}");
    std::fs::write(&path, WALL).unwrap();
    assert_eq!(run(&[]), "");
}

#[test]
fn designs_of_several_scenes_go_into_a_folder_and_find_their_torques_from_there() {
    let folder = TempDir::new().unwrap();
    std::fs::write(folder.path().join("push.csv"), "0.1\n").unwrap();
    let wall = scene(&folder, "[simulation]\nsamples = 3\ntorque_file = \"push.csv\"\n");
    let out = folder.path().join("designed");
    let output = haptic(&["design", "period", name(&wall), name(&wall), "-o", name(&out)]);
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    for file in ["design-1.toml", "design-2.toml"] {
        let file = out.join(file);
        assert_eq!(haptic(&["certify", name(&file)]).status.code(), Some(0));
        assert_eq!(haptic(&["simulate", name(&file)]).status.code(), Some(0));
    }
    let output = haptic(&["design", "period", name(&wall), name(&wall)]);
    let said = String::from_utf8(output.stdout).unwrap();
    assert!(said.lines().all(|line| line.starts_with('#')) && said.contains("--output"), "{said}");
}

/// A chain of masses is simulated with the encoder at the hand, too, where it cannot be certified.
#[test]
fn chains_move_and_may_be_seen_from_either_end() {
    let folder = TempDir::new().unwrap();
    let lagging = CHAIN.replace("actuator_lag = 0.0\n", "actuator_lag = 0.0001\n");
    let chain = WALL.replace("inertia = 2.2e-5\ndamping = 0.022\n", &lagging);
    let text = format!("{chain}[simulation]\nsamples = 20\nvelocity = 1.0\n");
    let path = folder.path().join("chain.toml");
    let mut ends = Vec::new();
    for encoder in ["\"motor\"", "\"hand\""] {
        std::fs::write(&path, text.replace("\"motor\"", encoder)).unwrap();
        let (status, motion) = json(&["simulate", name(&path), "--json"]);
        assert_eq!(status, 0);
        ends.push(column(&motion, "position"));
        json(&["stability", name(&path), "--json"]);
    }
    assert_eq!(ends[0].len(), 20);
    // The motor's mass, which alone is damped, falls behind the hand's.
    assert!(ends[0][1] > 0.0 && ends[1][1] > ends[0][1]);
}

/// A simulation has the middle of a range and no jitter, and reports this; a latency that is known exactly is
/// simulated completely.
#[test]
fn what_is_left_out_of_a_latency_is_said() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("scene.toml");
    for (delay, jitter, words) in [
        ("1e-5", "0", None),
        ("1e-5", "1e-6", Some("without jitter")),
        ("[1e-5, 2e-5]", "1e-6", Some("middle of each range of latency, without jitter")),
    ] {
        let servo = format!("period = 0.001\noutput_delay = {delay}\noutput_jitter = {jitter}\n");
        let text = format!("{WALL}{MOTION}").replacen("period = 0.001\n", &servo, 1);
        std::fs::write(&path, text).unwrap();
        let (_, motion) = json(&["simulate", name(&path), "--json"]);
        assert_eq!(motion["left_out"].as_str(), words, "{delay}, {jitter}");
        let said = haptic(&["simulate", name(&path)]);
        let said = String::from_utf8(said.stdout).unwrap();
        assert_eq!(words.is_some_and(|words| said.contains(words)), words.is_some(), "{said}");
    }
}
