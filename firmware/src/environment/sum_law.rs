//! The law of a sum of parts.

use super::law::{AnyPart, Law, LawContext, LawOf};
use super::parts::{Parts, for_each_part};
use super::turn::Turn;
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

macro_rules! sum_law {
    ($($law:ident $part:ident: $data:ty,)+) => {
        /// The sum of the laws of all parts.
        ///
        /// It adds them in one order, so that the torques of every sum are the same bits, however its parts are
        /// stored.
        #[derive(Clone, Debug)]
        pub struct SumLaw<$($law),+> {
            $($part: $law),+
        }

        /// The law of any sum of parts.
        pub type AnySumLaw<N> = SumLaw<$(Option<<$data as AnyPart<N>>::Law>),+>;

        impl<N: Number, $($law: Part<N>),+> LawOf<N, Parts> for SumLaw<$($law),+>
        where
            $($law::Law: LawOf<N, $data>),+
        {
            fn law_of(parts: &Parts, context: &LawContext) -> Result<Self, BuildError> {
                Ok(Self { $($part: $law::of(parts.$part.as_ref(), context)?),+ })
            }
        }

        impl<N: Number, $($law: Part<N>),+> Law<N> for SumLaw<$($law),+> {
            #[inline(always)]
            fn evaluate(&self, x: N) -> Response<N> {
                let mut sum = None;
                $(for law in self.$part.laws() {
                    sum = Some(added(sum, law.evaluate(x)));
                })+
                sum.unwrap_or(Response::Held(N::ZERO))
            }

            #[inline(always)]
            fn update(&mut self, x_e: N) {
                $(for law in self.$part.laws_mut() {
                    law.update(x_e);
                })+
            }

            fn rest_at(&mut self, x_e: N) {
                $(for law in self.$part.laws_mut() {
                    law.rest_at(x_e);
                })+
            }

            // Only a profile repeats in every turn.
            #[inline(always)]
            fn turn(&mut self) -> Option<&mut Turn<N>> {
                self.profile.laws_mut().first_mut().and_then(Law::turn)
            }

            fn shift(&mut self, by: N) {
                $(for law in self.$part.laws_mut() {
                    law.shift(by);
                })+
            }

            // Only a profile snaps.
            fn hysteresis(&self) -> f64 {
                self.profile.laws().first().map_or(f64::INFINITY, Law::hysteresis)
            }

            fn slopes(&self) -> Slopes {
                let mut sum = Slopes::default();
                $(for law in self.$part.laws() {
                    sum = sum.plus(law.slopes());
                })+
                sum
            }
        }
    };
}
for_each_part!(sum_law);

#[inline(always)]
fn added<N: Number>(sum: Option<Response<N>>, part: Response<N>) -> Response<N> {
    match sum {
        Some(sum) => sum.plus(part),
        None => part,
    }
}

#[cfg(test)]
mod tests;
