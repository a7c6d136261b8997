//! Flashed programs on a virtual board, as a user runs them.

use std::path::Path;
use std::process::Output;

use serde_json::Value;
use tempfile::TempDir;

use crate::common::board::BoardProcess;
use crate::common::{answer, haptic};
use crate::readme::block;

/// Columns of the rows that `haptic run --csv` has printed.
fn columns(csv: &[u8]) -> (Vec<f64>, Vec<f64>) {
    let mut reader = csv::Reader::from_reader(csv);
    let rows = reader.deserialize().map(|row| {
        let (_, _, angle, torque, _, _): (u64, i64, f64, f64, u16, String) = row.unwrap();
        (angle, torque)
    });
    rows.unzip()
}

const TARGET: &str = "board:b-g431b-esc1";

/// Runs a scene on a target.
fn ran(scene: &str, target: &str, ticks: &str, more: &[&str]) -> Output {
    let run = haptic(&[&["run", scene, "--target", target, "--ticks", ticks], more].concat());
    assert_eq!(run.status.code(), Some(0), "{}", String::from_utf8_lossy(&run.stderr));
    run
}

/// Runs a program with its board's own bridge in the hand that shows it; then has the servo on this machine play
/// the same counts, which it puts in a file. Gives angles and torques.
fn with_its_bridge(scene: &str, ticks: &str, file: &Path) -> (Vec<f64>, Vec<f64>) {
    let in_hand = ran(scene, TARGET, ticks, &["--csv"]).stdout;
    std::fs::write(file, &in_hand).unwrap();
    let replayed = ran(scene, "host", ticks, &["--replay", file.to_str().unwrap(), "--csv"]);
    assert_eq!(replayed.stdout, in_hand);
    columns(&in_hand)
}

/// The board plays them, too.
#[test]
#[ignore = "builds for minutes"]
fn a_scene_file_with_a_motor_has_the_codes_of_the_host_on_the_bridge() {
    let folder = TempDir::new().unwrap();
    let [file, counts] = ["driven.toml", "counts.csv"].map(|name| folder.path().join(name));
    std::fs::write(&file, block("docs/power-stage.md", "driven")).unwrap();
    let scene = file.to_str().unwrap();
    let (_, torques) = with_its_bridge(scene, "3000", &counts);
    assert!(torques.iter().any(|torque| torque.abs() > 0.1), "{torques:?}");
    let replay = ["--replay", counts.to_str().unwrap(), "--json"];
    let replayed = answer(&ran(scene, TARGET, "3000", &replay));
    assert_eq!(replayed["codes_equal"], 3000, "{replayed}");
    assert_eq!((&replayed["difference"], &replayed["energy"]), (&Value::Null, &Value::Null));
    // The code is not put out: it waits in memory for the current loop.
    assert_eq!(replayed["instructions"]["compute_max"], Value::Null);
    assert!(replayed["instructions"]["interrupt_mean"].as_f64().unwrap() > 100.0, "{replayed}");
}

/// Aligned before that, as a person would have it aligned, which takes longest.
#[test]
#[ignore = "builds for minutes"]
fn a_brushless_motor_is_aligned_and_then_gives_the_codes_of_the_host() {
    let counts = tempfile::NamedTempFile::new().unwrap();
    let (angles, torques) = with_its_bridge("brushless_wall", "9500", counts.path());
    // The hand comes from outside, where there is no torque.
    assert_eq!((angles[0], torques[0]), (0.0, 0.0));
    assert!(angles.iter().any(|&angle| angle < -0.01), "{angles:?}");
    assert!(torques.iter().any(|&torque| torque > 0.02), "{torques:?}");
}

/// Tunes a board; gives exit status and answer.
fn tuned(board: &BoardProcess, arguments: &[&str]) -> (Option<i32>, Value) {
    let output = board.haptic(&[&["tune", "--json"], arguments].concat());
    (output.status.code(), answer(&output))
}

/// Over the serial port that the drivers have set up, judged by the certificate in the flash.
#[test]
#[ignore = "builds for minutes"]
fn the_parameters_of_what_is_flashed_are_tuned_over_its_serial_port() {
    let board = BoardProcess::start("damper_wall", &["--board", "nucleo-g474re"]);
    let (status, running) = tuned(&board, &[]);
    assert_eq!((status, &running["refused"]), (Some(0), &Value::Null), "{running}");
    assert_eq!(running["parameters"]["stiffness"], 22.0);
    let (state, reset) = (&running["state"], &running["reset"]);
    assert_eq!((state, reset), (&"disarmed".into(), &"power-on".into()), "{running}");
    let (status, running) = tuned(&board, &["--arm"]);
    assert_eq!((status, &running["refused"]), (Some(0), &Value::Null), "{running}");
    let (status, running) = tuned(&board, &["stiffness=20"]);
    assert_eq!((status, &running["refused"]), (Some(0), &Value::Null), "{running}");
    assert_eq!(running["parameters"]["stiffness"], 20.0);
    // Past the line: the board itself refuses, names numbers that would pass, and goes on.
    let (status, refused) = tuned(&board, &["damping=0.02"]);
    assert_eq!(status, Some(1), "{refused}");
    assert!(refused["refused"].to_string().contains("would pass"), "{refused}");
    let (_, running) = tuned(&board, &[]);
    assert_eq!(running["parameters"]["damping"], 0.01);
    assert_eq!(running["missed"], 0, "{running}");
}

