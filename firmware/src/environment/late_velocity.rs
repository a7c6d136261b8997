//! The law of parts whose torque depends on the velocity alone, and acts everywhere.

use super::delay_line::DelayLine;
use super::law::Law;
use super::velocity::Velocity;
use crate::coupling::{Response, Slopes};
use crate::number::Number;

/// A torque for the velocity, after a delay.
#[derive(Clone, Debug)]
pub struct LateVelocity<V, D> {
    pub(super) velocity: V,
    pub(super) delay: D,
}

impl<N: Number, V: Velocity<N>, D: DelayLine<N>> Law<N> for LateVelocity<V, D> {
    #[inline(always)]
    fn evaluate(&self, x: N) -> Response<N> {
        match self.delay.due() {
            Some(torque) => Response::Held(torque),
            None => Response::Line(self.velocity.torque(x)),
        }
    }

    #[inline(always)]
    fn update(&mut self, x_e: N) {
        if self.delay.due().is_some() {
            self.delay.push(self.velocity.torque(x_e));
        }
        self.velocity.update(x_e);
    }

    fn rest_at(&mut self, x_e: N) {
        self.velocity.rest_at(x_e);
        self.delay.fill(N::ZERO);
    }

    fn shift(&mut self, by: N) {
        self.velocity.shift(by);
    }

    fn slopes(&self) -> Slopes {
        match self.delay.due() {
            Some(_) => Slopes::default(),
            None => Slopes { line: self.velocity.slope(), wall: 0.0 },
        }
    }
}
