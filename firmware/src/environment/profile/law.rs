//! The law of a torque profile: one table look-up per tick.

use super::data::Profile;
use super::knots::{KnotTable, Outline};
use super::layout::{Ends, Layout};
use super::scale::Scale;
use super::snap::{AnySnap, Holding};
use crate::build_error::BuildError;
use crate::coupling::{Response, Slopes};
use crate::environment::delay_line::{DelayLine, VariableDelay};
use crate::environment::law::{AnyPart, Law, LawContext, LawOf};
use crate::environment::turn::Turn;
use crate::environment::velocity::{AnyVelocity, Velocity};
use crate::number::Number;

/// The law of a torque profile.
#[derive(Clone, Debug)]
pub struct ProfileLaw<N: Number, K, V, D, S> {
    /// Parts of a cell per rad.
    parts: N::Coefficient,
    /// The place of the lower end in parts from the angle zero.
    from: i32,
    /// Parts between the ends; all parts if there are no ends.
    span: u32,
    /// The place of the first knot.
    origin: i32,
    knots: K,
    /// Torque of a part of a unit.
    torque: N::Coefficient,
    /// The lower and the upper end.
    ends: [End<N>; 2],
    /// Stiffness beyond the ends.
    stiffness: N::Coefficient,
    turn: Turn<N>,
    velocity: V,
    delay: D,
    snap: S,
    /// The steepest rise in N m/rad, an `f64` as bytes, so that the law needs no alignment of its own.
    steepest: [u8; 8],
}

/// An end of the range.
#[derive(Clone, Copy, Debug)]
struct End<N> {
    /// Its angle.
    angle: N,
    /// The torque there.
    torque: N,
}

impl<N: Number> AnyPart<N> for Profile {
    type Law = ProfileLaw<N, &'static [i16], AnyVelocity<N>, VariableDelay<N>, AnySnap<N>>;
}

impl<N, K, V, D, S> LawOf<N, Profile> for ProfileLaw<N, K, V, D, S>
where
    N: Number,
    K: KnotTable,
    V: Velocity<N>,
    D: DelayLine<N>,
    S: Holding<N>,
{
    fn law_of(profile: &Profile, context: &LawContext) -> Result<Self, BuildError> {
        let Some(selection) = &profile.modes else { return Self::of_one(profile, context) };
        // A number format that cannot represent one of the modes is refused for the program, so that no mode
        // is refused later.
        for mode in selection.modes() {
            Self::of_one(&Profile::of_mode(mode, *selection, profile.delay), context)?;
        }
        // Before this mode the device may have turned freely.
        let law = Self::of_one(profile, context)?;
        Ok(match profile.ends {
            Some(Ends { from, to, .. }) => Self { turn: Turn::nearest_to([from, to]), ..law },
            None => law,
        })
    }
}