/// With the measurements of its power stage.
#[test]
#[ignore = "builds for minutes"]
fn a_board_with_a_bridge_is_armed_and_watched_over_its_serial_port() {
    let board = BoardProcess::start("bridge_wall", &["--board", "b-g431b-esc1"]);
    let (status, running) = tuned(&board, &["--arm"]);
    assert_eq!((status, &running["refused"]), (Some(0), &Value::Null), "{running}");
    let (_, running) = tuned(&board, &["stiffness=15"]);
    assert_eq!(running["refused"], Value::Null, "{running}");
    assert_eq!(running["parameters"]["stiffness"], 15.0);
    let power = |which| running["power"][which].as_f64().unwrap();
    // The supply's own voltage, and the room, by the steps of the converters.
    assert!((power("voltage") - 24.0).abs() < 0.05, "{running}");
    assert!((power("temperature") - 25.0).abs() < 1.0, "{running}");
    assert!(power("current").abs() < 4.0 && power("reference").abs() < 4.0, "{running}");
    // A wall this soft is certified, but a push into it returns more than the supply takes.
    let (status, refused) = tuned(&board, &["stiffness=1.5"]);
    assert_eq!(status, Some(1), "{refused}");
    assert!(refused["refused"].to_string().contains("J to the supply"), "{refused}");
    assert_eq!(tuned(&board, &[]).1["parameters"]["stiffness"], 15.0);
}

/// The device has the age of its chip's readings, so that its counts are those that a chip which answers a period later
/// gives; and it does not rest so well that the chip counts as stopped.
#[test]
#[ignore = "builds for a minute"]
fn a_chip_that_answers_late_has_the_codes_of_the_host() {
    let folder = TempDir::new().unwrap();
    let file = folder.path().join("late.toml");
    let scene = "name = \"late\"\ndevice = { inertia = 2.2e-5, damping = 0.022 }\nservo = { period = 0.0001 }\n\
                 environment = { type = \"damper-wall\", stiffness = 5.0, damping = 0.0, delay = 1 }\n\
                 encoder = { chip = \"as5048a\", age = [1.71e-4, 3e-4], noise = 1 }\n\
                 limits = { torque = 0.5, full_scale = 1.0 }\n";
    std::fs::write(&file, scene).unwrap();
    let ran = haptic(&[
        "run",
        file.to_str().unwrap(),
        "--target",
        "board:nucleo-g474re",
        "--ticks",
        "8000",
    ]);
    let out = String::from_utf8_lossy(&ran.stdout);
    assert!(
        out.contains("codes equal: 8000 of 8000"),
        "{out}{}",
        String::from_utf8_lossy(&ran.stderr)
    );
}

/// The transfers of a chip fail in a row as often as its certificate allows: the board replaces each reading by the one
/// before, as this machine does.
#[test]
#[ignore = "builds for minutes"]
fn readings_that_fail_have_the_codes_of_the_host() {
    const WALL: &str = include_str!("../../virtual-board/tests/board/magnetic_wall.toml");
    const KNOB: &str = include_str!("../../virtual-board/tests/board/bridge/magnetic_knob.toml");
    let folder = TempDir::new().unwrap();
    let failing = |scene: &str, most: usize| {
        let law = format!("{{ every = {}, length = {most} }}", most + 1);
        let failing =
            format!("noise = 2\ndropped = {most}\n[simulation]\nsamples = 1\ndropped = {law}");
        scene.replace("dropped = 1\n", "").replace("noise = 2", &failing)
    };
    let knob = KNOB.replace("stiffness = 0.8", "stiffness = 0.4");
    let file = folder.path().join("failing.toml");
    let name = file.to_str().unwrap();
    for (scene, most, target) in
        [(WALL, 2, "board:nucleo-g474re"), (&knob, 1, "board:b-g431b-esc1")]
    {
        std::fs::write(&file, failing(scene, most)).unwrap();
        let ran = haptic(&["run", name, "--target", target, "--ticks", "3000", "--csv"]);
        // 1 where a code differs.
        assert_eq!(ran.status.code(), Some(0), "{}", String::from_utf8_lossy(&ran.stderr));
        let (angles, torques) = columns(&ran.stdout);
        assert!(torques.iter().any(|torque| torque.abs() > 1e-3), "{target}");
        // On a bridge the first two readings do not fail.
        let moved = |tick: usize| {
            let of = angles[2..].windows(2).skip(tick).step_by(most + 1);
            of.filter(|two| two[0] != two[1]).count()
        };
        let read: Vec<_> = (0..=most).map(moved).collect();
        let stand = read.iter().filter(|&&moved| moved == 0).count();
        assert!(stand == most && read.iter().any(|&moved| moved > 200), "{target} {read:?}");
    }
}

