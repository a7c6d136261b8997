//! Snap points: a detent holds the knob with a straight line up to its snap point, where the next detent
//! takes over.
//!
//! The torque is that of the table and the line of the branch `b` that holds the knob,
//! `f_b(x) = f(x) + k (x - c_b)`, which reaches the torque of the detents `snap` pitches from its centre
//! `c_b`. The branch changes after a tick, by the position `x_E` of that tick: with `snap` above one half
//! this removes energy and never adds any (theory, section 14.5, equation 49).

use core::hint::cold_path;

use super::data::Profile;
use super::layout::{Layout, SnapPoint};
use crate::build_error::BuildError;
use crate::number::Number;

/// The law of a profile's snap points, in whole parts of a cell, so that any number of turns changes nothing.
pub trait Holding<N: Number>: Clone + core::fmt::Debug + Sized {
    /// That of a profile, with the place of its first knot.
    ///
    /// # Errors
    /// If a coefficient does not fit the number format, or it does not hold the knob in this way.
    fn of(profile: &Profile, origin: i32) -> Result<Self, BuildError>;
    /// `torque` plus the torque of the branch that holds the knob, in N m, at a place in parts.
    #[inline(always)]
    fn add_to(&self, torque: N, _place: i32) -> N {
        torque
    }
    /// Ends the tick with the environment at a place: the knob snaps if the place is beyond the snap point.
    #[inline(always)]
    fn update(&mut self, _place: i32) {}
    /// Holds the knob in the detent next to a place.
    fn rest_at(&mut self, _place: i32) {}
    /// Moves the branch that holds the knob by `by` parts, a whole number of turns.
    fn shift(&mut self, _by: i32) {}
    /// [`SnapPoint::hysteresis`]; infinite without a snap point.
    fn hysteresis(&self) -> f64 {
        f64::INFINITY
    }
}

/// No snap point: costs nothing.
#[derive(Clone, Copy, Debug)]
pub struct NoSnap;

impl<N: Number> Holding<N> for NoSnap {
    fn of(profile: &Profile, _: i32) -> Result<Self, BuildError> {
        if profile.snap.is_none() { Ok(Self) } else { Err(BuildError::Structure) }
    }
}

/// The branch of a snap point that holds the knob.
#[derive(Clone, Debug)]
pub struct Snap<N: Number> {
    /// Torque of a part of a cell.
    slope: N::Coefficient,
    /// The centre of the branch, a place in parts.
    centre: i32,
    /// Parts from there to the snap point.
    reach: u32,
    branch: i32,
    lattice: Lattice,
    hysteresis: f64,
}

impl<N: Number> Snap<N> {
    /// The law for a table of `knots` knots, the first at the place `origin`.
    fn new(snap: &SnapPoint, layout: &Layout, knots: u32, origin: i32) -> Result<Self, BuildError> {
        let (lowest, highest) = snap.branches(layout);
        if lowest > highest {
            let name = "number of detents between the end stops";
            return Err(BuildError::NotPositive { name, value: 0.0 });
        }
        let slope = N::part_scale(snap.torque_of_part(layout.torque, knots))
            .map_err(|reason| BuildError::Unrepresentable { name: "snap point", reason })?;
        let parts = snap.parts(knots);
        let lattice = Lattice {
            first: origin.saturating_add((snap.offset * parts) as i32),
            pitch: (parts * f64::from(1_u32 << PITCH_BITS)) as i64,
            per_part: ((1_u64 << RECIPROCAL_BITS) as f64 / parts) as u32,
            lowest,
            highest,
        };
        // More than half a pitch after any rounding.
        let reach = (snap.snap * parts) as u32 + 1;
        let mut out = Self {
            slope,
            centre: 0,
            reach,
            branch: 0,
            lattice,
            hysteresis: snap.hysteresis(layout),
        };
        out.rest_at(origin);
        Ok(out)
    }

    fn hold(&mut self, branch: i32) {
        self.branch = branch.clamp(self.lattice.lowest, self.lattice.highest);
        self.centre = self.lattice.centre(self.branch);
    }