impl<N: Number, K: KnotTable, V: Velocity<N>, D: DelayLine<N>, S: Holding<N>>
    ProfileLaw<N, K, V, D, S>
{
    /// The law of a profile alone or of a mode.
    fn of_one(profile: &Profile, context: &LawContext) -> Result<Self, BuildError> {
        let Some(knots) = K::of(&profile.table) else { return Err(BuildError::LawElsewhere) };
        let (outline, layout) = (&profile.outline(), &profile.layout());
        let velocity = V::of(profile.damper().as_ref(), context.period)?;
        let delay = D::at_rest(profile.delay)?;
        let scale = Scale::of(layout, outline);
        let unrepresentable = |name| move |reason| BuildError::Unrepresentable { name, reason };
        let parts =
            N::parts_scale(scale.parts_per_rad).map_err(unrepresentable("knots per rad"))?;
        let torque =
            N::part_scale(scale.torque_of_part).map_err(unrepresentable("profile torque"))?;
        let centre: N = BuildError::number("profile centre", layout.centre)?;
        let origin = centre.parts(parts);
        let stiffness = layout.ends.map_or(0.0, |ends| ends.stiffness);
        let mut law = Self {
            parts,
            from: i32::MIN,
            span: u32::MAX,
            origin,
            knots,
            torque,
            ends: [End { angle: N::ZERO, torque: N::ZERO }; 2],
            stiffness: BuildError::coefficient::<N>("stiffness of the end stops", stiffness)?,
            turn: Turn::none(),
            velocity,
            delay,
            snap: S::of(profile, origin)?,
            steepest: steepest_rise(layout, outline).max(f64::MIN_POSITIVE).to_ne_bytes(),
        };
        match &layout.ends {
            Some(ends) => law.limit(ends)?,
            None => law.turn = Turn::endless()?,
        }
        Ok(law)
    }

    /// Sets the ends.
    fn limit(&mut self, ends: &Ends) -> Result<(), BuildError> {
        let from: N = BuildError::number("lower end stop", ends.from)?;
        let to: N = BuildError::number("upper end stop", ends.to)?;
        self.from = from.parts(self.parts);
        self.span = to.parts(self.parts).wrapping_sub(self.from).cast_unsigned();
        self.ends = [from, to].map(|angle| {
            let torque = self.inside(angle.parts(self.parts));
            End { angle, torque }
        });
        Ok(())
    }

    /// The torque in N m with the environment at `x` (rad), undelayed.
    #[inline(always)]
    fn torque(&self, x: N) -> N {
        let place = x.parts(self.parts);
        let torque = if place.wrapping_sub(self.from).cast_unsigned() <= self.span {
            self.inside(place)
        } else {
            // The spring beyond the nearer end, from the torque there.
            let [lower, upper] = &self.ends;
            let end = if place < self.from { lower } else { upper };
            x.minus(end.angle).times(self.stiffness).plus(end.torque)
        };
        self.velocity.add_to(self.snap.add_to(torque, place), x)
    }

    #[inline(always)]
    fn inside(&self, place: i32) -> N {
        N::of_parts(self.knots.units_at(place.wrapping_sub(self.origin)), self.torque)
    }
}

/// The steepest rise of a profile in N m/rad, in its table and beyond its ends, in each case plus the line to
/// a snap point.
fn steepest_rise(layout: &Layout, outline: &Outline) -> f64 {
    let scale = Scale::of(layout, outline);
    let stiffness = layout.ends.map_or(0.0, |ends| ends.stiffness);
    let line = layout.snap.map_or(0.0, |snap| snap.torque_of_part(layout.torque, outline.knots));
    scale.steepest_rise(outline).max(stiffness) + line * scale.parts_per_rad
}

impl<N: Number, K: KnotTable, V: Velocity<N>, D: DelayLine<N>, S: Holding<N>> Law<N>
    for ProfileLaw<N, K, V, D, S>
{
    #[inline(always)]
    fn evaluate(&self, x: N) -> Response<N> {
        // The torque of an undelayed profile is that of the position in front of the coupling.
        Response::Held(self.delay.due().unwrap_or_else(|| self.torque(x)))
    }

    #[inline(always)]
    fn update(&mut self, x_e: N) {
        // This position decides the branch of the next ticks.
        self.snap.update(x_e.parts(self.parts));
        if self.delay.due().is_some() {
            let torque = self.torque(x_e);
            self.delay.push(torque);
        }
        self.velocity.update(x_e);
    }

    fn rest_at(&mut self, x_e: N) {
        self.velocity.rest_at(x_e);
        self.snap.rest_at(x_e.parts(self.parts));
        let torque = self.torque(x_e);
        self.delay.fill(torque);
    }

    fn slopes(&self) -> Slopes {
        match self.delay.due() {
            Some(_) => Slopes::default(),
            // In front of the coupling, where `1 + line V` must be positive.
            None => Slopes { line: -f64::from_ne_bytes(self.steepest), wall: 0.0 },
        }
    }

    #[inline(always)]
    fn turn(&mut self) -> Option<&mut Turn<N>> {
        Some(&mut self.turn)
    }

    fn shift(&mut self, by: N) {
        self.velocity.shift(by);
        self.snap.shift(by.parts(self.parts));
    }

    fn hysteresis(&self) -> f64 {
        self.snap.hysteresis()
    }
}
