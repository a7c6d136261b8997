//! A headless browser, which shows pages as a reader's browser does.

use std::io::Read;
use std::path::Path;
use std::process::Stdio;
use std::time::{Duration, Instant};

use analysis::browser::{NAME, TIMEOUT, command};
use analysis::toolchain::set_up_tool;

/// Makes sure that a browser is installed.
///
/// # Errors
/// Where it cannot be installed, with the package to install.
pub fn set_up() -> Result<(), String> {
    set_up_tool(NAME)
}

/// The page after its scripts have run, in a window of this width in pixels.
pub fn dom(page: &Path, width: u32) -> String {
    let profile = tempfile::tempdir().unwrap();
    let mut child = command(profile.path(), [width, 1200])
        .args(["--virtual-time-budget=2000", "--dump-dom"])
        .arg(format!("file://{}", page.display()))
        .stdout(Stdio::piped())
        .spawn()
        .unwrap();
    let mut stdout = child.stdout.take().unwrap();
    let reader = std::thread::spawn(move || {
        let mut text = String::new();
        stdout.read_to_string(&mut text).map(|_| text)
    });
    let start = Instant::now();
    while child.try_wait().unwrap().is_none() {
        if start.elapsed() > TIMEOUT {
            child.kill().unwrap();
            child.wait().unwrap();
            panic!("the browser did not end within {TIMEOUT:?}");
        }
        std::thread::sleep(Duration::from_millis(20));
    }
    reader.join().unwrap().unwrap()
}
