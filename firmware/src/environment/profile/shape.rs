//! Named shapes of torque over angle.

use core::f64::consts::TAU;

use super::layout::{Ends, down, nearest};
use super::shape_error::ShapeError;

/// Bounds on the number of pitches from a centre to its snap point; at the lower bound the branches on both
/// sides of a snap meet half-way.
const SNAP: [f64; 2] = [0.5, 10.0];

/// Torque over angle. A positive torque pushes back from a positive angle, as for all environments.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Shape {
    /// Rest positions, `count` per turn, the first at `centre`: from each the torque rises in a straight line
    /// to `torque` a quarter of the pitch away, and falls to zero half-way to the next. No other shape with
    /// this torque is less steep.
    Detents {
        /// Number of detents per turn.
        count: u32,
        /// Largest torque in N m.
        torque: f64,
        /// Angle of the first detent in rad.
        centre: f64,
    },
    /// Rest positions, each a spring up to its snap point, where the next spring takes over: see
    /// [`Shape::snap`]. A sum has at most one such shape.
    SnapDetents {
        /// Number of detents per turn.
        count: u32,
        /// Torque in N m at the snap point.
        torque: f64,
        /// Angle of the first detent in rad.
        centre: f64,
        /// Pitches from the centre of a detent to its snap point.
        snap: f64,
    },
    /// Like [`Detents`](Self::Detents), with a pitch in rad instead of a number: a surface to feel, not
    /// positions to rest at.
    Texture {
        /// Distance between two ridges in rad.
        pitch: f64,
        /// Largest torque in N m.
        amplitude: f64,
    },
    /// Zero torque between two angles, and springs beyond them.
    EndStops {
        /// Lower end in rad.
        from: f64,
        /// Upper end in rad.
        to: f64,
        /// Stiffness in N m/rad beyond them.
        stiffness: f64,
    },
    /// A spring that pulls to zero from any angle. Its table ends at `width` on either side; beyond, the
    /// torque continues to grow with the same slope.
    Centre {
        /// Half-width of the table in rad.
        width: f64,
        /// Stiffness in N m/rad.
        stiffness: f64,
    },
    /// Two rest positions, `distance` on either side of zero, and a snap between them.
    Bistable {
        /// Angle of the upper position in rad.
        distance: f64,
        /// Largest torque in N m between the positions.
        torque: f64,
    },
    /// A position that pulls like a magnet from up to `width` on either side, once per turn.
    Magnet {
        /// Its angle in rad.
        angle: f64,
        /// Its range in rad.
        width: f64,
        /// Largest torque in N m, half-way.
        torque: f64,
    },
    /// Straight lines through knots, each an angle in rad and a torque in N m; beyond the first and the last
    /// knot their torques. Needs end stops.
    Table(&'static [(f64, f64)]),
    /// The same over a period; the last knot closes the period with the torque of the first.
    Periodic(&'static [(f64, f64)]),
}

impl Shape {
    /// Detents, the first one at zero.
    pub const fn detents(count: u32, torque: f64) -> Self {
        Self::Detents { count, torque, centre: 0.0 }
    }

    /// Detents with a snap point: each is a spring, and the next detent takes over `snap` pitches away from
    /// the centre, where the torque is largest. On the way back this happens at the same distance from the
    /// other centre, so a knob held between two detents stays in one of them. Above 1 the detents feel
    /// smooth; near 1/2 they feel like a switch.
    ///
    /// # Panics
    /// If the shape is not detents; in a constant this is a compile error.
    #[must_use]
    pub const fn snap(self, snap: f64) -> Self {
        match self {
            Self::Detents { count, torque, centre }
            | Self::SnapDetents { count, torque, centre, .. } => {
                Self::SnapDetents { count, torque, centre, snap }
            }
            _ => panic!("only detents have a snap point"),
        }
    }

    /// Springs beyond two angles.
    pub const fn end_stops(from: f64, to: f64, stiffness: f64) -> Self {
        Self::EndStops { from, to, stiffness }
    }

    /// A spring that pulls to zero.
    pub const fn centre(width: f64, stiffness: f64) -> Self {
        Self::Centre { width, stiffness }
    }

    /// A switch between two places.
    pub const fn bistable(distance: f64, torque: f64) -> Self {
        Self::Bistable { distance, torque }
    }

    /// Ridges.
    pub const fn texture(pitch: f64, amplitude: f64) -> Self {
        Self::Texture { pitch, amplitude }
    }

    /// A position that pulls like a magnet.
    pub const fn magnet(angle: f64, width: f64, torque: f64) -> Self {
        Self::Magnet { angle, width, torque }
    }

    /// The torque in N m at an angle in rad; for detents with a snap point, that of the nearest detent.
    pub const fn torque_at(&self, angle: f64) -> f64 {
        match *self {
            Self::SnapDetents { count, torque, centre, snap } => {
                let pitches = (angle - centre) * count as f64 / TAU;
                torque * (pitches - nearest(pitches)) / snap
            }
            Self::Detents { count, torque, centre } => {
                torque * triangle((angle - centre) * count as f64 / TAU)
            }
            Self::Texture { pitch, amplitude } => amplitude * triangle(angle / pitch),
            Self::EndStops { from, to, stiffness } => stiffness * (angle - angle.max(from).min(to)),
            Self::Centre { stiffness, .. } => stiffness * angle,
            Self::Bistable { distance, torque } => {
                let outside = angle.abs() - distance;
                let slope = 2.0 * torque / distance;
                let inward =
                    if outside > -0.5 * distance { slope * outside } else { -slope * angle.abs() };
                if angle < 0.0 { -inward } else { inward }
            }
            Self::Magnet { angle: place, width, torque } => {
                let turns = (angle - place) / TAU;
                let away = (turns - nearest(turns)) * TAU;
                if away.abs() < width { torque * triangle(0.5 * away / width) } else { 0.0 }
            }
            Self::Table(knots) => between(knots, angle),
            Self::Periodic(knots) => {
                let (first, period) = (knots[0].0, period(knots));
                let periods = (angle - first) / period;
                between(knots, first + (periods - down(periods)) * period)
            }
        }
    }

    /// The number of repetitions per turn, a whole number; `None` if it does not repeat.
    pub(super) const fn repeats(&self) -> Option<u32> {
        let repeats = match *self {
            Self::Detents { count, .. } | Self::SnapDetents { count, .. } => return Some(count),
            Self::Magnet { .. } => return Some(1),
            Self::Texture { pitch, .. } => TAU / pitch,
            Self::Periodic(knots) => TAU / period(knots),
            _ => return None,
        };
        // A period is written with a few digits.
        let whole = nearest(repeats);
        let is_whole = whole >= 1.0 && (repeats - whole).abs() <= 1e-3 * whole.min(10.0);
        if is_whole { Some(whole as u32) } else { None }
    }

    /// The range in which it changes, and the stiffness beyond it, zero if the torque is constant there;
    /// `None` if it changes everywhere.
    pub(super) const fn extent(&self) -> Option<Ends> {
        Some(match *self {
            Self::EndStops { from, to, stiffness } => Ends { from, to, stiffness },
            Self::Centre { width, stiffness } => Ends { from: -width, to: width, stiffness },
            Self::Bistable { distance, torque } => {
                let far = 1.5 * distance;
                Ends { from: -far, to: far, stiffness: 2.0 * torque / distance }
            }
            Self::Table(knots) => {
                Ends { from: knots[0].0, to: knots[knots.len() - 1].0, stiffness: 0.0 }
            }
            _ => return None,
        })
    }

    /// Width in rad of the narrowest straight piece that a table must represent.
    pub const fn narrowest(&self) -> f64 {
        match *self {
            Self::Detents { count, .. } | Self::SnapDetents { count, .. } => {
                0.25 * TAU / count as f64
            }
            Self::Texture { pitch, .. } => 0.25 * pitch,
            Self::EndStops { .. } | Self::Centre { .. } => f64::INFINITY,
            Self::Bistable { distance, .. } => 0.5 * distance,
            Self::Magnet { width, .. } => 0.5 * width,
            // Cut corners never make its slopes steeper.
            Self::Table(_) | Self::Periodic(_) => f64::INFINITY,
        }
    }

    /// Checks its numbers; `shape` is its index among the shapes.
    pub(super) const fn checked(&self, shape: usize) -> Result<(), ShapeError> {
        let numbers: [(&'static str, f64, bool); 3] = match *self {
            Self::SnapDetents { snap, .. } if !(snap > SNAP[0] && snap <= SNAP[1]) => {
                let bound = "greater than 0.5, half-way to the next detent, and at most 10";
                return Err(ShapeError::Number { shape, name: "snap", value: snap, bound });
            }
            Self::Detents { count, torque, centre }
            | Self::SnapDetents { count, torque, centre, .. } => {
                [("count", count as f64, true), ("torque", torque, true), ("centre", centre, false)]
            }
            Self::Texture { pitch, amplitude } => {
                [("pitch", pitch, true), ("amplitude", amplitude, true), UNUSED]
            }
            Self::EndStops { from, to, stiffness } => {
                if from.is_nan() || to.is_nan() || from >= to {
                    let bound = "below `to`";
                    return Err(ShapeError::Number { shape, name: "from", value: from, bound });
                }
                [("stiffness", stiffness, true), ("from", from, false), ("to", to, false)]
            }
            Self::Centre { width, stiffness } => {
                [("width", width, true), ("stiffness", stiffness, true), UNUSED]
            }
            Self::Bistable { distance, torque } => {
                [("distance", distance, true), ("torque", torque, true), UNUSED]
            }
            Self::Magnet { angle, width, torque } => {
                [("angle", angle, false), ("width", width, true), ("torque", torque, true)]
            }
            Self::Table(knots) => return knots_checked(shape, knots, false),
            Self::Periodic(knots) => return knots_checked(shape, knots, true),
        };
        each!(i in 0..numbers.len() => {
            let (name, value, is_positive) = numbers[i];
            if !value.is_finite() || value.abs() > LARGEST {
                let bound = "finite, and of a magnitude up to a million";
                return Err(ShapeError::Number { shape, name, value, bound });
            }
            if is_positive && value <= 0.0 {
                return Err(ShapeError::Number { shape, name, value, bound: "greater than 0" });
            }
        });
        if let Self::Magnet { width, .. } = *self
            && width > 0.5 * TAU
        {
            let bound = "at most half a turn";
            return Err(ShapeError::Number { shape, name: "width", value: width, bound });
        }
        Ok(())
    }
}

/// Larger angles and torques are not those of a knob.
const LARGEST: f64 = 1e6;
const UNUSED: (&str, f64, bool) = ("", 0.0, false);

const fn knots_checked(
    shape: usize,
    knots: &[(f64, f64)],
    is_periodic: bool,
) -> Result<(), ShapeError> {
    if knots.len() < 2 {
        let (value, bound) = (knots.len() as f64, "two knots at the least");
        return Err(ShapeError::Knot { shape, knot: 0, value, bound, limit: None });
    }
    let mut knot = 0;
    while knot < knots.len() {
        let (angle, torque) = knots[knot];
        if !(angle.abs() <= LARGEST && torque.abs() <= LARGEST) {
            let value = if angle.abs() <= LARGEST { torque } else { angle };
            let bound = "finite, and of a magnitude up to a million";
            return Err(ShapeError::Knot { shape, knot, value, bound, limit: None });
        }
        if knot > 0 && angle <= knots[knot - 1].0 {
            let limit = Some(knots[knot - 1].0);
            let bound = "above the angle of the knot before, which is";
            return Err(ShapeError::Knot { shape, knot, value: angle, bound, limit });
        }
        knot += 1;
    }
    let (first, last) = (knots[0].1, knots[knots.len() - 1].1);
    if is_periodic && first != last {
        let (knot, limit) = (knots.len() - 1, Some(first));
        let bound = "the torque of the first knot, which closes the period:";
        return Err(ShapeError::Knot { shape, knot, value: last, bound, limit });
    }
    Ok(())
}

const fn period(knots: &[(f64, f64)]) -> f64 {
    knots[knots.len() - 1].0 - knots[0].0
}

/// Straight lines through knots, and level beyond them.
const fn between(knots: &[(f64, f64)], angle: f64) -> f64 {
    if angle <= knots[0].0 {
        return knots[0].1;
    }
    each!(i in 1..knots.len() => {
        let ((from, below), (to, above)) = (knots[i - 1], knots[i]);
        if angle <= to {
            return below + (above - below) * ((angle - from) / (to - from));
        }
    });
    knots[knots.len() - 1].1
}

/// A wave of height 1 in straight lines, zero at all whole numbers and rising there.
const fn triangle(periods: f64) -> f64 {
    let part = periods - nearest(periods);
    if part.abs() <= 0.25 {
        4.0 * part
    } else if part > 0.0 {
        2.0 - 4.0 * part
    } else {
        -2.0 - 4.0 * part
    }
}
