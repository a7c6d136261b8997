//! Progress on standard error: a bar on a terminal, and otherwise one line for what takes long.

use std::ops::Deref;
use std::sync::mpsc::{RecvTimeoutError, Sender, channel};
use std::thread;
use std::time::Duration;

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

use crate::terminal;

/// Steps between two updates of the bar; a step is far shorter than a glance.
const STRIDE: u64 = 64;
/// Longest duration of work without a line.
const SILENCE: Duration = Duration::from_secs(2);

/// The progress of some work, until it is dropped.
pub struct Progress {
    bar: ProgressBar,
    /// Closed by the end of the work.
    _end: Sender<()>,
}

impl Progress {
    fn show(bar: ProgressBar, what: &str) -> Self {
        bar.set_message(what.to_owned());
        let (end, ended) = channel();
        if bar.is_hidden() {
            let line = format!("in progress: {what}");
            thread::spawn(move || {
                if ended.recv_timeout(SILENCE) == Err(RecvTimeoutError::Timeout) {
                    eprintln!("{line}");
                }
            });
        }
        Self { bar, _end: end }
    }

    /// Ends it, and removes it from the terminal.
    pub fn finish_and_clear(self) {}
}

impl Deref for Progress {
    type Target = ProgressBar;

    fn deref(&self) -> &ProgressBar {
        &self.bar
    }
}

impl Drop for Progress {
    fn drop(&mut self) {
        self.bar.finish_and_clear();
    }
}

/// A bar over this many steps, with a name for them.
pub fn bar(steps: u64, what: &str) -> Progress {
    let bar = ProgressBar::with_draw_target(Some(steps), target());
    // The template is a constant; were it wrong, the plain bar would do.
    if let Ok(style) = ProgressStyle::with_template("{msg:>18} [{bar:40}] {pos}/{len} {eta}") {
        bar.set_style(style.progress_chars("=> "));
    }
    Progress::show(bar, what)
}

/// Standard error, unless its terminal cannot move its cursor back.
fn target() -> ProgressDrawTarget {
    if terminal::is_dumb() {
        ProgressDrawTarget::hidden()
    } else {
        ProgressDrawTarget::stderr_with_hz(10)
    }
}

/// A spinner for work that has no steps to count.
pub fn spinner(what: &str) -> Progress {
    let spinner = ProgressBar::with_draw_target(None, target());
    spinner.enable_steady_tick(Duration::from_millis(120));
    Progress::show(spinner, what)
}

/// Something to call once a step.
pub fn stepper(bar: &ProgressBar) -> impl FnMut() + '_ {
    let mut steps = 0;
    move || {
        steps += 1;
        if steps % STRIDE == 0 {
            bar.inc(STRIDE);
        }
    }
}
