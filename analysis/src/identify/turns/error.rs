//! Why a record of turns shows nothing.

use std::f64::consts::TAU;

use thiserror::Error;

use crate::quantity::significant;

/// Smallest ratio of the largest speed to the smallest at which they tell numbers apart.
pub const LEAST_SPREAD: f64 = 1.5;

/// Why a record of turns shows nothing.
#[derive(Clone, Debug, PartialEq, Error)]
#[allow(missing_docs, reason = "the sentences describe the variants")]
pub enum TurnsError {
    #[error(
        "there is no whole turn in one direction in the {rows} rows: the longest motion in one direction is {} \
         turns. Cogging averages out only over whole turns: turn on for longer, or with more torque",
        significant(.farthest / TAU, 3)
    )]
    NotWhole { farthest: f64, rows: usize },
    #[error(
        "there is no whole turn without a stop: the device stops {stops} times and goes on in the same direction \
         (first at {} s, row {row}), and the longest motion without a stop is {} turns. It sticks and slips, or \
         its damping takes the torque: turn with more torque than friction, cogging and damping together",
        significant(*.time, 6),
        significant(.farthest / TAU, 3)
    )]
    StickSlip { stops: usize, row: usize, time: f64, farthest: f64 },
    #[error(
        "all {turns} whole turns go {direction}: friction is half the difference of the torques in both \
         directions. Record turns in the other direction, too, in the same file"
    )]
    OneDirection { turns: usize, direction: &'static str },
    #[error(
        "the whole turns {direction} are of {found} speeds, {} to {} rad/s; friction is told from damping by at \
         least three, the largest at least {LEAST_SPREAD} times the smallest. Record turns with other torques, too, \
         in the same file",
        significant(*.least, 3),
        significant(*.most, 3)
    )]
    FewSpeeds { direction: &'static str, found: usize, least: f64, most: f64 },
    #[error(
        "{turns} whole turns do not determine inertia, damping and friction: record more, with torques that change"
    )]
    TooFew { turns: usize },
    #[error(
        "torque and counts have opposite signs: the mean torque of the turns is {} N m against the motion. Change \
         the sign of one of the two columns; on a board, exchange the encoder's channels or the motor's wires",
        significant(*.torque, 3)
    )]
    Reversed { torque: f64 },
    #[error(
        "above {} N m the device gets {:.0} % less than the torque that is added: the amplifier clips there, at its \
         limit of current or of voltage. Turn with less torque, or raise the amplifier's limit, and record again",
        significant(*.torque, 3),
        100.0 * .part
    )]
    Clipped { torque: f64, part: f64 },
    #[error(
        "counts and reference turn in opposite directions, or by {} turns against {}: check the sign of the columns, \
         --counts-per-rev and --reference-per-rev",
        significant(*.counts, 3),
        significant(*.reference, 3)
    )]
    NotOneShaft { counts: f64, reference: f64 },
}
