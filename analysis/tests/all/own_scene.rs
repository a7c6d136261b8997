//! A user's own scene: the commands need one new file and nothing else.

use std::fs;
use std::path::PathBuf;
use std::sync::Mutex;

use crate::common::board::BoardProcess;
use crate::common::{answer, complaint, haptic, read, root};

/// Its name, used by no scene.
const NAME: &str = "scene_of_a_test";

/// One test has the file at a time.
static ONE: Mutex<()> = Mutex::new(());

/// Its file, which goes with the test.
struct Scene(PathBuf);

impl Scene {
    fn file() -> PathBuf {
        root().join("firmware/src/bin").join(NAME).with_extension("rs")
    }

    fn begin(from: &str) -> Self {
        // A killed test may have left it.
        let _ = fs::remove_file(Self::file());
        let begun = haptic(&["new", NAME, "--from", from]);
        assert!(begun.status.success(), "{begun:?}");
        let said = String::from_utf8(begun.stdout).unwrap();
        assert!(said.starts_with(Self::file().to_str().unwrap()), "{said}");
        assert!(said.contains(&format!("cargo haptic run {NAME} --target board:")), "{said}");
        Self(Self::file())
    }

    fn change(&self, from: &str, to: &str) {
        let text = read(&self.0);
        assert!(text.contains(from), "{text}");
        fs::write(&self.0, text.replace(from, to)).unwrap();
    }
}

impl Drop for Scene {
    fn drop(&mut self) {
        let _ = fs::remove_file(&self.0);
    }
}

/// From its first line to a board that is tuned: on this machine, in the emulator, on a virtual board
/// and behind a port. Past the line it does not compile, which stops nothing else.
#[test]
#[ignore = "builds for minutes"]
fn a_new_file_is_all_that_the_commands_need() {
    let _alone = ONE.lock();
    let scene = Scene::begin("damper_wall");
    let again = complaint(haptic(&["new", NAME]));
    assert!(again.contains("exists already"), "{again}");

    // The copy equals its original, tick by tick.
    let copied = |name| haptic(&["run", name, "--csv", "--ticks", "1000"]);
    let (copy, original) = (copied(NAME), copied("damper_wall"));
    assert!(copy.status.success(), "{}", String::from_utf8_lossy(&copy.stderr));
    assert!(copy.stdout == original.stdout);

    scene.change("damped(22.0, 0.01, 1)", "damped(12.0, 0.005, 1)");
    assert!(copied(NAME).stdout != original.stdout);
    for target in ["qemu", "board:nucleo-g474re"] {
        let run = haptic(&["run", NAME, "--target", target, "--ticks", "1000", "--json"]);
        assert!(run.status.success(), "{}", String::from_utf8_lossy(&run.stderr));
        let run = answer(&run);
        assert_eq!((&run["scene"], &run["codes_equal"]), (&NAME.into(), &1000.into()), "{run}");
    }

    let board = BoardProcess::start(NAME, &[]);
    let tuned = answer(&board.haptic(&["tune", "--json"]));
    assert_eq!(tuned["parameters"]["stiffness"], 12.0, "{tuned}");

    let format = haptic(&["advise", NAME, "--hum", "0.05", "--rate", "1000", "--json"]);
    assert_eq!(answer(&format)["scene"], NAME, "{format:?}");
    let unknown = complaint(haptic(&["run", "no_such_scene"]));
    assert!(unknown.contains(NAME) && unknown.contains("damper_wall"), "{unknown}");

    scene.change("damped(12.0, 0.005, 1)", "damped(12.0, 0.02, 1)");
    let refused = complaint(haptic(&["run", NAME]));
    assert!(refused.contains("does not compile") && refused.contains("would pass"), "{refused}");
    assert!(copied("damper_wall").stdout == original.stdout);
}

/// A scene file, with its device in a file of its own, is all that a board needs, and the program that begins
/// with it is the same scene, with what opposes its cogging.
#[test]
#[ignore = "builds for minutes"]
fn a_scene_file_runs_on_boards_and_becomes_a_program() {
    let _alone = ONE.lock();
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, text: &str| fs::write(folder.path().join(name), text).unwrap();
    write("knob.toml", KNOB);
    write("own wall.toml", WALL);
    let file = folder.path().join("own wall.toml");
    let file = file.to_str().unwrap();
    for target in ["qemu", "board:nucleo-g474re"] {
        let run = haptic(&["run", file, "--target", target, "--ticks", "1000", "--json"]);
        assert!(run.status.success(), "{}", String::from_utf8_lossy(&run.stderr));
        assert_eq!(answer(&run)["codes_equal"], 1000, "{target}");
    }
    let flash = |more: &[&str]| {
        let flash = ["flash", file, "--board", "nucleo-g474re", "--build-only"];
        haptic(&[&flash, more].concat())
    };
    let built = flash(&[]);
    // The only line of a build is that it takes long.
    let said = String::from_utf8_lossy(&built.stderr);
    assert!(built.status.success() && !said.contains("note"), "{built:?}");
    assert!(String::from_utf8_lossy(&built.stdout).contains("scene-own wall-f32-nucleo"));

    let knob = folder.path().join("knob.toml");
    let measure = ["flash", "identify", "--board", "nucleo-g474re", "--build-only", "--device"];
    let built = haptic(&[&measure[..], &[knob.to_str().unwrap()]].concat());
    let said = String::from_utf8_lossy(&built.stderr);
    assert!(built.status.success() && !said.contains("note"), "{built:?}");

    let run = |scene: &str| haptic(&["run", scene, "--csv", "--ticks", "1000"]);
    let scene = Scene::begin(file);
    let (own, of_file) = (run(NAME), run(file));
    assert!(own.status.success(), "{}", String::from_utf8_lossy(&own.stderr));
    assert!(own.stdout == of_file.stdout);
    drop(scene);

    // The compiler points at the constant, and the message names the file.
    write("own wall.toml", &WALL.replace("stiffness = 5", "stiffness = 50"));
    let refused = flash(&[]);
    assert_eq!(refused.status.code(), Some(1), "{refused:?}");
    let said = String::from_utf8_lossy(&refused.stderr);
    for part in ["own wall.toml: ", "would pass with stiffness", "scenes/own wall.rs:"] {
        assert!(said.contains(part), "{said}");
    }
}

const KNOB: &str = "\
[device]
inertia = 3e-5
damping = 0.003
[anticogging]
torque = [0, 0.001, 0.002, 0.001, 0, -0.001, -0.002, -0.001]
share = 0.75
[limits]
encoder_step = 0.0015339807878856412
full_scale = 0.3
torque = 0.2
";

const WALL: &str = "\
name = 'a wall of my own'
device = 'knob.toml'
[servo]
period = 0.0005
[coupling]
stiffness = 11.9
[environment]
type = 'delayed-spring'
stiffness = 5
delay = 1
";

/// After a measurement the user changes one file, and the scenes of the project still compile: they use
/// another device.
#[test]
fn a_device_is_written_once() {
    let folder = root().join("firmware/src/bin");
    assert!(read(folder.join("paddle/mod.rs")).contains("DEVICE: Device = Device {"));
    for name in [
        "damper_wall",
        "delayed_spring",
        "supervised_spring",
        "undelayed_spring",
        "undelayed_wall",
        "free_mode",
    ] {
        let text = read(folder.join(name).with_extension("rs"));
        let from_there = ["mod paddle;", "paddle::TRANSDUCERS"];
        assert!(from_there.iter().all(|part| text.contains(part)), "{name}");
        assert!(!text.contains("inertia:") && !text.contains("counts_per_turn"), "{name}");
    }
}
