//! A device as a chain of masses: the motor drives the first, the hand holds the last.
//!
//! ```text
//!  F -> [m1]--(k1, c1)--[m2]--(k2, c2)-- .. --[mN] <- hand       bN: damper from mass to ground
//!        b1               b2                    bN
//! ```
//!
//! A certificate needs one number of the chain: the output strict passivity [`Chain::excess_passivity`]
//! between motor torque and velocity at the encoder, in every passive hand (theory, section 3).

mod disk;
mod exact;
mod infimum;
mod lump;
mod passivity;
pub mod two_port;

use haptic_servo::scene::Device;
use haptic_servo::words;
use serde::Serialize;
use thiserror::Error;

pub use passivity::{ExcessPassivity, NoPassivity, Reached};

/// Largest number of masses in a chain: more modes than are ever identified on one axis. The polynomials of
/// `omega^2` have the degree `2 (N - 2)`.
pub const MAX_MASSES: usize = 10;

/// A mass that turns, with a damper to the ground.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mass {
    /// Inertia in kg m^2, greater than 0.
    pub inertia: f64,
    /// Damping against the ground in N m s/rad, 0 or more.
    pub damping: f64,
}

/// The connection of two masses: a spring and a damper side by side.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Link {
    /// Stiffness in N m/rad, 0 or more.
    pub stiffness: f64,
    /// Damping in N m s/rad, 0 or more; stiffness and damping are not both 0.
    pub damping: f64,
}

words! {
    /// Which mass the encoder is on, in a file's word.
    #[derive(Default)]
    EncoderPlace {
    /// On the motor's, the first: collocated.
    #[default]
    Motor "motor",
    /// On the hand's, the last.
    Hand "hand",
    }
}

/// A chain of masses, checked when it was made.
#[derive(Clone, Debug, PartialEq)]
pub struct Chain {
    masses: Vec<Mass>,
    links: Vec<Link>,
    encoder: EncoderPlace,
    actuator_lag: f64,
}

/// Why these numbers are not a chain.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum ChainError {
    /// Number of masses.
    #[error("a chain has 1 to {MAX_MASSES} masses, not {0}")]
    Masses(usize),
    /// Number of links.
    #[error("{masses} masses are held together by {} links, not {links}", masses - 1)]
    Links {
        /// How many masses there are.
        masses: usize,
        /// How many links there are.
        links: usize,
    },
    /// A number out of the range of a mass, link or amplifier.
    #[error("the {what} is {value}; it must be {bound}")]
    OutOfBounds {
        /// Which number.
        what: String,
        /// Its value.
        value: f64,
        /// Its range.
        bound: &'static str,
    },
    /// A link without spring and damper.
    #[error("link {0} has neither stiffness nor damping: it connects nothing")]
    Open(usize),
}

impl Chain {
    /// Masses and links from the motor to the hand, the encoder on the motor's mass, no lag.
    pub fn new(masses: Vec<Mass>, links: Vec<Link>) -> Result<Self, ChainError> {
        if masses.is_empty() || masses.len() > MAX_MASSES {
            return Err(ChainError::Masses(masses.len()));
        }
        if links.len() + 1 != masses.len() {
            return Err(ChainError::Links { masses: masses.len(), links: links.len() });
        }
        for (index, mass) in masses.iter().enumerate() {
            positive(|| format!("inertia of mass {}", index + 1), mass.inertia)?;
            not_negative(|| format!("damping of mass {}", index + 1), mass.damping)?;
        }
        for (index, link) in links.iter().enumerate() {
            not_negative(|| format!("stiffness of link {}", index + 1), link.stiffness)?;
            not_negative(|| format!("damping of link {}", index + 1), link.damping)?;
            if link.stiffness == 0.0 && link.damping == 0.0 {
                return Err(ChainError::Open(index + 1));
            }
        }
        Ok(Self { masses, links, encoder: EncoderPlace::Motor, actuator_lag: 0.0 })
    }

