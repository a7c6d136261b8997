//! Shared by the tests of the program: a scene, and the program as a process.

use std::io::{BufRead, BufReader, Write};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output, Stdio};

use serde_json::Value;
use tempfile::TempDir;

/// The paper's delayed wall, which certifies.
pub const WALL: &str = r#"name = "delayed wall"
[device]
inertia = 2.2e-5
damping = 0.022
[servo]
period = 0.001
[coupling]
stiffness = 44.0
[environment]
type = "damper-wall"
stiffness = 22.0
damping = 0.01
delay = 1
"#;

/// Its simulation, for a report that shows it.
pub const MOTION: &str = r#"
[simulation]
samples = 300
torque_sine = { amplitude = 1.5, omega = 60.0, phase = 0.0 }
[human]
inertia = 1e-4
damping = 0.02
stiffness = 4.0
[limits]
torque = 0.5
"#;

/// The program, to be started.
pub fn program(arguments: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_haptic"));
    command.args(arguments);
    command
}

/// Runs the program with an empty standard input.
pub fn haptic(arguments: &[&str]) -> Output {
    program(arguments).stdin(Stdio::null()).output().unwrap()
}

/// Runs the program with something on its standard input.
pub fn haptic_reading(arguments: &[&str], input: &[u8]) -> Output {
    let mut child = program(arguments)
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let mut stdin = child.stdin.take().unwrap();
    let input = input.to_vec();
    // A program that has seen enough may close its input.
    let writer = std::thread::spawn(move || drop(stdin.write_all(&input)));
    let output = child.wait_with_output().unwrap();
    writer.join().unwrap();
    output
}

/// A simulated board as a process, behind a socket; ends with this.
pub struct BoardProcess {
    pub process: Child,
    pub port: String,
    _folder: TempDir,
}

impl BoardProcess {
    /// With the program of a scene, and more arguments; once it listens.
    pub fn start(scene: &str, more: &[&str]) -> Self {
        let folder = TempDir::new().unwrap();
        let port = format!("unix:{}", folder.path().join("board").display());
        let arguments = [&["board-sim", scene, "--port", &port], more].concat();
        let mut process = program(&arguments).stdout(Stdio::piped()).spawn().unwrap();
        let mut said = BufReader::new(process.stdout.take().unwrap()).lines();
        assert_eq!(said.next().unwrap().unwrap(), format!("{scene} listens on {port}"));
        Self { process, port, _folder: folder }
    }

    /// The exit status and the answer of `haptic tune --json`.
    pub fn tune(&self, arguments: &[&str]) -> (Option<i32>, Value) {
        let output = haptic(&[&["tune", "--json", "--port", &self.port], arguments].concat());
        (output.status.code(), answer(&output))
    }
}

impl Drop for BoardProcess {
    fn drop(&mut self) {
        // It may have ended by itself.
        let _ = self.process.kill();
        let _ = self.process.wait();
    }
}

/// The program itself, set up.
///
/// # Panics
/// Where it cannot be installed, with the package to install.
pub fn tool(name: &str) -> &str {
    analysis::toolchain::set_up_tool(name)
        .unwrap_or_else(|error| panic!("this test runs {name}: {error}"));
    name
}

/// The JSON object of an answer.
pub fn answer(output: &Output) -> Value {
    serde_json::from_slice(&output.stdout).unwrap_or_else(|error| panic!("{error}: {output:?}"))
}

/// The message for invalid input, which has exit status 2 and no answer.
pub fn complaint(output: Output) -> String {
    assert_eq!(output.status.code(), Some(2), "{output:?}");
    assert!(output.stdout.is_empty(), "{output:?}");
    String::from_utf8(output.stderr).unwrap()
}

/// The repository.
pub fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap().to_path_buf()
}

/// A file's text.
pub fn read(path: impl AsRef<Path>) -> String {
    let path = path.as_ref();
    std::fs::read_to_string(path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}