    /// Selects the detent nearest to a place `away` from the centre for the next tick.
    #[inline(never)]
    fn snap(&mut self, away: i32) {
        cold_path();
        // Never past the middle between two detents, where a snap would add energy.
        self.hold(self.branch.saturating_add(self.lattice.pitches(away, HALF - HALF / 8192)));
    }
}

impl<N: Number> Holding<N> for Snap<N> {
    fn of(profile: &Profile, origin: i32) -> Result<Self, BuildError> {
        let Some(snap) = &profile.snap else { return Err(BuildError::Structure) };
        Self::new(snap, &profile.layout(), profile.outline().knots, origin)
    }

    #[inline(always)]
    fn add_to(&self, torque: N, place: i32) -> N {
        torque.plus(N::of_parts(place.saturating_sub(self.centre), self.slope))
    }

    #[inline(always)]
    fn update(&mut self, place: i32) {
        let away = place.saturating_sub(self.centre);
        if away.unsigned_abs() > self.reach {
            self.snap(away);
        }
    }

    fn rest_at(&mut self, place: i32) {
        let away = place.saturating_sub(self.lattice.first);
        self.hold(self.lattice.pitches(away, HALF));
    }

    fn shift(&mut self, by: i32) {
        self.hold(self.branch.saturating_add(self.lattice.pitches(by, HALF)));
    }

    fn hysteresis(&self) -> f64 {
        self.hysteresis
    }
}

/// An optional snap point, for profiles as data.
pub type AnySnap<N> = Option<Snap<N>>;

impl<N: Number> Holding<N> for AnySnap<N> {
    fn of(profile: &Profile, origin: i32) -> Result<Self, BuildError> {
        profile.snap.map(|_| Snap::of(profile, origin)).transpose()
    }

    #[inline(always)]
    fn add_to(&self, torque: N, place: i32) -> N {
        match self {
            Some(snap) => snap.add_to(torque, place),
            None => torque,
        }
    }

    #[inline(always)]
    fn update(&mut self, place: i32) {
        if let Some(snap) = self {
            snap.update(place);
        }
    }

    fn rest_at(&mut self, place: i32) {
        self.iter_mut().for_each(|snap| snap.rest_at(place));
    }

    fn shift(&mut self, by: i32) {
        self.iter_mut().for_each(|snap| snap.shift(by));
    }

    fn hysteresis(&self) -> f64 {
        self.as_ref().map_or(f64::INFINITY, |snap| snap.hysteresis())
    }
}

/// Bits of a pitch below a part: over a turn of 2^14 detents the error is less than a thousandth of a part.
const PITCH_BITS: u32 = 24;
/// Bits of its reciprocal, which is below 2^30: a detent is at least four cells wide, that is 2^16 parts.
const RECIPROCAL_BITS: u32 = 46;
/// Half a pitch in units of the reciprocal.
const HALF: u64 = 1 << (RECIPROCAL_BITS - 1);

/// The centres of the detents.
#[derive(Clone, Copy, Debug)]
struct Lattice {
    /// Place of the centre of the branch 0.
    first: i32,
    /// Distance from one centre to the next, in parts with [`PITCH_BITS`] fractional bits.
    pitch: i64,
    /// Pitches per part, with [`RECIPROCAL_BITS`] fractional bits.
    per_part: u32,
    lowest: i32,
    highest: i32,
}

impl Lattice {
    fn centre(&self, branch: i32) -> i32 {
        const HALF_A_PART: i64 = 1 << (PITCH_BITS - 1);
        let parts = i64::from(branch).wrapping_mul(self.pitch).wrapping_add(HALF_A_PART);
        self.first.wrapping_add((parts >> PITCH_BITS) as i32)
    }

    /// Whole pitches in this many parts; a part that `half` completes to a whole pitch counts as one more.
    fn pitches(&self, parts: i32, half: u64) -> i32 {
        let whole = u64::from(parts.unsigned_abs()).wrapping_mul(self.per_part.into());
        let whole = (whole.wrapping_add(half) >> RECIPROCAL_BITS) as i32;
        if parts < 0 { -whole } else { whole }
    }
}
