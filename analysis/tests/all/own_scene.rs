//! A user's own scene: the commands need one new file and nothing else.

use std::fs;
use std::path::PathBuf;

use crate::common::board::BoardProcess;
use crate::common::{answer, complaint, haptic, read, root};

/// Its name, used by no scene.
const NAME: &str = "scene_of_a_test";

/// Its file, which goes with the test.
struct Scene(PathBuf);

impl Scene {
    fn file() -> PathBuf {
        root().join("firmware/src/bin").join(NAME).with_extension("rs")
    }

    fn begin() -> Self {
        // A killed test may have left it.
        let _ = fs::remove_file(Self::file());
        let begun = haptic(&["new", NAME]);
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
    let scene = Scene::begin();
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

/// After a measurement the user changes one file, and the scenes of the project still compile: they use
/// another device.
#[test]
fn a_device_is_written_once() {
    let folder = root().join("firmware/src/bin");
    for device in ["device", "paddle"] {
        let text = read(folder.join(device).join("mod.rs"));
        assert!(text.contains("DEVICE: Device = Device {"), "{device}");
    }
    for (name, device) in [
        ("damper_wall", "paddle"),
        ("delayed_spring", "paddle"),
        ("supervised_spring", "paddle"),
        ("undelayed_spring", "paddle"),
        ("undelayed_wall", "paddle"),
        ("free_mode", "paddle"),
        ("identify", "device"),
    ] {
        let text = read(folder.join(name).with_extension("rs"));
        let from_there = [format!("mod {device};"), format!("{device}::TRANSDUCERS")];
        assert!(from_there.iter().all(|part| text.contains(part)), "{name}");
        assert!(!text.contains("inertia:") && !text.contains("counts_per_turn"), "{name}");
    }
}
