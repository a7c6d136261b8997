//! The package for Python, installed by pip from this checkout: its answers against those of the program, and
//! its example. It needs Python, and the packages that it is built and drawn with, which come from PyPI the
//! first time. Where they are missing, these tests report this and count as ignored.

#[allow(dead_code)]
#[path = "../all/common/mod.rs"]
mod common;

use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode, Stdio};

use libtest_mimic::{Arguments, Trial};

use self::common::{root, set_up_package, set_up_tool};

/// The tests of `agree.py`, each a process.
const AGREE: [&str; 5] = ["certify", "simulate", "index", "stability_map", "refusals"];

/// The test of `examples/map.py`.
const EXAMPLE: &str = "the_example_draws_its_map";

/// The example without dependencies.
const IGNORED: &str = "without_python_these_tests_are_ignored";

/// The packages for the build of the package, and for its example.
const FROM_PYPI: [&str; 3] = ["maturin>=1.9,<2", "numpy", "matplotlib"];

fn main() -> ExitCode {
    let arguments = Arguments::from_args();
    // A list of the tests, or other tests, need no Python.
    let wanted = |name: &str| arguments.filter.as_ref().is_none_or(|part| name.contains(part));
    let looks = !arguments.list && AGREE.into_iter().chain([EXAMPLE, IGNORED]).any(wanted);
    let environment = Environment::kept();
    let missing = looks.then(|| environment.set_up()).and_then(Result::err);
    if let Some(why) = &missing {
        eprintln!("skipped: tests/python runs the package for Python: {why}");
    } else if looks {
        environment.install();
    }
    let trial = |name: &'static str| {
        let run = move || {
            run(name);
            Ok(())
        };
        let trial = Trial::test(name, run).with_ignored_flag(missing.is_some());
        if missing.is_some() { trial.with_kind("no python") } else { trial }
    };
    let trials = AGREE.into_iter().chain([EXAMPLE, IGNORED]).map(trial).collect();
    libtest_mimic::run(&arguments, trials).exit_code()
}

fn run(name: &str) {
    match name {
        EXAMPLE => the_example_draws_its_map(),
        IGNORED => without_python_these_tests_are_ignored(),
        _ => agrees(name),
    }
}

/// A virtual environment of Python's.
struct Environment(PathBuf);

impl Environment {
    /// Beside the builds, and kept, so that nothing is fetched a second time.
    fn kept() -> Self {
        Self(Path::new(env!("CARGO_TARGET_TMPDIR")).join("python"))
    }

    /// A program of it, to be started; other programs of it are found, too.
    fn program(&self, name: &str) -> Command {
        let folder = self.0.join(if cfg!(windows) { "Scripts" } else { "bin" });
        let mut path = folder.clone().into_os_string();
        if let Some(rest) = std::env::var_os("PATH") {
            path.push(if cfg!(windows) { ";" } else { ":" });
            path.push(rest);
        }
        let mut command = Command::new(folder.join(name));
        command.env("PATH", path).env("MPLBACKEND", "Agg").env("PYTHONDONTWRITEBYTECODE", "1");
        command.stdin(Stdio::null());
        command
    }

    fn pip(&self, arguments: &[&str]) -> Command {
        let mut pip = self.program("python");
        // One try: without a network every further one takes its time, and fails, too.
        pip.args(["-m", "pip", "--disable-pip-version-check", "--retries", "1", "install"]);
        pip.args(["--quiet"]).args(arguments);
        pip
    }

    /// Creates it, with the packages that the package needs.
    ///
    /// # Errors
    /// Where there is no Python, or no PyPI.
    fn set_up(&self) -> Result<(), String> {
        set_up_tool("python3")?;
        // Debian has the part that puts pip into an environment in a package of its own.
        set_up_package("python3-venv", &["python3", "-c", "import ensurepip"])?;
        if !self.0.join("pyvenv.cfg").exists() {
            let made = finished(Command::new("python3").args(["-m", "venv"]).arg(&self.0));
            made.map_err(|why| {
                // An incomplete environment would lack pip the next time, too.
                std::fs::remove_dir_all(&self.0).ok();
                format!("python3 -m venv: {why}")
            })?;
        }
        finished(&mut self.pip(&FROM_PYPI)).map_err(|why| format!("pip has no PyPI: {why}"))
    }

    /// Installs the package from this checkout as a user does, but compiled as tests are. The build tools are
    /// in the environment, so that pip does not fetch them.
    ///
    /// # Panics
    /// Where it cannot be installed.
    fn install(&self) {
        let package = root().join("analysis/python");
        let mut pip = self.pip(&["--no-build-isolation", "--no-deps", "--force-reinstall"]);
        let target = Path::new(env!("CARGO_TARGET_TMPDIR")).parent().unwrap();
        pip.arg(&package).env("MATURIN_PEP517_ARGS", "--profile dev --locked");
        pip.env("CARGO_TARGET_DIR", target);
        finished(&mut pip).unwrap_or_else(|why| panic!("{}: {why}", package.display()));
    }
}

/// Runs a program to its end.
///
/// # Errors
/// The last lines of its output, if it fails.
fn finished(command: &mut Command) -> Result<(), String> {
    let output = command.output().map_err(|error| error.to_string())?;
    if output.status.success() {
        return Ok(());
    }
    let said = [output.stdout, output.stderr].concat();
    let said = String::from_utf8_lossy(&said);
    let last: Vec<&str> =
        said.lines().rev().filter(|line| !line.trim().is_empty()).take(20).collect();
    Err(last.into_iter().rev().collect::<Vec<_>>().join("\n"))
}

/// Runs a file of Python in a folder of its own; returns its output.
fn python(folder: &Path, file: &str, arguments: &[&str]) -> String {
    let mut python = Environment::kept().program("python");
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

/// They do not count as passed: runs this program again, with a path that has no programs.
fn without_python_these_tests_are_ignored() {
    let this = std::env::current_exe().unwrap();
    let run = Command::new(this).env("PATH", "/nowhere").output().unwrap();
    assert!(run.status.success(), "{run:?}");
    let (shown, said) =
        (String::from_utf8(run.stdout).unwrap(), String::from_utf8(run.stderr).unwrap());
    assert_eq!(shown.matches("test [no python] ").count(), AGREE.len() + 2, "{shown}");
    assert!(shown.contains("0 passed; 0 failed; 7 ignored"), "{shown}");
    assert!(said.contains("skipped: ") && said.contains("apt install python3"), "{said}");
}
