//! The result of a run as text.

use haptic_model::host::HostRun;
use haptic_servo::dac::DacCode;
use haptic_servo::host::HostTorque;
use haptic_servo::text::RoundUp3;

use crate::compare_run::RunOutcome;
use crate::program::Program;
use crate::quantity::significant;
use crate::studies::bench::at_rest::friction_to_rest;
use crate::verdict::VerdictReport;

/// The result of a run as text.
pub fn text(outcome: &RunOutcome) -> String {
    let run = &outcome.run;
    let mut rows = vec![
        ("ticks", run.ticks.len().to_string()),
        ("peak torque", format!("{} N m", significant(run.peak_torque(), 4))),
    ];
    if let Some(energy) = outcome.energy {
        let millijoule = |joule: f64| format!("{} mJ", significant(1e3 * joule, 4));
        rows.push(("energy the hand put in", millijoule(energy.given)));
        rows.push(("energy the hand got back", millijoule(energy.got_back)));
    }
    if let Some(board) = &outcome.board {
        rows.push(("codes equal", format!("{} of {}", run.equal, run.ticks.len())));
        let (compute, whole) = (board.compute(), board.interrupt());
        let compute = compute.map_or(String::new(), |compute| {
            let mean = significant(compute.mean, 3);
            format!("{} to {} from count to code, {mean} on average; ", compute.min, compute.max)
        });
        let whole = significant(whole.mean, 3);
        let text = format!("{compute}{whole} on average in the whole interrupt");
        rows.push(("instructions per tick", text));
    }
    let rows: String = rows.iter().map(|(label, value)| format!("{label}: {value}\n")).collect();
    rows + &outcome.host.as_ref().map_or_else(String::new, of_host)
}

/// What a host wanted, and what the hand took of its budget.
fn of_host(host: &HostRun) -> String {
    let HostRun { law, budget: HostTorque { energy, power, torque, .. }, .. } = host;
    let ((refused, ticks), (most, time)) = (host.refused(), host.most());
    let percent = |part: f64| significant(100.0 * part, 3);
    let millijoules = |joules: f64| significant(1e3 * joules, 4);
    let mut shown = format!(
        "host: {law}, at most {torque} N m; budget {energy} J and {power} W\n\
         refused: {} % of the torque that it wanted, in {ticks} of {} ticks\n\
         energy taken from the host, and the budget:\n",
        percent(refused),
        host.ticks.len()
    );
    for tick in host.rows() {
        let [time, taken, budget] = [
            significant(host.time(tick), 4),
            millijoules(host.taken[tick]),
            millijoules(host.budget_at(tick)),
        ];
        shown += &format!("  {:>10} {taken:>9} mJ of {budget} mJ\n", format!("{time} s"));
    }
    shown + &format!("most of the budget: {} % at {} s\n", percent(most), significant(time, 4))
}

/// The output for a scene that ran on a board: its verdict and its motion.
pub fn section(program: &Program, report: &VerdictReport, outcome: &RunOutcome) -> String {
    let damping = |value: Option<f64>| {
        value.map_or("none".to_owned(), |value| format!("{} N m s/rad", significant(value, 6)))
    };
    let verdict = format!("{:?}", report.verdict).to_lowercase();
    let rows = [
        ("verdict", verdict),
        ("alpha", damping(report.alpha.hi)),
        ("delta", damping(Some(report.delta))),
        ("margin", report.margin_on_board_in_words().unwrap_or_else(|| "none".to_owned())),
    ];
    let mut shown = format!("{}\n", report.name);
    for (label, value) in rows {
        shown += &format!("  {label}: {value}\n");
    }
    for line in text(outcome).lines() {
        shown += &format!("  {line}\n");
    }
    shown + &coasting(program, outcome)
}

/// Speed in rad/s above which a device counts as turning: above half a turn in an hour.
const AT_REST: f64 = 1e-3;

/// The text on a released device that keeps turning: the DAC or the converter of the current rounds, on a
/// spring the encoder rounds, too, and the simulated device has no friction. In the linear theory it stops.
fn coasting(program: &Program, outcome: &RunOutcome) -> String {
    let speed = outcome.final_speed.unwrap_or(0.0);
    let ended = outcome.run.ticks.len() as f64 * program.scene.timing.period;
    if speed < AT_REST || ended < (program.trajectory)().release {
        return String::new();
    }
    let friction = if is_held_by_a_spring(program) {
        let friction = RoundUp3(friction_to_rest(program));
        let steps = if program.bridge.is_some() { "current loop" } else { "DAC" };
        format!("that the encoder's and the {steps}'s steps ask for, {friction} N m,")
    } else if let Some(current_loop) = program.bridge {
        let friction = RoundUp3(current_loop.resolution().deviation);
        format!("against the remaining error of the current loop, {friction} N m,")
    } else {
        let full_scale = program.transducers.full_scale_torque;
        let half_step = 0.5 * full_scale / f64::from(DacCode::CODES_TO_FULL_SCALE);
        format!("of half a DAC step, {} N m,", significant(half_step, 2))
    };
    let speed = significant(speed, 2);
    format!("  still turning at the end: {speed} rad/s; friction {friction} stops it\n")
}

/// Whether a released device is on a spring at every position.
fn is_held_by_a_spring(program: &Program) -> bool {
    program
        .scene
        .environment
        .wall()
        .is_some_and(|wall| !wall.is_one_sided() && wall.stiffness > 0.0)
}
