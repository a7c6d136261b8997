//! Missed ticks: a limit that was computed for the period that was meant.

use firmware::scene::{Scene, Timing};

use super::case::{FailureError, Study};
use super::claim::{Claim, Says};
use super::fate::End;
use super::setting::{KNOB, KNOBS, PERIOD, rigid, trial, wall_of};
use crate::missed::Missed;

/// 0.95 of the limit of the nominal period, and of that of the worst one.
pub fn missed_ticks() -> Result<Study, FailureError> {
    let limit = 2.0 * KNOB.damping / PERIOD;
    let nominal = rigid(KNOB, wall_of(0.95 * limit, 0.0, 0));
    let twice = |scene: Scene| Scene {
        timing: Timing { worst_period: Some(2.0 * PERIOD), ..scene.timing },
        ..scene
    };
    let because = "K < 2b/T allows {} N m/rad";
    let punctual = trial("no tick missed", &nominal, KNOBS, End::Rests).pushed(1.0, 6000);
    let claims = vec![
        Claim::new("K < 2b/T, T as meant", Says::Safe, limit, because),
        Claim::simulated("simulation in time", &punctual)?,
    ];
    let certificate = Claim::certificate(&twice(nominal));
    let mut grows = trial("0.95 of 2b/T", &nominal, KNOBS, End::Grows).pushed(5.0, 3000);
    grows.experiment.missed = Missed::Random { fraction: 0.1, seed: 1 };
    let half = twice(rigid(KNOB, wall_of(0.95 * 0.5 * limit, 0.0, 0)));
    let mut rests = trial("0.95 of 2b/T_max", &half, KNOBS, End::Rests).pushed(1.0, 6000);
    rests.experiment.missed = Missed::Every(2);
    let truth = Claim::simulated("simulation, a tenth of the ticks missed", &grows)?;
    Ok(Study { claims, certificate, truth, trials: vec![grows, rests] })
}