    /// One mass, held by the hand and driven by the motor.
    pub fn rigid(inertia: f64, damping: f64) -> Result<Self, ChainError> {
        Self::new(vec![Mass { inertia, damping }], Vec::new())
    }

    /// The same chain with the encoder there.
    pub fn with_encoder(self, encoder: EncoderPlace) -> Self {
        Self { encoder, ..self }
    }

    /// The same chain behind an amplifier that follows as `1 / (1 + lag s)`; `lag` in s.
    pub fn with_actuator_lag(self, lag: f64) -> Result<Self, ChainError> {
        not_negative(|| "lag of the amplifier".to_owned(), lag)?;
        Ok(Self { actuator_lag: lag, ..self })
    }

    /// The same chain behind an amplifier that follows at once.
    pub fn without_lag(self) -> Self {
        Self { actuator_lag: 0.0, ..self }
    }

    /// The same chain with another damping in N m s/rad of the motor's mass against the ground.
    pub fn with_motor_damping(mut self, damping: f64) -> Result<Self, ChainError> {
        not_negative(|| "damping of mass 1".to_owned(), damping)?;
        if let Some(motor) = self.masses.first_mut() {
            motor.damping = damping;
        }
        Ok(self)
    }

    /// The rigid body that stands for the chain in a certificate: total inertia, total damping to the ground,
    /// and the lower end of the chain's passivity if the chain is not rigid. The passivity is limited to the
    /// damping: the sum of the dampings is rounded and may be a last bit below it.
    pub fn as_rigid(&self) -> Result<Device, NoPassivity> {
        let passivity = match self.is_rigid() {
            true => None,
            false => Some(self.excess_passivity()?.delta.lo().min(self.damping())),
        };
        Ok(Device { inertia: self.inertia(), damping: self.damping(), passivity })
    }

    /// Masses from the motor to the hand.
    pub fn masses(&self) -> &[Mass] {
        &self.masses
    }

    /// Links from the motor to the hand, one fewer than masses.
    pub fn links(&self) -> &[Link] {
        &self.links
    }

    /// Where the encoder is.
    pub fn encoder(&self) -> EncoderPlace {
        self.encoder
    }

    /// The number of the mass that the encoder is on, counted from the motor's.
    pub fn encoder_mass(&self) -> usize {
        if self.encoder == EncoderPlace::Motor { 0 } else { self.masses.len() - 1 }
    }

    /// Time constant of the amplifier in s, 0 where it follows at once.
    pub fn actuator_lag(&self) -> f64 {
        self.actuator_lag
    }

    /// Whether motor and encoder are on the same mass.
    pub fn is_collocated(&self) -> bool {
        self.encoder == EncoderPlace::Motor || self.masses.len() == 1
    }

    /// Whether this is one mass without a lag, which needs no model beyond inertia and damping.
    pub fn is_rigid(&self) -> bool {
        self.masses.len() == 1 && self.actuator_lag == 0.0
    }

    /// Total inertia in kg m^2, which is felt if all masses move together.
    pub fn inertia(&self) -> f64 {
        self.masses.iter().map(|mass| mass.inertia).sum()
    }

    /// Total damping in N m s/rad, which is felt if all masses move together.
    pub fn damping(&self) -> f64 {
        self.masses.iter().map(|mass| mass.damping).sum()
    }
}

fn positive(what: impl Fn() -> String, value: f64) -> Result<(), ChainError> {
    within(value.is_finite() && value > 0.0, what, value, "finite and greater than 0")
}

fn not_negative(what: impl Fn() -> String, value: f64) -> Result<(), ChainError> {
    within(value.is_finite() && value >= 0.0, what, value, "finite, 0 or more")
}

fn within(
    holds: bool,
    what: impl Fn() -> String,
    value: f64,
    bound: &'static str,
) -> Result<(), ChainError> {
    if holds { Ok(()) } else { Err(ChainError::OutOfBounds { what: what(), value, bound }) }
}

#[cfg(test)]
mod tests;
