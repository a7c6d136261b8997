//! The virtual coupling and the environment, solved together in every tick.
//!
//! With `x` the device's position and `K_vc` the coupling's stiffness, the environment is at
//! `x_E = x - F / K_vc` and its torque there is `F`: an algebraic loop if the environment is not delayed
//! (theory, section 2). A line with slope `f` and the torque `v` at `x_E = x` gives
//!
//! ```text
//! F = v + f (x_E - x) = v - F f / K_vc,   so   F = v / (1 + f / K_vc),
//! ```
//!
//! and that gain is computed before the servo starts. The environment always returns the value at `x`, never
//! an intercept, so that no large numbers cancel near its state of rest.

use crate::build_error::BuildError;
use crate::number::{Number, Rounding};

/// The virtual coupling `V` between device and environment.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "wire", derive(serde::Serialize, serde::Deserialize))]
pub enum Coupling {
    /// No compliance: the environment sees the device's position.
    Rigid,
    /// A spring, `V = 1 / stiffness`.
    Spring {
        /// Stiffness `K_vc` in N m/rad. The standard coupling is `2 delta / T`.
        stiffness: f64,
    },
    /// The coupling that absorbs latency: the standard coupling, plus the compliance that delays and lags
    /// need, spread over the ticks that they take ([`crate::matched`]).
    Matched,
}

impl Coupling {
    /// Compliance in rad/(N m) for the torque of the same tick, for a memory with this
    /// [compliance](crate::coupling_memory::CouplingMemory::compliance); `None`: rigid.
    ///
    /// # Errors
    /// If the memory stores past torques and the coupling does not use them, or the reverse.
    pub const fn compliance(self, matched: Option<f64>) -> Result<Option<f64>, BuildError> {
        match (self, matched) {
            (Self::Rigid, None) => Ok(None),
            (Self::Spring { stiffness }, None) => Ok(Some(1.0 / stiffness)),
            (Self::Matched, Some(compliance)) => Ok(Some(compliance)),
            _ => Err(BuildError::Structure),
        }
    }
}

/// The response of an environment to the coupling in one tick.
#[derive(Clone, Copy, Debug)]
pub enum Response<N> {
    /// A torque that does not depend on this tick's position, in N m.
    Held(N),
    /// A line; its torque in N m at `x_E = x`.
    Line(N),
    /// A wall that can only push.
    Wall(Contact<N>),
    /// The sum of a line (its torque in N m at `x_E = x`) and a wall.
    LineAndWall(N, Contact<N>),
}

impl<N: Number> Response<N> {
    /// The sum of two responses, of which at most one has a wall.
    #[inline(always)]
    pub(crate) fn plus(self, other: Self) -> Self {
        match (self, other) {
            (Self::Held(a), Self::Held(b)) => Self::Held(a.plus(b)),
            (Self::Held(a) | Self::Line(a), Self::Held(b) | Self::Line(b)) => Self::Line(a.plus(b)),
            (Self::Held(torque) | Self::Line(torque), Self::Wall(contact))
            | (Self::Wall(contact), Self::Held(torque) | Self::Line(torque)) => {
                Self::LineAndWall(torque, contact)
            }
            (Self::Held(torque) | Self::Line(torque), Self::LineAndWall(line, contact))
            | (Self::LineAndWall(line, contact), Self::Held(torque) | Self::Line(torque)) => {
                Self::LineAndWall(line.plus(torque), contact)
            }
            // A sum of parts has one wall.
            (walls, Self::Wall(_) | Self::LineAndWall(..)) => walls,
        }
    }
}

/// A one-sided wall at `x_E = x`.
#[derive(Clone, Copy, Debug)]
pub struct Contact<N> {
    /// Torque in N m of the wall's line, without its face and with pulling.
    pub torque: N,
    /// Depth behind the face in rad.
    pub depth: N,
}

/// Slopes of an environment's lines in N m/rad, the same in every tick.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Slopes {
    /// The slope of the line.
    pub line: f64,
    /// The slope of the one-sided wall; zero without a wall.
    pub wall: f64,
}

impl Slopes {
    /// Those of the sum of two responses.
    pub(crate) fn plus(self, other: Self) -> Self {
        Self { line: self.line + other.line, wall: self.wall + other.wall }
    }
}

