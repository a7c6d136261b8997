//! Hosts that want energy out of a servo, beside a simulated one: what they send, what the servo gives, and
//! what the hand gets of it.

mod energy;
mod law;
mod run;
mod servo;
#[cfg(test)]
mod tests;

pub use energy::HostEnergy;
pub use law::{HostLaw, HostSender, HostileHost, Reading};
pub use run::HostRun;
pub use servo::{HostTick, HostedServo, unlimited};
