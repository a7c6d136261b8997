//! Impedances of passive hands: their parameters, the grid that the search starts from, and the
//! device in a hand.

use std::f64::consts::PI;

use serde::Serialize;

use crate::chain::{Chain, Link, Mass};
use crate::device::Hand;
use crate::simulation::plant::Plant;

/// A passive hand: on the device, or behind a spring and damper of its own. No number is negative,
/// so it is passive whatever they are.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct HandImpedance {
    /// Inertia in kg m^2 of the hand.
    pub inertia: f64,
    /// Damping in N m s/rad of the hand, to the ground.
    pub damping: f64,
    /// Stiffness in N m/rad of the hand, to the ground.
    pub stiffness: f64,
    /// The link between device and hand, skin and tendons; `None`: the hand is on the device.
    pub link: Option<Link>,
    /// Masses on springs, side by side, on the mass that the hand holds.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub absorbers: Vec<Absorber>,
}

impl HandImpedance {
    /// Its numbers except those of absorbers.
    pub(super) fn numbers_mut(&mut self) -> impl Iterator<Item = &mut f64> {
        let link = self.link.iter_mut().flat_map(|link| [&mut link.stiffness, &mut link.damping]);
        [&mut self.inertia, &mut self.damping, &mut self.stiffness].into_iter().chain(link)
    }
}

/// A mass on a spring of its own: at their resonance they keep the held mass at rest.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Absorber {
    /// Inertia in kg m^2 of the mass.
    pub inertia: f64,
    /// Stiffness in N m/rad of the spring.
    pub stiffness: f64,
}

/// Hands that resonate around an angle in rad a tick on a device of this inertia in kg m^2, and some
/// that do not.
pub(super) fn impedance_grid(inertia: f64, period: f64, angle: f64) -> Vec<HandImpedance> {
    let angles: Vec<f64> = [0.25, 0.5, 0.8, 1.0, 1.25, 2.0]
        .iter()
        .map(|ratio| (angle * ratio).clamp(1e-3, PI))
        .chain([0.1, 0.5, 1.5, 2.5, PI])
        .collect();
    // From a hundredth of the device to a thousand times it: a heavy hand sees the
    // controller at one angle alone, a light one moves with the device between the samples.
    let masses: Vec<f64> =
        (-4..=6).map(|step| inertia * 10_f64.powf(f64::from(step) / 2.0)).collect();
    let hand =
        |inertia, stiffness| HandImpedance { inertia, stiffness, ..HandImpedance::default() };
    let rate = |theta: f64| (theta / period).powi(2);
    let mut hands = vec![HandImpedance::default()];
    for &mass in &masses {
        hands.push(hand(mass, 0.0));
        for &theta in &angles {
            hands.push(hand(mass, (inertia + mass) * rate(theta)));
            let link = Link { stiffness: mass * rate(theta), damping: 0.0 };
            hands.push(HandImpedance { link: Some(link), ..hand(mass, 0.0) });
        }
    }
    hands.extend(angles.iter().map(|&theta| hand(0.0, inertia * rate(theta))));
    hands
}

/// A device with its inertia times `lighter`, in a hand.
pub fn plant(device: &Chain, lighter: f64, impedance: &HandImpedance) -> Plant {
    let light = |mass: &Mass| Mass { inertia: lighter * mass.inertia, ..*mass };
    let mut masses: Vec<Mass> = device.masses().iter().map(light).collect();
    let mut links = device.links().to_vec();
    let hand = match impedance.link {
        None => Hand {
            inertia: impedance.inertia,
            damping: impedance.damping,
            stiffness: impedance.stiffness,
        },
        Some(link) => {
            masses.push(Mass { inertia: impedance.inertia, damping: impedance.damping });
            links.push(link);
            Hand { inertia: 0.0, damping: 0.0, stiffness: impedance.stiffness }
        }
    };
    let held = Plant::with_encoder_at(device.encoder_mass(), &masses, &links).with_hand(hand);
    let on = |plant: Plant, absorber: &Absorber| {
        plant.with_absorber(absorber.inertia, absorber.stiffness)
    };
    let plant = impedance.absorbers.iter().fold(held, on);
    let lag = device.actuator_lag();
    if lag > 0.0 { plant.with_actuator_lag(lag) } else { plant }
}
