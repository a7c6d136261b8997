//! The program's output on a terminal: its colours and its lines.

use std::fs::OpenOptions;
use std::io::{Read, Write};
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use analysis::board_sim::Pacing;
use serialport::{SerialPort, TTYPort};

use crate::common::{WALL, haptic, program};
use crate::wire::off;

/// The program's output on a terminal of this many columns, and its exit status. Both of its outputs are the
/// terminal.
fn shown(arguments: &[&str], columns: u32, environment: &[(&str, &str)]) -> (String, Option<i32>) {
    let (mut master, mut slave) = TTYPort::pair().unwrap();
    slave.set_exclusive(false).unwrap();
    let path = slave.name().unwrap();
    let open = || OpenOptions::new().read(true).write(true).open(&path).unwrap();
    let size = ["cols", &columns.to_string(), "rows", "20"].map(str::to_owned);
    assert!(Command::new("stty").args(size).stdin(open()).status().unwrap().success());
    let mut child = program(arguments);
    for decides in ["NO_COLOR", "CI", "CLICOLOR", "CLICOLOR_FORCE"] {
        child.env_remove(decides);
    }
    child.env("TERM", "xterm").envs(environment.iter().copied());
    let mut child = child.stdin(Stdio::null()).stdout(open()).stderr(open()).spawn().unwrap();
    master.set_timeout(Duration::from_millis(200)).unwrap();
    let (mut bytes, mut chunk) = (Vec::new(), [0; 4096]);
    loop {
        let ended = child.try_wait().unwrap();
        match master.read(&mut chunk) {
            Ok(read) => bytes.extend_from_slice(&chunk[..read]),
            Err(_) if ended.is_some() => break,
            Err(_) => {}
        }
    }
    (String::from_utf8(bytes).unwrap(), child.wait().unwrap().code())
}

#[test]
#[cfg_attr(no_terminals, ignore = "this machine has no pseudo-terminals")]
fn colours_are_for_terminals_that_have_them_and_people_who_want_them() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("bad.toml");
    std::fs::write(&path, WALL.replace("0.001", "0")).unwrap();
    let bad = path.to_str().unwrap();
    let coloured = |arguments: &[&str], environment: &[(&str, &str)]| {
        let (text, status) = shown(arguments, 80, environment);
        assert!(!text.is_empty());
        (text.contains('\u{1b}'), status)
    };
    for (arguments, status) in
        [(&["certify", bad][..], 2), (&["certify", "--hlp"], 2), (&["--help"], 0)]
    {
        assert_eq!(coloured(arguments, &[]), (true, Some(status)), "{arguments:?}");
        for plain in [("NO_COLOR", "1"), ("TERM", "dumb")] {
            // A build server sets `CI`, which does not switch colours on.
            for environment in [&[plain][..], &[plain, ("CI", "true")]] {
                assert_eq!(
                    coloured(arguments, environment),
                    (false, Some(status)),
                    "{arguments:?} {environment:?}"
                );
            }
        }
    }
}

#[test]
#[cfg_attr(no_terminals, ignore = "this machine has no pseudo-terminals")]
fn messages_answers_and_help_are_as_wide_as_the_terminal() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("scene.toml");
    std::fs::write(&path, WALL.replace("damping = 0.01\n", "damping = 0.02\n")).unwrap();
    let scene = path.to_str().unwrap();
    for arguments in [
        &["certify", scene][..],
        &["run", "no_such_scene"],
        &["scope", "--help"],
        &["schema", "--example", "wall"],
    ] {
        let plain = [("NO_COLOR", "1")];
        let (narrow, _) = shown(arguments, 60, &plain);
        let longest = narrow.lines().map(|line| line.trim_end().chars().count()).max();
        assert!(longest.is_some_and(|longest| longest <= 60), "{longest:?}\n{narrow}");
    }
    // A pipe gets whole lines.
    let piped = String::from_utf8(haptic(&["certify", scene]).stdout).unwrap();
    assert!(piped.lines().any(|line| line.chars().count() > 100), "{piped}");
}

/// Prints the terminal's settings, runs a command, and prints its number, its status and the settings again.
const WATCHED: &str =
    r#"stty -g; "$@" & echo "number $!."; wait $!; echo "status $?."; stty -g; echo finished"#;

#[test]
#[cfg_attr(no_terminals, ignore = "this machine has no pseudo-terminals")]
fn the_live_view_gives_the_terminal_back_however_it_ends() {
    let (_, rig) = off(Pacing::RealTime);
    for end in ["q", "\u{3}", "INT", "TERM", "HUP"] {
        let (mut master, mut slave) = TTYPort::pair().unwrap();
        slave.set_exclusive(false).unwrap();
        master.set_timeout(Duration::from_millis(200)).unwrap();
        let path = slave.name().unwrap();
        let open = || OpenOptions::new().read(true).write(true).open(&path).unwrap();
        let scope = program(&["scope", "--port", &rig.port()]);
        let mut watched = Command::new("setsid");
        watched.args(["--ctty", "sh", "-c", WATCHED, "sh"]).arg(scope.get_program());
        watched.args(scope.get_args()).env("TERM", "xterm");
        let mut child = watched.stdin(open()).stdout(open()).stderr(open()).spawn().unwrap();
        let mut said = String::new();
        let start = Instant::now();
        let mut until = |words: &str, master: &mut TTYPort| {
            while !said.contains(words) {
                assert!(start.elapsed() < Duration::from_secs(60), "{said}");
                let mut bytes = [0; 4096];
                let read = master.read(&mut bytes).unwrap_or(0);
                said += &String::from_utf8_lossy(&bytes[..read]);
            }
            said.clone()
        };
        let shown = until("q quits", &mut master);
        if end.len() == 1 {
            master.write_all(end.as_bytes()).unwrap();
        } else {
            let number = shown.split("number ").nth(1).unwrap().split('.').next().unwrap();
            assert!(Command::new("kill").args(["-s", end, number]).status().unwrap().success());
        }
        let said = until("finished", &mut master);
        child.wait().unwrap();
        let lines: Vec<&str> = said.lines().collect();
        let [before, .., status, after, _finished] = lines.as_slice() else { panic!("{said}") };
        assert_eq!(before, after, "{end:?}");
        // Lines wrap again, the cursor is back, and so is the first screen.
        assert!(
            status.ends_with("\u{1b}[?7h\u{1b}[?25h\u{1b}[?1049lstatus 0."),
            "{end:?}: {status:?}"
        );
    }
}
