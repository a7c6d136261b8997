//! The law of a torque profile: one look into its table a tick.

use super::knots::{KnotTable, Outline};
use super::scale::Scale;
use super::sum::Layout;
use crate::build_error::BuildError;
use crate::coupling::{Response, Slopes};
use crate::environment::delay_line::DelayLine;
use crate::environment::law::Law;
use crate::environment::turn::Turn;
use crate::environment::velocity::Velocity;
use crate::number::Number;

/// The law of a torque profile.
#[derive(Clone, Debug)]
pub struct ProfileLaw<N: Number, K, V, D> {
    knots: K,
    /// Parts of a cell in a rad.
    parts: N::Coefficient,
    /// Parts from the angle of zero to the first knot.
    origin: i32,
    /// Parts from the first knot to the lower end.
    from: i32,
    /// Parts between the ends; all that there are where there are none.
    span: u32,
    /// Torque of a part of a unit.
    torque: N::Coefficient,
    /// Torque of a part beyond the ends.
    stop: N::Coefficient,
    turn: Turn<N>,
    velocity: V,
    delay: D,
    /// The steepest that it rises in N m/rad.
    steepest: f64,
}

impl<N: Number, K: KnotTable, V: Velocity<N>, D: DelayLine<N>> ProfileLaw<N, K, V, D> {
    pub(super) fn new(
        knots: K,
        outline: &Outline,
        layout: &Layout,
        velocity: V,
        delay: D,
    ) -> Result<Self, BuildError> {
        let scale = Scale::of(layout, outline);
        let parts = N::parts_scale(scale.parts_per_rad)
            .map_err(|reason| BuildError::Unrepresentable { name: "knots per rad", reason })?;
        let place =
            |name, angle| BuildError::number::<N>(name, angle).map(|angle: N| angle.parts(parts));
        let origin = place("profile centre", layout.centre)?;
        let (from, span, turn) = match layout.ends {
            None => (i32::MIN, u32::MAX, Turn::endless()?),
            Some(ends) => {
                let from = place("lower end stop", ends.from)?;
                let to = place("upper end stop", ends.to)?;
                (from, to.wrapping_sub(from).cast_unsigned(), Turn::none())
            }
        };
        let torque = |name, torque| {
            N::part_scale(torque).map_err(|reason| BuildError::Unrepresentable { name, reason })
        };
        Ok(Self {
            knots,
            parts,
            origin,
            from,
            span,
            torque: torque("profile torque", scale.torque_of_part)?,
            stop: torque("stiffness of the end stops", scale.stop_of_part)?,
            turn,
            velocity,
            delay,
            steepest: scale.steepest_rise(outline).max(f64::MIN_POSITIVE),
        })
    }

    /// The torque in N m with the environment at `x` (rad), undelayed.
    #[inline(always)]
    fn torque(&self, x: N) -> N {
        let place = x.parts(self.parts);
        let torque = if place.wrapping_sub(self.from).cast_unsigned() <= self.span {
            self.inside(place)
        } else {
            self.beyond(place)
        };
        self.velocity.add_to(torque, x)
    }

    #[inline(always)]
    fn inside(&self, place: i32) -> N {
        N::of_parts(self.knots.units_at(place.wrapping_sub(self.origin)), self.torque)
    }

    /// The torque at the nearer end, and that of its spring.
    #[inline(always)]
    fn beyond(&self, place: i32) -> N {
        let to = self.from.wrapping_add(self.span.cast_signed());
        let end = if place < self.from { self.from } else { to };
        self.inside(end).plus(N::of_parts(place.saturating_sub(end), self.stop))
    }
}

impl<N: Number, K: KnotTable, V: Velocity<N>, D: DelayLine<N>> Law<N> for ProfileLaw<N, K, V, D> {
    #[inline(always)]
    fn evaluate(&self, x: N) -> Response<N> {
        // The torque of a profile that is not late is that in front of the coupling.
        Response::Held(self.delay.due().unwrap_or_else(|| self.torque(x)))
    }

    #[inline(always)]
    fn update(&mut self, x_e: N) {
        if self.delay.due().is_some() {
            let torque = self.torque(x_e);
            self.delay.push(torque);
        }
        self.velocity.update(x_e);
    }

    fn rest_at(&mut self, x_e: N) {
        self.velocity.rest_at(x_e);
        let torque = self.torque(x_e);
        self.delay.fill(torque);
    }

    fn slopes(&self) -> Slopes {
        match self.delay.due() {
            Some(_) => Slopes::default(),
            // In front of the coupling, so that there `1 + line V` is what has to be positive.
            None => Slopes { line: -self.steepest, wall: 0.0 },
        }
    }

    #[inline(always)]
    fn turn(&mut self) -> Option<&mut Turn<N>> {
        Some(&mut self.turn)
    }

    fn shift(&mut self, by: N) {
        self.velocity.shift(by);
    }
}
