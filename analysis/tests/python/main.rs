//! The package for Python, installed by pip from this checkout: its answers against those of the program, and
//! its example. It needs Python, and the packages that it is built and drawn with, which come from PyPI the
//! first time. Where they are missing, these tests report this and count as ignored. All but the first are
//! also ignored, unless they are asked for by a part of a name or `--include-ignored`.

#[allow(dead_code)]
#[path = "../all/common/mod.rs"]
mod common;

use std::path::Path;
use std::process::{Command, ExitCode};

use analysis::toolchain::python::{PythonEnvironment, finished};
use analysis::toolchain::target_folder;
use libtest_mimic::{Arguments, Completion, Trial};

use self::common::root;

/// The tests of `agree.py`, each a process.
const AGREE: [&str; 5] = ["certify", "simulate", "index", "stability_map", "refusals"];

/// The test of `examples/map.py`.
const EXAMPLE: &str = "the_example_draws_its_map";

/// The benchmark beside packages of Python.
const PEERS: &str = "peers_are_measured_in_the_same_run";

/// The example without dependencies.
const IGNORED: &str = "without_python_these_tests_are_ignored";

/// The packages for the build of the package, and for its example.
const FROM_PYPI: [&str; 3] = ["maturin>=1.9,<2", "numpy", "matplotlib"];

fn main() -> ExitCode {
    let arguments = Arguments::from_args();
    // A list of the tests, or other tests, need no Python.
    let wanted = |name: &str| arguments.filter.as_ref().is_none_or(|part| name.contains(part));
    let looks = !arguments.list && AGREE.into_iter().chain([EXAMPLE, PEERS, IGNORED]).any(wanted);
    let environment = PythonEnvironment::kept().unwrap();
    let fetch = || finished(environment.pip_install().args(FROM_PYPI));
    let set_up = || {
        environment.set_up().and_then(|()| fetch().map_err(|why| format!("pip has no PyPI: {why}")))
    };
    let missing = looks.then(set_up).and_then(Result::err);
    if let Some(why) = &missing {
        eprintln!("skipped: tests/python runs the package for Python: {why}");
    } else if looks {
        install(&environment);
    }
    let trial = |name: &'static str| {
        let is_missing = missing.is_some();
        let run = move || {
            if is_missing {
                return Ok(Completion::ignored());
            }
            run(name);
            Ok(Completion::Completed)
        };
        let is_wanted = arguments.filter.is_some() || name == AGREE[0];
        let trial = Trial::ignorable_test(name, run).with_ignored_flag(is_missing || !is_wanted);
        if is_missing { trial.with_kind("no python") } else { trial }
    };
    let trials = AGREE.into_iter().chain([EXAMPLE, PEERS, IGNORED]).map(trial).collect();
    libtest_mimic::run(&arguments, trials).exit_code()
}

fn run(name: &str) {
    match name {
        EXAMPLE => the_example_draws_its_map(),
        PEERS => peers_are_measured_in_the_same_run(),
        IGNORED => without_python_these_tests_are_ignored(),
        _ => agrees(name),
    }
}

/// Installs the package from this checkout as a user does, but compiled as tests are. The build tools are
/// in the environment, so that pip does not fetch them.
///
/// # Panics
/// Where it cannot be installed.
fn install(environment: &PythonEnvironment) {
    let package = root().join("analysis/python");
    let mut pip = environment.pip_install();
    pip.args(["--no-build-isolation", "--no-deps", "--force-reinstall"]).arg(&package);
    pip.env("MATURIN_PEP517_ARGS", "--profile dev --locked");
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

fn agrees(test: &str) {
    let folder = tempfile::tempdir().unwrap();
    let program = env!("CARGO_BIN_EXE_haptic");
    python(folder.path(), "analysis/tests/python/agree.py", &[program, test]);
}

/// It also prints the text that the guide shows.
fn the_example_draws_its_map() {
    let folder = tempfile::tempdir().unwrap();
    let printed = python(folder.path(), "analysis/python/examples/map.py", &["map.png"]);
    let guide = common::read(root().join("docs/python.md"));
    let (_, shown) = guide.split_once("<!-- map -->\n```text\n").expect("the guide shows it");
    assert_eq!(printed, shown.split_once("```").unwrap().0);
    let picture = std::fs::read(folder.path().join("map.png")).unwrap();
    let decoder = png::Decoder::new(picture.as_slice());
    let mut reader = decoder.read_info().unwrap();
    let mut pixels = vec![0; reader.output_buffer_size()];
    let frame = reader.next_frame(&mut pixels).unwrap();
    let is_certified = |pixel: &&[u8]| pixel[..3] == [0x3f, 0x7f, 0xb5];
    let samples = frame.color_type.samples();
    let certified = pixels.chunks_exact(samples).filter(is_certified).count();
    // Of the left half, the part that is certified, and margins.
    let share = certified as f64 / f64::from(frame.width * frame.height);
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
    const JUDGED: &str = "; of 45: 0 wrong, 0 undecided, same run";
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
                let judged = if peer == "scipy" { ", same run" } else { JUDGED };
                let version = source.strip_prefix(package).expect(source);
                assert!(version.starts_with(|first: char| first.is_ascii_digit()), "{source}");
                assert!(version.ends_with(&format!("{method}{judged}")), "{source}");
            }
            None => {
                assert!(["slycot", "python-control"].contains(&peer), "{row}");
                assert!(source.contains(&format!("{peer} is not available: ")), "{row}");
            }
        }
    }
}

/// They do not count as passed: runs this program again, with a path that has no programs.
fn without_python_these_tests_are_ignored() {
    let this = std::env::current_exe().unwrap();
    let run = Command::new(this).env("PATH", "/nowhere").output().unwrap();
    assert!(run.status.success(), "{run:?}");
    let (shown, said) =
        (String::from_utf8(run.stdout).unwrap(), String::from_utf8(run.stderr).unwrap());
    assert_eq!(shown.matches("test [no python] ").count(), AGREE.len() + 3, "{shown}");
    assert!(shown.contains("0 passed; 0 failed; 8 ignored"), "{shown}");
    assert!(said.contains("skipped: ") && said.contains("apt install python3"), "{said}");
}
