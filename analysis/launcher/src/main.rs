//! The program of `cargo haptic`: builds the program `haptic` and executes it.
//!
//! `cargo run --quiet` would be silent for the minutes of the first build, and without `--quiet` would add
//! its lines to every output. This program is silent if there is nothing to build. It writes to standard
//! error only, and its exit status is that of `haptic`.

use std::env;
use std::io::{self, IsTerminal, Write};
use std::os::unix::process::CommandExt;
use std::process::{Child, Command, ExitCode, ExitStatus, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};

/// Longest duration of a build without a message: longer than a check for changes.
const SILENCE: Duration = Duration::from_secs(2);
/// Time between two polls of a build.
const LOOK: Duration = Duration::from_millis(20);

fn main() -> ExitCode {
    match launch() {
        Ok(code) => code,
        Err(error) => {
            eprintln!("error: haptic could not be built and started: {error}");
            ExitCode::from(2)
        }
    }
}

/// Returns only if the build fails; cargo has printed the reason.
fn launch() -> io::Result<ExitCode> {
    let cargo = env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    let mut build = Command::new(cargo);
    build.args(["build", "--quiet", "--package", "analysis", "--bin", "haptic"]);
    // Standard input is for `haptic`.
    if !wait(build.stdin(Stdio::null()).spawn()?)?.success() {
        return Ok(ExitCode::from(2));
    }
    // Cargo puts both programs of a profile in one folder.
    let haptic = env::current_exe()?.with_file_name("haptic");
    Err(Command::new(haptic).args(env::args_os().skip(1)).exec())
}

/// Waits for a build: silently at first, then with a line; at a terminal the line counts seconds and
/// disappears at the end.
fn wait(mut build: Child) -> io::Result<ExitStatus> {
    let start = Instant::now();
    let shows = io::stderr().is_terminal();
    let mut shown = None;
    let status = loop {
        if let Some(status) = build.try_wait()? {
            break status;
        }
        let seconds = start.elapsed().as_secs();
        if start.elapsed() > SILENCE && (shown.is_none() || shows && shown != Some(seconds)) {
            show(seconds, shows);
            shown = Some(seconds);
        }
        sleep(LOOK);
    };
    if shown.is_some() && shows {
        eprint!("\r\x1b[K");
    }
    Ok(status)
}

fn show(seconds: u64, shows: bool) {
    const WHAT: &str = "building haptic, which takes minutes the first time";
    // If this fails, no other output is possible.
    let _ = match shows {
        true => write!(io::stderr(), "\r{WHAT} ({seconds} s)\x1b[K"),
        false => writeln!(io::stderr(), "{WHAT}"),
    };
}
