//! The package for Python, installed by pip from this checkout: its answers against those of the program, and
//! its example. It needs Python, and the packages that it is built and drawn with, which come from PyPI the
//! first time. Where they are missing, these tests report this and count as ignored. They are also
//! ignored unless they are asked for by a part of a name or `--include-ignored`.

#[allow(dead_code)]
#[path = "../all/common/mod.rs"]
mod common;
#[path = "../browser/ignorable.rs"]
mod ignorable;
#[allow(dead_code)]
#[path = "../browser/picture.rs"]
mod picture;

use std::io::Cursor;
use std::path::Path;
use std::process::ExitCode;

use analysis::toolchain::python::{PythonEnvironment, finished};
use analysis::toolchain::target_folder;

use self::common::root;
use self::picture::Picture;

/// The tests of `agree.py`, each a process.
const AGREE: [&str; 5] = ["certify", "simulate", "index", "stability_map", "refusals"];

/// The tests of `board.py`, each a process.
const BOARD: [&str; 6] = ["tunes", "records", "is_no_board", "is_lost", "streams", "pushes"];

/// The packages for the build of the package, and for its example.
const FROM_PYPI: [&str; 3] = ["maturin>=1.9,<2", "numpy", "matplotlib"];

const KIND: &str = "no python";

/// A test by its name.
type Test = (&'static str, Box<dyn FnOnce() + Send>);

fn main() -> ExitCode {
    let mut tests: Vec<Test> = Vec::new();
    for test in AGREE {
        tests.push((test, Box::new(move || agrees(test))));
    }
    for test in BOARD {
        tests
            .push((test, Box::new(move || drop(alone("analysis/tests/python/board.py", &[test])))));
    }
    tests.push(("the_example_tunes_a_board", Box::new(the_example_tunes_a_board)));
    tests.push(("the_guide_of_a_host_runs", Box::new(the_guide_of_a_host_runs)));
    tests.push(("the_example_draws_its_map", Box::new(the_example_draws_its_map)));
    tests
        .push(("peers_are_measured_in_the_same_run", Box::new(peers_are_measured_in_the_same_run)));
    let count = tests.len() + 1;
    let ignored = move || ignorable::assert_ignored_without_tools(KIND, count, "python3");
    tests.push(("without_python_these_tests_are_ignored", Box::new(ignored)));
    ignorable::run(KIND, "tests/python runs the package for Python", 0, tests, || {
        let environment = PythonEnvironment::kept().unwrap();
        environment.set_up()?;
        finished(environment.pip_install().args(FROM_PYPI))
            .map_err(|why| format!("pip has no PyPI: {why}"))?;
        install(&environment);
        Ok(())
    })
}

/// Installs the package from this checkout as a user does. The build tools are in the environment, so that
/// pip does not fetch them.
///
/// # Panics
/// Where it cannot be installed.
fn install(environment: &PythonEnvironment) {
    let package = root().join("analysis/python");
    let mut pip = environment.pip_install();
    pip.args(["--no-build-isolation", "--no-deps", "--force-reinstall"]).arg(&package);
    pip.env("CARGO_TARGET_DIR", target_folder().unwrap());
    finished(&mut pip).unwrap_or_else(|why| panic!("{}: {why}", package.display()));
}

/// Runs a file of Python in a folder of its own; returns its output.
fn python(folder: &Path, file: &str, arguments: &[&str]) -> String {
    let mut python = PythonEnvironment::kept().unwrap().program("python");
    python.arg(root().join(file)).args(arguments).current_dir(folder);
    let output = python.output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).unwrap()
}

/// The same in an empty folder.
fn alone(file: &str, arguments: &[&str]) -> String {
    python(tempfile::tempdir().unwrap().path(), file, arguments)
}

fn agrees(test: &str) {
    alone("analysis/tests/python/agree.py", &[env!("CARGO_BIN_EXE_haptic"), test]);
}

/// It prints the text that the guide shows.
fn the_example_tunes_a_board() {
    assert_eq!(alone("analysis/python/examples/board.py", &[]), shown("board"));
}

