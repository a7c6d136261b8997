//! The law of a sum of parts.

use super::canceller::{Canceller, CancellerLaw};
use super::delay_line::VariableDelay;
use super::law::{Law, LawContext, LawOf};
use super::parts::Parts;
use super::profile::{AnySnap, Profile, ProfileLaw};
use super::turn::Turn;
use super::velocity::AnyVelocity;
use super::wall::Wall;
use super::wall_law::{AnyPlace, WallLaw};
use crate::build_error::BuildError;
use crate::coupling::{Response, Slopes};
use crate::number::Number;

/// The laws of one kind of part, none or one: an array in a program, so that the compiler leaves out the code of
/// absent parts, or an [`Option`] for scenes as data.
pub trait Part<N: Number>: Clone + core::fmt::Debug + Sized {
    /// The law of the part.
    type Law: Law<N>;
    /// The law of a part, if there is one.
    ///
    /// # Errors
    /// If the law does not exist, or there must be none, or one.
    fn of<D>(part: Option<&D>, context: &LawContext) -> Result<Self, BuildError>
    where
        Self::Law: LawOf<N, D>;
    /// The law, if there is one.
    fn laws(&self) -> &[Self::Law];
    /// The law, if there is one.
    fn laws_mut(&mut self) -> &mut [Self::Law];
}

impl<N: Number, L: Law<N> + Clone + core::fmt::Debug> Part<N> for Option<L> {
    type Law = L;

    fn of<D>(part: Option<&D>, context: &LawContext) -> Result<Self, BuildError>
    where
        L: LawOf<N, D>,
    {
        part.map(|part| L::law_of(part, context)).transpose()
    }

    #[inline(always)]
    fn laws(&self) -> &[L] {
        self.as_slice()
    }

    #[inline(always)]
    fn laws_mut(&mut self) -> &mut [L] {
        self.as_mut_slice()
    }
}

macro_rules! part_of_a_program {
    ($($count:literal: |$part:ident, $context:ident| $laws:expr;)*) => {$(
        impl<N: Number, L: Law<N> + Clone + core::fmt::Debug> Part<N> for [L; $count] {
            type Law = L;

            fn of<D>($part: Option<&D>, $context: &LawContext) -> Result<Self, BuildError>
            where
                L: LawOf<N, D>,
            {
                $laws
            }

            #[inline(always)]
            fn laws(&self) -> &[L] {
                self
            }

            #[inline(always)]
            fn laws_mut(&mut self) -> &mut [L] {
                self
            }
        }
    )*};
}

part_of_a_program! {
    0: |part, _context| if part.is_none() { Ok([]) } else { Err(BuildError::Structure) };
    1: |part, context| match part {
        Some(part) => Ok([L::law_of(part, context)?]),
        None => Err(BuildError::Structure),
    };
}

/// The sum of a canceller, a wall and a torque profile.
///
/// It adds the wall to the profile and the canceller to both, so that the torques of every sum are the same
/// bits, however its parts are stored.
#[derive(Clone, Debug)]
pub struct SumLaw<C, W, P> {
    canceller: C,
    wall: W,
    profile: P,
}

/// The law of any sum of parts.
pub type AnySumLaw<N> = SumLaw<
    Option<CancellerLaw<N, VariableDelay<N>>>,
    Option<WallLaw<N, AnyVelocity<N>, AnyPlace<N>, VariableDelay<N>>>,
    Option<ProfileLaw<N, &'static [i16], AnyVelocity<N>, VariableDelay<N>, AnySnap<N>>>,
>;

impl<N: Number, C: Part<N>, W: Part<N>, P: Part<N>> LawOf<N, Parts> for SumLaw<C, W, P>
where
    C::Law: LawOf<N, Canceller>,
    W::Law: LawOf<N, Wall>,
    P::Law: LawOf<N, Profile>,
{
    fn law_of(parts: &Parts, context: &LawContext) -> Result<Self, BuildError> {
        let Parts { canceller, wall, profile } = parts;
        Ok(Self {
            canceller: C::of(canceller.as_ref(), context)?,
            wall: W::of(wall.as_ref(), context)?,
            profile: P::of(profile.as_ref(), context)?,
        })
    }
}

/// An expression for the law of each of these parts, in this order.
macro_rules! each_law {
    ($sum:ident.{$($part:ident),+}.$laws:ident(), $law:ident => $value:expr) => {
        $(for $law in $sum.$part.$laws() {
            $value;
        })+
    };
}

impl<N: Number, C: Part<N>, W: Part<N>, P: Part<N>> Law<N> for SumLaw<C, W, P> {
    #[inline(always)]
    fn evaluate(&self, x: N) -> Response<N> {
        let mut sum = None;
        each_law!(self.{profile, wall, canceller}.laws(), law => {
            sum = Some(added(sum, law.evaluate(x)));
        });
        sum.unwrap_or(Response::Held(N::ZERO))
    }

    #[inline(always)]
    fn update(&mut self, x_e: N) {
        each_law!(self.{canceller, wall, profile}.laws_mut(), law => law.update(x_e));
    }

    fn rest_at(&mut self, x_e: N) {
        each_law!(self.{canceller, wall, profile}.laws_mut(), law => law.rest_at(x_e));
    }

    // Only a profile repeats in every turn.
    #[inline(always)]
    fn turn(&mut self) -> Option<&mut Turn<N>> {
        self.profile.laws_mut().first_mut().and_then(Law::turn)
    }

    fn shift(&mut self, by: N) {
        each_law!(self.{canceller, wall, profile}.laws_mut(), law => law.shift(by));
    }

    // Only a profile snaps.
    fn hysteresis(&self) -> f64 {
        self.profile.laws().first().map_or(f64::INFINITY, Law::hysteresis)
    }

    fn slopes(&self) -> Slopes {
        let mut sum = Slopes::default();
        each_law!(self.{wall, canceller, profile}.laws(), law => sum = sum.plus(law.slopes()));
        sum
    }
}

#[inline(always)]
fn added<N: Number>(sum: Option<Response<N>>, part: Response<N>) -> Response<N> {
    match sum {
        Some(sum) => sum.plus(part),
        None => part,
    }
}

#[cfg(test)]
mod tests;