/// The largest programs: the current loop of a bridge, what opposes cogging, a host and a chip. The refusal
/// of a larger program has the bytes.
#[test]
#[ignore = "builds for minutes"]
fn a_host_and_a_chip_fit_a_bridge_beside_what_opposes_cogging() {
    let folder = TempDir::new().unwrap();
    let cogging = "\n[anticogging]\ntorque = [0, 1e-4, 2e-4, 1e-4, 0, -1e-4, -2e-4, -1e-4]\n";
    let host = block("docs/host-torque.md", "direct").replace("torque = 0.6 ", "torque = 0.5 ");
    let mt6701 = "[encoder]\nchip = \"mt6701\"\nage = [4.5e-6, 4.2e-5]\n[limits]\n";
    let both = host.replace("counts_per_turn = 16384\n", "").replace("[limits]\n", mt6701);
    let (device, rest) = host.split_once("[environment]").unwrap();
    let (_, rest) = rest.split_once("[limits]").unwrap();
    let profile = format!(
        "{device}[environment]\ntype = \"profile\"\ndelay = 1\ndamping = 0.0002\n\
         shape = [{{ type = \"detents\", count = 24, torque = 0.02 }}, \
         {{ type = \"end_stops\", from = -1.5, to = 1.5, stiffness = 0.5 }}]\n\
         wall = {{ stiffness = 0.5, damping = 0, delay = 1, face = 1.0, one_sided = true }}\n[limits]{rest}"
    );
    let chip = include_str!("../../virtual-board/tests/board/bridge/magnetic_knob.toml");
    let chip = chip.replace("full_scale = 0.3", "full_scale = 0.35");
    for (name, scene, format, refused) in [
        ("host.toml", &host, "f32", None),
        ("host.toml", &host, "fixed", None),
        ("chip.toml", &chip, "f32", None),
        ("both.toml", &both, "f32", None),
        ("profile.toml", &profile, "f32", Some("more than the 6144 that it may: build it in f32")),
    ] {
        let file = folder.path().join(name);
        std::fs::write(&file, format!("{scene}{cogging}")).unwrap();
        let file = file.to_str().unwrap();
        let flash = ["flash", "--build-only", "--board", "b-g431b-esc1", "--format", format, file];
        let built = haptic(&flash);
        let error = String::from_utf8_lossy(&built.stderr);
        assert_eq!(built.status.code(), Some(if refused.is_some() { 2 } else { 0 }), "{error}");
        assert!(error.contains(refused.unwrap_or_default()), "{error}");
    }
}

/// A host that wants energy sends its commands over the serial port, to each kind of board, and beside a program
/// or a file. The servo on this machine gets each in the tick in which the board took it.
#[test]
#[ignore = "builds for minutes"]
fn beside_a_host_a_board_has_the_codes_of_this_machine() {
    let file = concat!(env!("CARGO_MANIFEST_DIR"), "/pictures/host.toml");
    let folder = TempDir::new().unwrap();
    let direct = folder.path().join("direct.toml");
    std::fs::write(&direct, block("docs/host-torque.md", "direct")).unwrap();
    for (scene, target) in [
        (direct.to_str().unwrap(), "board:b-g431b-esc1"),
        ("hosted_wall", "board:nucleo-g474re"),
        (file, "qemu"),
    ] {
        for law in ["pump", "late-spring"] {
            let options = ["--target", target, "--host", law, "--ticks", "1500", "--json"];
            let run = answer(&haptic(&[&["run", scene], &options[..]].concat()));
            assert_eq!((&run["codes_equal"], &run["difference"]), (&1500.into(), &Value::Null));
            let host = &run["host"];
            assert!(host["limited_ticks"].as_u64().unwrap() > 100, "{scene} {target}: {host}");
            let most = host["most_of_budget"].as_f64().unwrap();
            // The wheel on a bridge does not swing with a late spring.
            let least = if target.ends_with("esc1") && law == "late-spring" { 0.0 } else { 0.2 };
            assert!((least..=1.0).contains(&most), "{scene} {target}: {host}");
        }
    }
}
