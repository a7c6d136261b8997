//! Both sides of the line: walls at 0.99 of the certified limit, which come to rest, and at 1.01 of
//! it, with the hand in which they do not.
//!
//! For a rigid device and a linear wall the certified limit is the true one (theory, section 4.1).

use firmware::scene::Scene;

use super::case::FailureError;
use super::fate::End;
use super::setting::{PADDLE, PADDLES, PERIOD, coupled, rigid, trial, wall_of};
use super::trial::Trial;
use crate::chain::Chain;
use crate::limits::{Limit, largest_stiffness, with_wall};
use crate::worst_hand::{HandCase, plant, search};

/// Delays in samples.
pub const DELAYS: std::ops::RangeInclusive<usize> = 0..=4;

/// How fast in rad/s a wall in a hand is pushed that has to come to rest.
const SLOW: f64 = 0.1;
/// Most samples in which a wall has to grow.
const LONGEST: f64 = 150_000.0;

/// A wall of one delay.
#[derive(Clone, Debug)]
pub struct Wall {
    /// Largest certified stiffness in N m/rad.
    pub limit: f64,
    /// The hand in which it is worst at 1.01 of that.
    pub hand: HandCase,
    /// At 0.99, in no hand and in that one.
    pub below: [Trial; 2],
    /// At 1.01 in that hand.
    pub above: Trial,
}

/// A wall of that delay on the paddle: behind the standard coupling, but for the undelayed one,
/// whose stiffness has a limit only without.
///
/// # Errors
/// Where it has no limit, or no hand is found.
pub fn wall(delay: usize) -> Result<Wall, FailureError> {
    let scene = match delay {
        0 => rigid(PADDLE, wall_of(0.0, 0.0, delay)),
        _ => coupled(PADDLE, wall_of(0.0, 0.0, delay)),
    };
    let Limit::RoundUp3(limit) = largest_stiffness(&scene) else {
        return Err(FailureError::NoLimit);
    };
    let [below, above] = [0.99, 1.01].map(|part| with_wall(&scene, part * limit, None));
    let device = Chain::rigid(PADDLE.inertia, PADDLE.damping)?;
    let hand = search(&above, &device)?.worst;
    let held = |what, scene: &Scene, expected| {
        let mut trial = trial(what, scene, PADDLES, expected);
        trial.experiment.plant = plant(&device, 1.0, &hand.hand);
        trial
    };
    let below_in_hand = held("0.99 of it, in the worst hand", &below, End::Rests);
    // As long as friction needs to stop that much inertia, and some seconds.
    let momentum = SLOW * (PADDLE.inertia + hand.hand.inertia);
    let seconds = 3.0 * momentum / below_in_hand.experiment.friction + 4.0;
    // Without friction, which would hide that little: long enough for three times the motion.
    let samples = (2.0 / hand.spectral_radius.ln()).clamp(1000.0, LONGEST) as usize;
    let mut above = held("1.01 of it, in the worst hand", &above, End::Grows);
    above.experiment.friction = 0.0;
    Ok(Wall {
        limit,
        hand,
        below: [
            trial("0.99 of the limit", &below, PADDLES, End::Rests).pushed(1.0, 4000),
            below_in_hand.pushed(SLOW, (seconds / PERIOD) as usize),
        ],
        above: above.pushed(1.0, samples).believing(2.0),
    })
}