/// The coupling with all constants of a tick computed in advance.
#[derive(Clone, Copy, Debug)]
pub struct Solver<N: Number> {
    /// `1 / K_vc` in rad/(N m); zero for a rigid coupling.
    compliance: N::Coefficient,
    /// `1 / (1 + f / K_vc)` with only the slope of the line.
    line_gain: N::Coefficient,
    /// The same with the sum of the slopes of line and wall.
    contact_gain: N::Coefficient,
    /// `K_vc` in N m/rad, the torque per depth while sliding on the wall's face; zero for a rigid coupling,
    /// which does not use it.
    stiffness: N::Coefficient,
    is_rigid: bool,
}

impl<N: Number> Solver<N> {
    /// Computes the gains, with the coupling's compliance in rad/(N m) for the torque of the same tick;
    /// `None`: rigid.
    ///
    /// # Errors
    /// If a coefficient does not fit the number format, or the loop of coupling and environment has no
    /// solution or more than one.
    pub fn new(compliance: Option<f64>, slopes: Slopes) -> Result<Self, BuildError> {
        let is_rigid = compliance.is_none();
        let compliance = N::FORMAT.coefficient(compliance.unwrap_or(0.0), Rounding::Outward);
        let compliance = BuildError::coefficient::<N>("1 / coupling stiffness", compliance)?;
        // From here on with the rounded compliance, so that the solution is that of the running loop.
        let given = N::coefficient_to_f64(compliance);
        let line = 1.0 + slopes.line * given;
        let contact = line + slopes.wall * given;
        // A line needs a solution. A wall needs exactly one, in contact and out of it: the loop has one if a
        // deeper position of the device makes the environment deeper.
        let solvable = slopes.wall == 0.0 && line != 0.0 || line > 0.0 && contact > 0.0;
        if !solvable {
            return Err(BuildError::IllPosed { line, contact });
        }
        Ok(Self {
            compliance,
            line_gain: BuildError::coefficient::<N>("coupled gain", 1.0 / line)?,
            contact_gain: BuildError::coefficient::<N>("coupled gain in contact", 1.0 / contact)?,
            // Not above that of the rounded compliance: while the environment slides on the face, it must not
            // move out as the device moves in.
            stiffness: BuildError::coefficient::<N>(
                "coupling stiffness",
                if is_rigid { 0.0 } else { N::FORMAT.coefficient(1.0 / given, Rounding::Inward) },
            )?,
            is_rigid,
        })
    }

    /// The torque in N m that satisfies coupling and environment at once.
    #[inline(always)]
    pub fn torque(&self, offer: Response<N>) -> N {
        match offer {
            Response::Held(torque) => torque,
            Response::Line(line) => line.times(self.line_gain),
            Response::Wall(wall) => self.pushing(N::ZERO, wall.torque, wall.depth),
            Response::LineAndWall(line, wall) => {
                self.pushing(line.times(self.line_gain), line.plus(wall.torque), wall.depth)
            }
        }
    }

    /// The torque with a wall that can only push: the free solution `free` outside the wall, `K_vc depth`
    /// while the environment slides on the face (`x_E = face`, with any torque of the wall between zero and
    /// its line), and the solution with the wall's line inside. For positive loop gains these cross once, and
    /// the order of comparison selects the right one.
    #[inline(always)]
    fn pushing(&self, free: N, both: N, depth: N) -> N {
        if !self.is_rigid {
            self.wall_or_face(both, depth).larger(free)
        } else if depth <= N::ZERO {
            free
        } else {
            both.times(self.contact_gain).larger(free)
        }
    }

    /// The solution with the wall's line or on the wall's face, for a coupling that is not rigid.
    #[inline(always)]
    pub(crate) fn wall_or_face(&self, both: N, depth: N) -> N {
        both.times(self.contact_gain).smaller(depth.times(self.stiffness))
    }

    #[inline(always)]
    pub(crate) const fn is_rigid(&self) -> bool {
        self.is_rigid
    }

