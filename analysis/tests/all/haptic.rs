//! The program as a process: exit status, standard output, standard error.

use std::io::{Read, Write};
use std::process::{Output, Stdio};

use crate::common::{haptic_reading as haptic, program};
use analysis::file::MAX_BYTES;
use serde_json::Value;

const WALL: &str = r#"{"name": "wall", "device": {"inertia": 2.2e-5, "damping": 0.022}, "servo": {"period": 0.001}, "coupling": {"stiffness": 44}, "environment": {"type": "damper-wall", "stiffness": 22, "damping": 0.01, "delay": 1}}"#;

fn lines(output: &Output) -> Vec<Value> {
    let text = String::from_utf8(output.stdout.clone()).unwrap();
    text.lines().map(|line| serde_json::from_str(line).unwrap()).collect()
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
    ] {
        for (output, status) in [(">/dev/full", 2), (">/dev/null", 0)] {
            assert_eq!(status_into(output, arguments), Some(status), "{arguments:?} {output}");
        }
    }
}

#[test]
fn a_batch_answers_line_for_line_in_order() {
    let scene = |index: usize| WALL.replace("\"wall\"", &format!("\"scene {index}\""));
    let mut input: Vec<Vec<u8>> = (0..3000).map(|index| scene(index).into_bytes()).collect();
    input[7] = b"nonsense".to_vec();
    input[8] = b"".to_vec();
    input[9] = b"{\"name\": \"\xff\"}".to_vec();
    input[10] = vec![b'x'; MAX_BYTES as usize + 1];
    // A profile or a map may make a scene long.
    input[11].extend(vec![b' '; 200_000]);
    let output = haptic(&["certify", "--batch", "-"], &input.join(&b'\n'));
    assert_eq!(output.status.code(), Some(0));
    let answers = lines(&output);
    assert_eq!(answers.len(), input.len());
    for (index, answer) in answers.iter().enumerate() {
        if (7..=10).contains(&index) {
            let error = answer["error"].as_str().unwrap();
            assert!(error.starts_with(&format!("<stdin>:{}:", index + 1)), "{error}");
            assert!(error.len() < 300);
            assert_eq!(
                error.contains("the line is longer than 4194304 bytes"),
                index == 10,
                "{error}"
            );
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

/// The size is that of the flashed board, and not of the smallest.
#[test]
#[ignore = "builds for minutes"]
fn flash_says_how_much_the_board_has() {
    let arguments = ["flash", "damper_wall", "--board", "nucleo-g474re", "--build-only"];
    let built = haptic(&arguments, b"");
    assert!(built.status.success(), "{}", String::from_utf8_lossy(&built.stderr));
    let said = String::from_utf8(built.stdout).unwrap();
    let note = String::from_utf8(built.stderr).unwrap();
    assert!(note.contains("damper_wall is for a device of the examples"), "{note}");
    let size = " of 524288 bytes; the linker's map, which fits every board, allows 131072\n";
    assert!(said.contains("flash: ") && said.contains(size), "{said}");
}

#[test]
fn json_has_the_fields_of_the_contract_and_nothing_else_is_printed() {
    let output = haptic(&["certify", "--json", "-"], WALL.as_bytes());
    assert!(output.stderr.is_empty(), "{output:?}");
    let [Value::Object(answer)] = &lines(&output)[..] else { panic!("one object") };
    let mut fields: Vec<&str> = answer.keys().map(String::as_str).collect();
    fields.sort_unstable();
    let fields = fields.join(" ");
    let wanted = "alpha alpha_coupled assumptions delta felt_stiffness free_damping margin message name on_board \
                  reason remedies rules theta verdict";
    assert_eq!(fields, wanted);
}
