//! Missed ticks: a limit computed for the nominal period.

use haptic_servo::scene::{Scene, Timing};

use super::case::{CaseResult, FailureError};
use super::method_result::{MethodResult, MethodVerdict};
use super::motion::Outcome;
use super::setting::{KNOB, KNOBS, PERIOD, loop_run, rigid, wall_of};
use crate::missed::Missed;

/// Springs at 0.95 of the limit for the nominal period, and for the worst period.
pub fn missed_ticks() -> Result<CaseResult, FailureError> {
    let limit = 2.0 * KNOB.damping / PERIOD;
    let nominal = rigid(KNOB, wall_of(0.95 * limit, 0.0, 0));
    let twice = |scene: Scene| Scene {
        timing: Timing { worst_period: Some(2.0 * PERIOD), ..scene.timing },
        ..scene
    };
    let reason = "K < 2b/T allows {} N m/rad";
    let punctual =
        loop_run("no tick missed", &nominal, KNOBS, Outcome::Converges).pushed(1.0, 6000);
    let methods = vec![
        MethodResult::new("K < 2b/T, T as meant", MethodVerdict::Safe, limit, reason),
        MethodResult::simulated("simulation in time", &punctual)?,
    ];
    let mut grows = loop_run("0.95 of 2b/T", &nominal, KNOBS, Outcome::Diverges).pushed(5.0, 3000);
    grows.experiment.missed = Missed::Random { fraction: 0.1, seed: 1 };
    let half = twice(rigid(KNOB, wall_of(0.95 * 0.5 * limit, 0.0, 0)));
    let mut rests =
        loop_run("0.95 of 2b/T_max", &half, KNOBS, Outcome::Converges).pushed(1.0, 6000);
    rests.experiment.missed = Missed::Every(2);
    let truth = MethodResult::simulated("simulation, a tenth of the ticks missed", &grows)?;
    Ok(CaseResult::of(&twice(nominal), methods, truth, [grows, rests]))
}
