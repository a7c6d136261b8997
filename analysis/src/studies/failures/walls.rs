//! Walls on both sides of the limit: at 0.99 of the certified limit, where they come to rest, and at 1.01,
//! with the hand in which they do not.
//!
//! For a rigid device and a linear wall the certified limit is the true one (theory, section 4.1).

use super::setting::*;
use crate::chain::Chain;
use crate::limits::with_wall;
use crate::worst_hand::{HandCase, plant, search};

/// Delays in samples.
pub const DELAYS: std::ops::RangeInclusive<usize> = 0..=4;

/// Initial velocity in rad/s of a wall in a hand that must come to rest.
const SLOW: f64 = 0.1;
/// Largest number of samples in which a motion must grow.
const LONGEST: f64 = 150_000.0;

/// A wall of one delay.
#[derive(Clone, Debug)]
pub struct Wall {
    /// Largest certified stiffness in N m/rad.
    pub limit: f64,
    /// The worst hand at 1.01 of that stiffness.
    pub hand: HandCase,
    /// At 0.99, without a hand and in that hand.
    pub below: [LoopRun; 2],
    /// At 1.01 in that hand.
    pub above: LoopRun,
}

/// A wall of that delay on the paddle: behind the standard coupling, except for the undelayed wall, whose
/// stiffness has a limit only without a coupling.
pub fn wall(delay: usize) -> Result<Wall, StudyError> {
    let scene = match delay {
        0 => rigid(PADDLE, wall_of(0.0, 0.0, delay)),
        _ => coupled(PADDLE, wall_of(0.0, 0.0, delay)),
    };
    let limit = limit_of(&scene)?;
    let [below, above] = [0.99, 1.01].map(|part| with_wall(&scene, part * limit, None));
    let device = Chain::rigid(PADDLE.inertia, PADDLE.damping)?;
    let hand = search(&above, &device)?.worst;
    let held = |what, scene: &Scene, expected| {
        let mut loop_run = loop_run(what, scene, PADDLES, expected);
        loop_run.experiment.plant = plant(&device, 1.0, &hand.hand);
        loop_run
    };
    let below_in_hand = held("0.99 of it, in the worst hand", &below, Outcome::Converges);
    // The time that friction needs to stop this inertia, plus some seconds.
    let momentum = SLOW * (PADDLE.inertia + hand.hand.inertia);
    let seconds = 3.0 * momentum / below_in_hand.experiment.friction + 4.0;
    // Without friction, which would hide such slow growth: until the motion has tripled.
    let samples = (2.0 / hand.spectral_radius.ln()).clamp(1000.0, LONGEST) as usize;
    let mut above = held("1.01 of it, in the worst hand", &above, Outcome::Diverges);
    above.experiment.friction = 0.0;
    Ok(Wall {
        limit,
        hand,
        below: [
            loop_run("0.99 of the limit", &below, PADDLES, Outcome::Converges).pushed(1.0, 4000),
            below_in_hand.pushed(SLOW, (seconds / PERIOD) as usize),
        ],
        above: above.pushed(1.0, samples).with_claimed_passivity(2.0),
    })
}
