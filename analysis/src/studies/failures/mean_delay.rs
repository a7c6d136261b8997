//! The sum of all delays, instead of the effect of a fractional delay between the samples.

use haptic_servo::scene::{Latency, Scene};

use super::case::{CaseResult, FailureError};
use super::method_result::MethodResult;
use super::motion::Outcome;
use super::setting::{PADDLE, PADDLES, PERIOD, loop_run, rigid, wall_of};
use crate::chain::Chain;
use crate::latency_limits::{lag_of, largest_spring};
use crate::simulation::{Experiment, Integration};
use crate::worst_hand::{plant, search};

/// Bandwidth of the current loop in Hz.
const BANDWIDTH: f64 = 3e3;
/// Time in s from a count to its torque.
const DELAY: f64 = 0.5 * PERIOD;
/// Part of the limit that the common formula allows.
const PART: f64 = 0.99;

/// The latency between count and torque.
pub fn latency() -> Latency {
    Latency::delayed(DELAY).with_actuator_lag(lag_of(BANDWIDTH))
}

/// A spring at 0.99 of `b/(T/2 + t_d + tau)`, and one at 0.95 of the certified limit.
pub fn mean_delay() -> Result<CaseResult, FailureError> {
    let spring =
        |stiffness| Scene { latency: latency(), ..rigid(PADDLE, wall_of(stiffness, 0.0, 0)) };
    let limit = PADDLE.damping / (0.5 * PERIOD + DELAY + lag_of(BANDWIDTH));
    let without = PADDLE.damping / (0.5 * PERIOD + lag_of(BANDWIDTH));
    let scene = spring(PART * limit);
    let rule =
        |method, allowed| MethodResult::bound(method, PART * limit, allowed, "allows {} N m/rad");
    let alone = Experiment::still(&scene);
    let by_itself = MethodResult::eigenvalues("in no hand", &alone, Integration::default())?;
    let methods =
        vec![rule("K < b/(T/2 + tau)", without), rule("K < b/(T/2 + t_d + tau)", limit), by_itself];
    let device = Chain::rigid(PADDLE.inertia, PADDLE.damping)?;
    let hand = search(&scene, &device)?.worst;
    let held = Experiment { plant: plant(&device, 1.0, &hand.hand), ..alone };
    let truth =
        MethodResult::eigenvalues("exact exponential, in a hand", &held, Integration::default())?;
    let mut shakes = loop_run("0.99 of it, in that hand", &scene, PADDLES, Outcome::Diverges)
        .with_claimed_passivity(2.0);
    shakes.experiment = Experiment { friction: 0.0, ..held };
    // Until the motion has tripled, with bounds for heavy hands.
    let samples = (4.0 / hand.spectral_radius.ln()).clamp(1000.0, 150_000.0) as usize;
    let certified = spring(0.95 * largest_spring(&PADDLE, PERIOD, latency(), 0));
    let rests = loop_run("0.95 of the certified limit", &certified, PADDLES, Outcome::Converges);
    let runs = [shakes.pushed(1.0, samples), rests.pushed(1.0, 4000)];
    Ok(CaseResult::of(&scene, methods, truth, runs))
}
