//! Progress bars on standard error: only on a terminal and only for long operations.

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

use crate::terminal;

/// Steps between two updates of the bar; a step is far shorter than a glance.
const STRIDE: u64 = 64;

/// A bar over this many steps, with a name for them. It draws nothing unless standard error is a terminal.
pub fn bar(steps: u64, what: &str) -> ProgressBar {
    let bar = ProgressBar::with_draw_target(Some(steps), target());
    // The template is a constant; were it wrong, the plain bar would do.
    if let Ok(style) = ProgressStyle::with_template("{msg:>18} [{bar:40}] {pos}/{len} {eta}") {
        bar.set_style(style.progress_chars("=> "));
    }
    bar.set_message(what.to_owned());
    bar
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
pub fn spinner(what: &str) -> ProgressBar {
    let spinner = ProgressBar::with_draw_target(None, target());
    spinner.set_message(what.to_owned());
    spinner.enable_steady_tick(std::time::Duration::from_millis(120));
    spinner
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
