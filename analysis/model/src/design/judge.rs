//! The judge of a design.

use haptic_servo::certificate::{PassivityProblem, assess_in};
use haptic_servo::number::Format;
use haptic_servo::period;
use haptic_servo::scene::Scene;

use super::quantity::Quantity;
use crate::file::is_beyond_longest;
use crate::on_board::{self, Refusal};

/// The judge of each value of a design.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Judge {
    /// The certificate of the scene as it is written.
    Certificate,
    /// The certificate of a board, too: with limited torques, its time to read a count, the coefficients as
    /// its numbers round them, and a period that it can pace, from this shortest one in s.
    Board(f64),
}

impl Judge {
    /// A board as it is.
    pub const BOARD: Self = Self::Board(period::SHORTEST);

    /// Whether a scene passes.
    pub fn passes(self, scene: &Scene) -> bool {
        if is_beyond_longest(&scene.latency, scene.timing.period) {
            return false;
        }
        let is_certified = PassivityProblem::of(scene).is_ok_and(|posed| posed.is_certified());
        match self {
            Self::Certificate => is_certified,
            Self::Board(shortest) => {
                let periods = shortest..=period::LONGEST;
                is_certified && periods.contains(&scene.timing.period) && renders(scene)
            }
        }
    }

    /// The nearest possible value from below: the phase of a board's output is a whole number of nanoseconds.
    pub(super) fn possible(self, quantity: Quantity, value: f64) -> f64 {
        match (self, quantity) {
            (Self::Board(_), Quantity::OutputDelay) => (value * 1e9).floor() / 1e9,
            _ => value,
        }
    }
}

fn renders(scene: &Scene) -> bool {
    let passes_in = |format| {
        let assessment = assess_in(scene, format);
        assessment.outcome.is_ok() && on_board::renders(scene, &assessment).is_ok()
    };
    [Format::F64, Format::F32].into_iter().all(passes_in)
}

/// The reason why no board renders a certified scene; `None` where one does.
pub fn board_refusal(scene: &Scene) -> Option<Refusal> {
    if let Err(error) = period::check(scene.timing.period) {
        return Some(Refusal { sentence: error.to_string(), is_rejection: false });
    }
    on_board::renders(scene, &assess_in(scene, Format::F64)).err()
}
