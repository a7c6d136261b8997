//! Both rules of the certificate, decided exactly (theory, sections 4 and 4.1).

use crate::exact::Q;
use crate::index::{Defect, Index};
use crate::poly::Poly;
use num_traits::{One, Zero};
use std::cmp::Ordering;

/// A linear scene in exact numbers.
#[derive(Clone, Debug)]
pub struct Exact {
    /// Numerator of the environment, delay and declared zeros included.
    pub numerator: Poly,
    /// Denominator of the environment.
    pub denominator: Poly,
    /// Period in s.
    pub period: Q,
    /// Output strict passivity of the device in N m s/rad.
    pub delta: Q,
    /// Coupling stiffness in N m/rad; `None` is rigid.
    pub coupling: Option<Q>,
}

/// Why the exact rule says no before any index is compared.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NoIndex {
    /// The algebraic loop of coupling and environment has no solution.
    IllPosed,
    /// The environment is not passive at any index.
    Defect(Defect),
}

impl Exact {
    /// Index of the environment alone.
    ///
    /// # Errors
    /// Where it does not exist.
    pub fn alpha(&self) -> Result<Index, Defect> {
        Index::of(&self.numerator, &self.denominator, &self.period)
    }

    /// Index of `E' = E / (1 + E (V - T / (2 delta)))`.
    ///
    /// # Errors
    /// Where it does not exist.
    pub fn alpha_coupled(&self) -> Result<Index, NoIndex> {
        let compliance = self.compliance();
        if self.loop_gain(&compliance).is_zero() {
            return Err(NoIndex::IllPosed);
        }
        let two = Q::from_integer(2.into());
        let excess = compliance - &self.period / (two * &self.delta);
        let denominator = self.denominator.plus(&self.numerator.scaled(&excess));
        if denominator.is_zero() {
            return Err(NoIndex::Defect(Defect::Improper));
        }
        Index::of(&self.numerator, &denominator, &self.period).map_err(NoIndex::Defect)
    }

    /// Whether equations 17 to 19 hold: `max(0, alpha) < K T / 2 <= delta` and `alpha < delta`.
    pub fn passes_paper(&self) -> bool {
        let (Some(stiffness), Ok(alpha)) = (&self.coupling, self.alpha()) else { return false };
        let limit = stiffness * &self.period / Q::from_integer(2.into());
        let well_posed = !self.loop_gain(&self.compliance()).is_zero();
        well_posed
            && limit > Q::zero()
            && limit <= self.delta
            && alpha.compare(&limit) == Ordering::Less
            && alpha.compare(&self.delta) == Ordering::Less
    }

    /// Whether the exact rule holds: `alpha(E') < delta`.
    pub fn passes_exact(&self) -> bool {
        self.alpha_coupled().is_ok_and(|alpha| alpha.compare(&self.delta) == Ordering::Less)
    }

    fn compliance(&self) -> Q {
        self.coupling.as_ref().map_or_else(Q::zero, |k| Q::one() / k)
    }

    /// `1 + E(inf) V(inf)`.
    fn loop_gain(&self, compliance: &Q) -> Q {
        if self.numerator.degree() < self.denominator.degree() || self.numerator.is_zero() {
            return Q::one();
        }
        Q::one() + self.numerator.leading() / self.denominator.leading() * compliance
    }
}