    /// The environment's position `x_E` in rad with the device at `x` and this torque.
    #[inline(always)]
    pub fn environment_position(&self, x: N, torque: N) -> N {
        x.minus(torque.times(self.compliance))
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn spring(stiffness: f64) -> Option<f64> {
        Some(1.0 / stiffness)
    }

    #[test]
    fn refuses_loops_without_one_solution() {
        let slopes = |line, wall| Slopes { line, wall };
        let ill = |coupling, slopes| {
            matches!(Solver::<f64>::new(coupling, slopes), Err(BuildError::IllPosed { .. }))
        };
        assert!(ill(spring(32.0), slopes(-32.0, 0.0)));
        assert!(!ill(spring(32.0), slopes(-33.0, 0.0)));
        assert!(ill(spring(32.0), slopes(-33.0, 5.0)));
        assert!(ill(spring(32.0), slopes(0.0, -40.0)));
        assert!(!ill(None, slopes(-33.0, 5.0)));
    }

    #[test]
    fn a_rigid_coupling_puts_the_environment_where_the_device_is() {
        let solver = Solver::<f32>::new(None, Slopes { line: 5.0, wall: 0.0 }).unwrap();
        assert_eq!(solver.torque(Response::Line(3.0)), 3.0);
        assert_eq!(solver.environment_position(0.5, 3.0), 0.5);
    }

    /// The servo treats a NaN torque as a fault.
    #[test]
    fn what_is_no_number_is_not_taken_for_a_place_outside_of_a_wall() {
        const NAN: f32 = f32::NAN;
        for coupling in [None, spring(32.0)] {
            let solver = Solver::<f32>::new(coupling, Slopes { line: 0.0, wall: 5.0 }).unwrap();
            for (torque, depth) in [(NAN, NAN), (NAN, 0.5)] {
                let contact = Contact { torque, depth };
                assert!(
                    solver.torque(Response::Wall(contact)).is_nan(),
                    "{coupling:?}, {contact:?}"
                );
                let both = Response::LineAndWall(1.0, contact);
                assert!(solver.torque(both).is_nan(), "{coupling:?}, {both:?}");
            }
            let outside = Contact { torque: -1.0, depth: -0.5 };
            assert!(solver.torque(Response::LineAndWall(NAN, outside)).is_nan(), "{coupling:?}");
        }
    }

    proptest! {
        #[test]
        fn solves_a_line(k in 1.0..1e3_f64, slope in -0.9..50.0_f64, carry in -1.0..1.0_f64,
                         x in -1.0..1.0_f64) {
            let slope = slope * k;
            let solver = Solver::<f64>::new(spring(k), Slopes { line: slope, wall: 0.0 }).unwrap();
            let torque = solver.torque(Response::Line(slope * x + carry));
            let residual = torque - (slope * solver.environment_position(x, torque) + carry);
            prop_assert!(residual.abs() <= 1e-13 * (1.0 + slope.abs()) * (1.0 + torque.abs()));
        }

        /// Against a search for the torque at which the loop's error changes sign, which knows
        /// nothing of cases; at the face the wall may give anything up to its line.
        #[test]
        fn solves_a_line_and_a_wall(k in 1.0..1e3_f64, line in -0.9..5.0_f64,
                                    wall in 0.01..20.0_f64, carry in -9.0..9.0_f64,
                                    wall_carry in -9.0..9.0_f64, face in -0.5..0.5_f64,
                                    x in -1.0..1.0_f64) {
            let (line, wall) = (line * k, wall * k);
            let solver = Solver::<f64>::new(spring(k), Slopes { line, wall }).unwrap();
            let contact = Contact { torque: wall * (x - face) + wall_carry, depth: x - face };
            let torque = solver.torque(Response::LineAndWall(line * x + carry, contact));
            let error = |torque: f64| {
                let p = x - torque / k - face;
                let pushed = if p > 0.0 { (wall * p + wall_carry).max(0.0) } else { 0.0 };
                torque - (line * (x - torque / k) + carry + pushed)
            };
            let (mut below, mut above) = (-1e9, 1e9);
            for _ in 0..200 {
                let middle = 0.5 * (below + above);
                if error(middle) < 0.0 { below = middle } else { above = middle }
            }
            prop_assert!((torque - below).abs() <= 1e-9 * (1.0 + torque.abs()),
                "{torque} against {below}");
        }
    }
}
