//! A torque from a host beside a certified scene, under an energy budget.
//!
//! A host sends torques that nobody can certify: late, held, wrong. The servo adds them to the torque of its
//! scene and keeps a [`Tank`] of energy. A torque is scaled down to what the tank can pay for the worst motion
//! of a passive hand. So the hand gets from the host at most the budget: the energy at once, and the power
//! times the time (theory, section 19).
//!
//! The scene must certify with a part of the device's damping less, the host's *share*. That share pays for
//! the torque of a tick before its motion is known, so no bound on the speed is needed.

mod any;
mod beside;
mod channel;
mod error;
mod response;
mod stream;
mod tank;
#[cfg(test)]
mod tests;

pub use any::AnyHosted;
#[cfg(feature = "wire")]
pub use beside::Nothing;
pub use beside::{
    BesideServo, HostTimes, Hosted, NoHost, Reported, ServoNumbers, Taken, TickState,
};
pub use channel::{HostChannel, HostWords};
pub use error::HostError;
pub use response::{HostResponse, Sampling};
pub use tank::{Tank, TankNumbers};

/// What a host may do.
///
/// ```
/// use haptic_servo::host::{HostError, HostTorque};
///
/// let host = HostTorque { energy: 0.05, power: 0.5, damping: 0.004, torque: 0.5, timeout: 0.05 };
/// assert!(host.check().is_ok());
/// assert!(host.check_share(Some(0.005)).is_ok());
/// let error = host.check_share(Some(0.003)).unwrap_err();
/// assert!(error.to_string().contains("margin of 0.003 N m s/rad"), "{error}");
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "wire", derive(serde::Serialize, serde::Deserialize))]
pub struct HostTorque {
    /// Energy in J that the hand can get at once: the level at the start, and the highest.
    pub energy: f64,
    /// Power in W at which the level rises: what the hand can get on average. With 0 the servo is a passive
    /// device, which comes to rest.
    pub power: f64,
    /// The share in N m s/rad of the device's damping that pays for the host's torque; below the scene's margin.
    pub damping: f64,
    /// Largest torque in N m.
    pub torque: f64,
    /// Time in s after which a torque without a successor has faded to zero.
    pub timeout: f64,
}

impl HostTorque {
    /// Checks the numbers alone.
    ///
    /// # Errors
    /// The first number that has no meaning, and its bound.
    pub const fn check(&self) -> Result<(), HostError> {
        let Self { energy, power, damping, torque, timeout } = *self;
        ok!(HostError::unless_positive("energy", energy, "J"));
        if !(power >= 0.0 && power.is_finite()) {
            return Err(HostError::Power { power });
        }
        ok!(HostError::unless_positive("share of damping", damping, "N m s/rad"));
        ok!(HostError::unless_positive("largest torque", torque, "N m"));
        HostError::unless_positive("timeout", timeout, "s")
    }

    /// Checks the share against the margin in N m s/rad of the scene beside it, without the host; `None` if
    /// the scene has no known margin.
    ///
    /// # Errors
    /// If the share is not below the margin.
    pub const fn check_share(&self, margin: Option<f64>) -> Result<(), HostError> {
        let damping = self.damping;
        match margin {
            Some(margin) if margin > 0.0 && damping < margin => Ok(()),
            Some(margin) if margin > 0.0 => Err(HostError::Share { damping, margin }),
            _ => Err(HostError::NoMargin { damping }),
        }
    }

    /// Checks that neither torque limits the other: that of the host and the scene's limit in N m are together
    /// within the full scale of the DAC.
    ///
    /// # Errors
    /// If they are not, or the scene has no limit.
    pub const fn check_range(&self, limit: Option<f64>, full_scale: f64) -> Result<(), HostError> {
        let torque = self.torque;
        match limit {
            Some(limit) if torque + limit <= full_scale => Ok(()),
            Some(limit) => Err(HostError::Range { torque, limit, full_scale }),
            None => Err(HostError::Unlimited { torque, full_scale }),
        }
    }
}
