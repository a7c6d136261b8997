//! The output strict passivity of a chain, located exactly (theory, section 3.2).

use haptic_servo::passivity::interval::Interval;
use num_bigint::BigInt;
use num_rational::BigRational;
use num_traits::{One, Pow, ToPrimitive, Zero};
use thiserror::Error;

use super::Chain;
use super::disk::{Disk, places};
use super::exact::Decimal;
use super::infimum::infimum;
use super::two_port::TwoPort;
use crate::quantity::significant;

/// Bits to which the infimum is enclosed: three more than a double has.
const PRECISION: u32 = 56;

/// Bits by which `delta` may be below all the damping to the ground before it counts as 0.
const HIDDEN: u32 = 50;

/// `delta` of a device and where it is reached.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ExcessPassivity {
    /// `delta` in N m s/rad, to within the last digit.
    pub value: f64,
    /// Enclosure of it, with each number of the device taken as its shortest decimal.
    pub delta: Interval,
    /// The frequency at which it is reached.
    pub reached: Reached,
}

/// Frequency at which the impedance of a device can come nearest to passivity's bound.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Reached {
    /// At all frequencies: the bound does not depend on the frequency.
    Everywhere,
    /// In the limit of frequency 0.
    AtRest,
    /// At this angular frequency in rad/s.
    At(f64),
    /// In the limit of infinite frequency.
    AtInfinity,
}

impl Reached {
    /// The angular frequency in rad/s; 0 if it is reached at any, `None` if it is infinite.
    pub fn omega(self) -> Option<f64> {
        match self {
            Self::Everywhere | Self::AtRest => Some(0.0),
            Self::At(omega) => Some(omega),
            Self::AtInfinity => None,
        }
    }
}

/// Why a device has no output strict passivity at all, whatever its damping.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
pub enum NoPassivity {
    /// The encoder does not see the mass that the motor drives.
    #[error(
        "the motor drives the first mass and the encoder sees the last: beyond the resonance \
         between them they move against each other, so a torque that brakes the one drives the \
         other{}; put the encoder on the motor's mass",
        witness(*.omega)
    )]
    EncoderAtHand {
        /// An angular frequency in rad/s at which the empty-handed device is not passive.
        omega: Option<f64>,
    },
    /// The amplifier follows late.
    #[error(
        "the amplifier's lag of {lag} s turns inertia into negative damping, Re(1/J) = b - m lag \
         omega^2: a heavy hand makes it negative at any frequency, and the empty-handed device is \
         not passive beyond {} rad/s; use a faster amplifier, and account for its lag as \
         delay",
        significant(*.omega, 4)
    )]
    ActuatorLag {
        /// Time constant in s.
        lag: f64,
        /// Angular frequency in rad/s beyond which the first mass alone, with all the damping that
        /// acts on it, is not passive: `sqrt(b / (m lag))`.
        omega: f64,
    },
}

fn witness(omega: Option<f64>) -> String {
    omega.map_or_else(String::new, |omega| {
        format!(" (Re J is negative at {} rad/s)", significant(omega, 4))
    })
}

impl Chain {
    /// The largest `delta` for which motor torque to encoder velocity is `delta`-output strictly
    /// passive in every passive hand: the infimum over all frequencies of
    ///
    /// ```text
    /// R22 - (|Z12 Z21| + Re(Z12 Z21)) / (2 R11)        port 1 hand, port 2 motor
    /// ```
    ///
    /// enclosed by arithmetic that does not round; no grid of frequencies is involved.
    ///
    /// ```
    /// use haptic_model::chain::{Chain, Link, Mass};
    /// let motor = Mass { inertia: 2e-5, damping: 0.02 };
    /// let handle = Mass { inertia: 3e-5, damping: 0.005 };
    /// let belt = Link { stiffness: 40.0, damping: 0.015 };
    /// let device = Chain::new(vec![motor, handle], vec![belt])?;
    /// let delta = device.excess_passivity().unwrap().delta;
    /// // b1 + b2 c / (b2 + c), whatever the masses and the stiffness
    /// assert!(delta.contains(0.02 + 0.005 * 0.015 / 0.02));
    /// # Ok::<(), haptic_model::chain::ChainError>(())
    /// ```
    pub fn excess_passivity(&self) -> Result<ExcessPassivity, NoPassivity> {
        if !self.is_collocated() {
            return Err(NoPassivity::EncoderAtHand { omega: self.witness() });
        }
        if self.actuator_lag() > 0.0 {
            return Err(self.lag_obstacle());
        }
        let places = places(self);
        let motor = Decimal::of(self.masses()[0].damping).whole(places);
        let (lower, upper, reached) = self.behind_motor(places, &motor);
        let unit = BigInt::from(10).pow(places);
        let [lower, upper] = [lower, upper].map(|behind| (behind + &motor) / &unit);
        let value = upper.to_f64().unwrap_or(f64::INFINITY);
        let delta = Interval::new(below(&lower), above(&upper));
        Ok(ExcessPassivity { value, delta, reached })
    }

