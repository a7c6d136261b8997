//! Sessions with the program: commands in a folder, their exit status, and parts of what they say.
//!
//! A session is a text file in `sessions`, which begins with `wall.toml` in its folder:
//! - `file NAME` and lines up to an empty one, or `file NAME = OTHER && FROM => TO`: a file is written.
//! - `board NAME`: the simulated board of a program is started, which listens on `--port PORT`.
//! - `STATUS | ARGUMENTS | WORDS | ...`: a command is run. `STATUS` may name several. `< FILE` and `> FILE`
//!   are its input and output. `WORDS` are part of the output, or of a file behind `FILE: `; `!WORDS` are not.
//!
//! See `cases.rs` for what shortens both.

use std::path::Path;

use analysis::board_sim::Pacing;
use tempfile::TempDir;

use crate::cases::{alternatives, changed, fields, lines, words};
use crate::common::board::{Rig, Still};
use crate::common::{WALL, program, read, with_input};

/// The pictures of the documents, and what they are drawn of.
const PICTURES: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/pictures");

fn play(session: &str) {
    let folder = TempDir::new().unwrap();
    let folder = folder.path();
    std::fs::write(folder.join("wall.toml"), WALL).unwrap();
    let (mut lines, mut board) = (lines(session), None);
    while let Some(line) = lines.next() {
        if let Some(file) = line.strip_prefix("file ") {
            let (name, text) = match file.split_once(" = ") {
                Some((name, change)) => {
                    let (other, changes) = change.split_once(" && ").expect("a change");
                    (name, changed(&read(folder.join(other)), &changes.replace("\\n", "\n")))
                }
                None => {
                    let text = lines.by_ref().take_while(|line| !line.is_empty());
                    (file, text.map(|line| line + "\n").collect())
                }
            };
            std::fs::write(folder.join(name), text).unwrap();
            continue;
        }
        if let Some(name) = line.strip_prefix("board ") {
            board = Some(Rig::start(name, Still(300), Pacing::Unthrottled));
            continue;
        }
        let port = board.as_ref().map_or_else(String::new, Rig::port);
        let line = line.replace("--port PORT", &format!("--port {port}"));
        for case in alternatives(&line).iter().filter(|case| !case.is_empty()) {
            run(folder, case);
        }
    }
}

/// Runs a command and checks what it says.
fn run(folder: &Path, case: &str) {
    let fields = fields(case);
    let (command, into) = fields[1].split_once(" > ").unwrap_or((&fields[1], ""));
    let (command, from) = command.split_once(" < ").unwrap_or((command, ""));
    let words = words(&command.replace("PICTURES", PICTURES));
    let input = if from.is_empty() { String::new() } else { read(folder.join(from)) };
    let output = with_input(program(&[]).args(words).current_dir(folder), input.as_bytes());
    let status = output.status.code().expect("an exit status").to_string();
    let [out, err] = [output.stdout, output.stderr].map(|text| String::from_utf8(text).unwrap());
    if !into.is_empty() {
        std::fs::write(folder.join(into), &out).unwrap();
    }
    let said = format!("{out}{err}");
    assert!(fields[0].contains(&status), "{case}\nexit status {status}: {said}");
    assert!(!said.contains("panicked"), "{case}\n{said}");
    // An answer is on standard output, and a complaint on standard error.
    assert!(status != "2" || out.is_empty() && !err.is_empty(), "{case}\n{said}");
    for word in &fields[2..] {
        let (is_there, word) = word.strip_prefix('!').map_or((true, word.as_str()), |w| (false, w));
        let file = word.split_once(": ").filter(|(name, _)| folder.join(name).is_file());
        let (text, word) = match file {
            Some((name, word)) => (read(folder.join(name)), word),
            None => (said.clone(), word),
        };
        assert_eq!(text.contains(word), is_there, "{case}\n{word:?} in {text}");
        if text.contains("<svg") && !case.contains("tradeoff") {
            assert_grey(&text);
        }
    }
}

/// Red, green and blue are the same in every colour.
fn assert_grey(svg: &str) {
    for colour in svg.split("\"#").skip(1).map(|rest| &rest[..6]) {
        assert!(colour[..2] == colour[2..4] && colour[2..4] == colour[4..], "{colour}");
    }
}

macro_rules! sessions {
    ($($name:ident)*) => {$(
        #[test]
        fn $name() {
            play(include_str!(concat!("sessions/", stringify!($name), ".txt")));
        }
    )*};
}

sessions! { boards certify charts design encoder files filters host identify profiles programs simulate }
