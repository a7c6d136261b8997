//! Shared by the tests of the program: a scene, and the program as a process.

pub mod board;

use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};

use serde_json::Value;

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
    with_input(&mut program(arguments), input)
}

/// Runs a program with something on its standard input.
pub fn with_input(program: &mut Command, input: &[u8]) -> Output {
    program.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped());
    let mut child = program.spawn().unwrap();
    let mut stdin = child.stdin.take().unwrap();
    let input = input.to_vec();
    // A program that has seen enough may close its input.
    let writer = std::thread::spawn(move || drop(stdin.write_all(&input)));
    let output = child.wait_with_output().unwrap();
    writer.join().unwrap();
    output
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

/// The documents of users, as paths from the repository.
pub fn documents() -> Vec<String> {
    let folders = ["", "docs/", "firmware/", "analysis/virtual-board/"];
    let of_folder = |folder: &str| {
        let files = std::fs::read_dir(root().join(folder)).unwrap();
        let names = files.map(|file| file.unwrap().file_name().into_string().unwrap());
        let documents = names.filter(|name| name.ends_with(".md"));
        documents.map(|name| format!("{folder}{name}")).collect::<Vec<_>>()
    };
    folders.into_iter().flat_map(of_folder).collect()
}

/// A file's text.
pub fn read(path: impl AsRef<Path>) -> String {
    let path = path.as_ref();
    std::fs::read_to_string(path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}