    /// Bounds of the damping that the rest of the chain adds to `motor`, the damping of its first mass.
    fn behind_motor(&self, places: u32, motor: &BigInt) -> (BigRational, BigRational, Reached) {
        let Disk { touch, curvature, .. } = Disk::behind_motor(self, places);
        if touch.is_zero() || curvature.is_zero() {
            // There is no damper behind the motor's mass that a hand could not bypass.
            return (BigRational::zero(), BigRational::zero(), Reached::Everywhere);
        }
        let common = touch.trailing_zeros().min(curvature.trailing_zeros());
        let (p, r) = (touch.shifted_down(common), curvature.shifted_down(common));
        let grounds = self.masses().iter().map(|mass| Decimal::of(mass.damping).whole(places));
        let least = BigRational::new_raw(grounds.sum(), BigInt::one() << HIDDEN);
        let tolerance = |found: &BigRational| {
            let delta =
                BigRational::new_raw(found.numer() + motor * found.denom(), found.denom().clone());
            let (numerator, denominator) = delta.max(least.clone()).into_raw();
            BigRational::new_raw(numerator, denominator << PRECISION)
        };
        let found = infimum(&p, &r, tolerance);
        let reached = match found.minimizer {
            _ if p.degree().max(r.degree()) == 0 => Reached::Everywhere,
            0.0 => Reached::AtRest,
            f64::INFINITY => Reached::AtInfinity,
            square => Reached::At(square.sqrt()),
        };
        (found.lower, found.upper, reached)
    }

    fn lag_obstacle(&self) -> NoPassivity {
        let motor = self.masses()[0];
        let damping = motor.damping + self.links().first().map_or(0.0, |link| link.damping);
        let lag = self.actuator_lag();
        NoPassivity::ActuatorLag { lag, omega: (damping / (motor.inertia * lag)).sqrt() }
    }

    /// A frequency at which the device without a hand is clearly not passive between motor and encoder,
    /// searched around its resonances.
    fn witness(&self) -> Option<f64> {
        let slowest = |link: f64| (link / self.inertia()).sqrt();
        let stiffest = self.links().iter().map(|link| link.stiffness).fold(0.0, f64::max);
        let damped = self.links().iter().map(|link| link.damping).fold(0.0, f64::max);
        let start = slowest(stiffest).max(damped / self.inertia());
        let phase = |omega: f64| {
            let transfer = TwoPort::of(self, omega).hand_by_motor;
            transfer.re / transfer.norm()
        };
        (-20..=60)
            .map(|step| start * 1.2f64.powi(step))
            .filter(|&omega| phase(omega) < -0.1)
            .min_by(|a, b| a.total_cmp(b))
    }
}

/// The largest double that is not above an exact number.
fn below(exact: &BigRational) -> f64 {
    let near = exact.to_f64().unwrap_or(0.0);
    let is_above = BigRational::from_float(near).is_none_or(|near| near > *exact);
    if is_above { near.next_down() } else { near }
}

/// The smallest double that is not below an exact number.
fn above(exact: &BigRational) -> f64 {
    let near = exact.to_f64().unwrap_or(f64::INFINITY);
    let is_below = BigRational::from_float(near).is_some_and(|near| near < *exact);
    if is_below { near.next_up() } else { near }
}
