//! The `haptic` program; see [`analysis::command`].

use std::io;
use std::process::ExitCode;
use std::sync::atomic::{AtomicBool, Ordering};

use analysis::command::{Arguments, execute};
use nix::fcntl::{FcntlArg, fcntl};

/// Whether the program was started without a standard output. The runtime puts /dev/null in its place
/// before `main`, and an answer would be lost there as if somebody had read it.
static HAS_NO_OUTPUT: AtomicBool = AtomicBool::new(false);

extern "C" fn look() {
    HAS_NO_OUTPUT.store(fcntl(io::stdout(), FcntlArg::F_GETFD).is_err(), Ordering::Relaxed);
}

// SAFETY: the C library calls what is listed there once, before `main`, and `look` needs nothing that
// begins with `main`.
#[cfg(target_os = "linux")]
#[used]
#[unsafe(link_section = ".init_array")]
static LOOK: extern "C" fn() = look;

fn main() -> ExitCode {
    if HAS_NO_OUTPUT.load(Ordering::Relaxed) {
        eprintln!(
            "error: standard output is closed; `>/dev/null` is for an answer that nobody wants"
        );
        return ExitCode::from(2);
    }
    execute(Arguments::of_program())
}
