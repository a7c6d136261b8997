//! The set of a chain's impedances over all passive hands.
//!
//! At a frequency `w` the hand's impedance is anywhere in the right half plane, and each mass and
//! each link is a Moebius map, so the impedance that the motor feels is anywhere in a disk
//!
//! ```text
//! { d + j x + 1/(g + H) : Re H >= 0 }
//! ```
//!
//! that touches the line `Re = d`, has the diameter `1/g` and reaches `d` at height `x`. With
//! `a = g d`, `e = g x` and `f = g |d + j x|^2 + d` both maps are linear:
//!
//! ```text
//! mass, Z + m s + b:              a += b g     e += m w g    f += b (1 + 2 a) + 2 m w e + (b^2 + m^2 w^2) g
//! link, 1/Z + y, y = gamma + j h: a += gamma f e -= h f      g += gamma (1 + 2 a) - 2 h e + |y|^2 f
//! ```
//!
//! (right-hand sides from before the step). For a link `y = s/(c s + k)`; multiplied by
//! `kappa = k^2 + c^2 u`, `u = w^2`, everything is a polynomial in `u`. Factors that tend to zero with the
//! frequency are divided out by hand, `g = u G`, `a = u A`, `e = w E`: otherwise the infimum of `d = a / g`
//! is lost at low frequency in terms that cancel. Every term of `A` is positive.

use num_bigint::BigInt;
use num_traits::One;

use super::exact::{Decimal, Polynomial};
use super::{Chain, Link, Mass};

/// The disk as polynomials in `u = w^2`; `unit` stands for the number 1. Its least real part is
/// `d = touch / curvature`; both are zero where no damper holds the hand's end, so that the disk is a half
/// plane, or where there is no link.
pub struct Disk {
    unit: Polynomial,
    /// `G`.
    pub curvature: Polynomial,
    /// `A`.
    pub touch: Polynomial,
    /// `E`.
    height: Polynomial,
    /// `f`.
    admittance: Polynomial,
}

/// Power of ten that makes every number of a chain whole.
pub fn places(chain: &Chain) -> u32 {
    let masses = chain.masses().iter().flat_map(|mass| [mass.inertia, mass.damping]);
    let links = chain.links().iter().flat_map(|link| [link.stiffness, link.damping]);
    masses.chain(links).map(|value| Decimal::of(value).places()).max().unwrap_or(0)
}

impl Disk {
    /// Of the impedance behind the first mass: everything except its own inertia and damping, in units of
    /// `10^-places` N m s/rad.
    pub fn behind_motor(chain: &Chain, places: u32) -> Self {
        let mut disk = Self {
            unit: Polynomial::new(vec![BigInt::one()]),
            curvature: Polynomial::default(),
            touch: Polynomial::default(),
            height: Polynomial::default(),
            admittance: Polynomial::default(),
        };
        let masses = chain.masses();
        for (index, link) in chain.links().iter().enumerate().rev() {
            disk = disk.with_mass(&masses[index + 1], places).through(link, places);
        }
        disk
    }

    fn with_mass(self, mass: &Mass, places: u32) -> Self {
        let [m, b] = [mass.inertia, mass.damping].map(|value| Decimal::of(value).whole(places));
        // b (1 + 2 a) + 2 m w e + (b^2 + m^2 w^2) g
        let first = self.unit.plus(&self.touch.shifted_up().scaled(&BigInt::from(2))).scaled(&b);
        let second = self.height.shifted_up().scaled(&(2 * &m));
        let third = Polynomial::new(vec![&b * &b, &m * &m]).times(&self.curvature.shifted_up());
        Self {
            touch: self.touch.plus(&self.curvature.scaled(&b)),
            height: self.height.plus(&self.curvature.shifted_up().scaled(&m)),
            admittance: self.admittance.plus(&first).plus(&second).plus(&third),
            ..self
        }
    }

    fn through(self, link: &Link, places: u32) -> Self {
        let [k, c] = [link.stiffness, link.damping].map(|value| Decimal::of(value).whole(places));
        let kappa = Polynomial::new(vec![&k * &k, &c * &c]);
        let f = &self.admittance;
        // c (1 + 2 a) - 2 k e + f
        let first = self.unit.plus(&self.touch.shifted_up().scaled(&BigInt::from(2))).scaled(&c);
        let second = self.height.scaled(&(-2 * &k));
        Self {
            curvature: self.curvature.times(&kappa).plus(&first).plus(&second).plus(f),
            touch: self.touch.times(&kappa).plus(&f.scaled(&c)),
            height: self.height.times(&kappa).plus(&f.scaled(&-&k)),
            admittance: f.times(&kappa),
            unit: self.unit.times(&kappa),
        }
    }
}