/// Its blocks of Python, one after the other beside its scene file, print the text that it shows.
fn the_guide_of_a_host_runs() {
    let guide = common::read(root().join("docs/host-torque.md"));
    let blocks = |language: &str| {
        let begin = format!("```{language}\n");
        let blocks = guide.split(&begin).skip(1).map(|rest| rest.split_once("```").unwrap().0);
        blocks.map(str::to_owned).collect::<Vec<_>>()
    };
    let folder = tempfile::tempdir().unwrap();
    let file = |name: &str| folder.path().join(name);
    std::fs::write(file("wheel.toml"), &blocks("toml")[0]).unwrap();
    std::fs::write(file("guide.py"), blocks("python").join("\n")).unwrap();
    let guide_py = file("guide.py");
    let printed = python(folder.path(), guide_py.to_str().unwrap(), &[]);
    assert_eq!(printed, shown_in("docs/host-torque.md", "printed"));
}

/// The text that the guide shows under this mark.
fn shown(mark: &str) -> String {
    shown_in("docs/python.md", mark)
}

fn shown_in(guide: &str, mark: &str) -> String {
    let guide = common::read(root().join(guide));
    let (_, shown) =
        guide.split_once(&format!("<!-- {mark} -->\n```text\n")).expect("the guide shows it");
    shown.split_once("```").unwrap().0.to_owned()
}

/// It also prints the text that the guide shows.
fn the_example_draws_its_map() {
    let folder = tempfile::tempdir().unwrap();
    let printed = python(folder.path(), "analysis/python/examples/map.py", &["map.png"]);
    assert_eq!(printed, shown("map"));
    let picture = std::fs::read(folder.path().join("map.png")).unwrap();
    let Picture { size: [width, height], pixels, .. } = Picture::read(Cursor::new(picture), "");
    let certified = pixels.iter().filter(|pixel| **pixel == [0x3f, 0x7f, 0xb5]).count();
    // Of the left half, the part that is certified, and margins.
    let share = certified as f64 / f64::from(width * height);
    assert!((0.05..0.3).contains(&share), "{share}");
}

/// NumPy and SciPy have a build for every machine; for the others, the row has a ratio or the reason.
fn peers_are_measured_in_the_same_run() {
    let mut bench = common::program(&["bench", "--host", "--peers", "--quick", "--json"]);
    // Without cargo, nothing is compiled.
    let figures = common::answer(&bench.env("CARGO", "/nowhere").output().unwrap());
    let row = |end: &str| {
        let mut figures = figures.as_array().unwrap().iter();
        figures.find(|figure| figure["name"].as_str().unwrap().ends_with(end)).unwrap()
    };
    // An interior-point method ends without a verdict where the rounding of a machine's BLAS stops it.
    fn judged<'a>(peer: &str, source: &'a str) -> Option<&'a str> {
        let undecided = if peer == "python-control" { 0..5 } else { 0..1 };
        let end = |undecided| format!("; of 45: 0 wrong, {undecided} undecided, same run");
        match peer {
            "scipy" => source.strip_suffix(", same run"),
            _ => undecided.map(end).find_map(|end| source.strip_suffix(&end)),
        }
    }
    for (peer, package, method) in [
        ("numpy", "numpy ", ", companion matrix"),
        ("slycot", "slycot ", ", AB13DD"),
        ("python-control", "control ", ", get_input_ff_index"),
        ("scipy", "scipy ", ", signal.dlsim"),
    ] {
        let row = row(&format!(": beside {peer}"));
        let source = row["source"].as_str().unwrap();
        match row["ratio"].as_f64() {
            Some(ratio) => {
                let [value, against] = ["value", "against"].map(|key| row[key].as_f64().unwrap());
                assert!(ratio > 0.0 && (ratio - value / against).abs() < 1e-12, "{row}");
                let about = judged(peer, source).expect(source);
                let version = about.strip_prefix(package).expect(source);
                assert!(version.starts_with(|first: char| first.is_ascii_digit()), "{source}");
                assert!(version.ends_with(method), "{source}");
            }
            None => {
                assert!(["slycot", "python-control"].contains(&peer), "{row}");
                assert!(source.contains(&format!("{peer} is not available: ")), "{row}");
            }
        }
    }
}
