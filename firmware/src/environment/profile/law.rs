//! The law of a torque profile: one look into its table a tick.

use super::knots::{FULL_SCALE, KnotTable, Outline};
use super::sum::{Ends, Layout};
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
    /// Middle of the first cell.
    origin: N,
    cells: N::Coefficient,
    torque: N::Coefficient,
    stops: Option<Stops<N>>,
    turn: Option<Turn<N>>,
    velocity: V,
    delay: D,
    /// The steepest that it rises in N m/rad.
    steepest: f64,
}

/// The ends of a range.
#[derive(Clone, Copy, Debug)]
struct Stops<N: Number> {
    from: N,
    to: N,
    stiffness: N::Coefficient,
}

impl<N: Number, K: KnotTable, V: Velocity<N>, D: DelayLine<N>> ProfileLaw<N, K, V, D> {
    pub(super) fn new(
        knots: K,
        outline: &Outline,
        layout: &Layout,
        velocity: V,
        delay: D,
    ) -> Result<Self, BuildError> {
        let knots_per_rad = layout.knots_per_rad(outline.knots);
        let rise = layout.torque * f64::from(outline.rise) / f64::from(FULL_SCALE) * knots_per_rad;
        let stops = match layout.ends {
            None => None,
            Some(Ends { from, to, stiffness }) => Some(Stops {
                from: BuildError::number("lower end stop", from)?,
                to: BuildError::number("upper end stop", to)?,
                stiffness: BuildError::coefficient::<N>("stiffness of the end stops", stiffness)?,
            }),
        };
        let turn = match layout.ends {
            None => Some(Turn::new()?),
            Some(_) => None,
        };
        let out_of_range = |reason| BuildError::Unrepresentable { name: "profile torque", reason };
        Ok(Self {
            knots,
            origin: BuildError::number("profile centre", layout.centre + 0.5 / knots_per_rad)?,
            cells: BuildError::coefficient::<N>("knots per rad", knots_per_rad)?,
            torque: N::knot_scale(layout.torque).map_err(out_of_range)?,
            stops,
            turn,
            velocity,
            delay,
            steepest: layout
                .ends
                .map_or(rise, |ends| rise.max(ends.stiffness))
                .max(f64::MIN_POSITIVE),
        })
    }

    /// The torque in N m with the environment at `x` (rad), undelayed.
    #[inline(always)]
    fn torque(&self, x: N) -> N {
        let torque = match &self.stops {
            None => self.inside(x),
            Some(stops) => {
                let within = x.larger(stops.from).smaller(stops.to);
                self.inside(within).plus(x.minus(within).times(stops.stiffness))
            }
        };
        self.velocity.add_to(torque, x)
    }

    #[inline(always)]
    fn inside(&self, x: N) -> N {
        x.minus(self.origin).between_knots(self.cells, |cell| self.knots.around(cell), self.torque)
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
        self.turn.as_mut()
    }

    fn shift(&mut self, by: N) {
        self.velocity.shift(by);
    }
}
