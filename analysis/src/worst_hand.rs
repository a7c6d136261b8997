//! The hand in which a scene oscillates the most: what a rejection means in practice.
//!
//! For a rigid device the rule of theory, section 4.1, is necessary as well as sufficient: below
//! the device's passivity lies an angle on the unit circle at which some passive hand makes the
//! sampled loop grow. Where the real part is smallest is where that hand resonates, so the search
//! starts from masses and springs that resonate near there, then climbs in all their numbers. A
//! hand on this device cannot take away from its inertia, and so not every rejected scene has one.

use std::f64::consts::PI;

use firmware::certificate::Loop;
use firmware::scene::Scene;
use nalgebra::Complex;
use serde::Serialize;

use crate::chain::{Chain, EncoderPlace, Link, Mass};
use crate::device::Hand;
use crate::minimum::least;
use crate::response::Response;
use crate::simulation::plant::Plant;
use crate::simulation::{Experiment, SimulationError, Stride};
use crate::stability::{closed_loop, eigenvalues};

/// What makes a loop count as growing: so much a tick above 1.
pub const GROWS: f64 = 1e-9;

/// Angle in rad a tick below which a motion creeps rather than resonates.
const CREEPS: f64 = 1e-2;

/// Heaviest hand, over the device: far beyond, two eigenvalues near 1 can no longer be told apart.
const HEAVIEST: f64 = 1e4;

/// A passive hand: on the device, or behind a spring and damper of its own. No number is negative,
/// so it is passive whatever they are.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Grip {
    /// Inertia in kg m^2 of the hand.
    pub inertia: f64,
    /// Damping in N m s/rad of the hand, to the ground.
    pub damping: f64,
    /// Stiffness in N m/rad of the hand, to the ground.
    pub stiffness: f64,
    /// What is between device and hand; `None`: the hand is on the device.
    pub link: Option<Compliance>,
}

/// Skin and tendons between the device and a hand.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Compliance {
    /// Stiffness in N m/rad.
    pub stiffness: f64,
    /// Damping in N m s/rad.
    pub damping: f64,
}

/// A hand, and what the loop does in it.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Held {
    /// Inertia in kg m^2 of the device.
    pub device_inertia: f64,
    /// The hand.
    pub hand: Grip,
    /// Factor by which the motion that resonates grows a tick; below 1 it dies away.
    pub spectral_radius: f64,
    /// Frequency in Hz of that motion.
    pub frequency: f64,
}

/// What the search came to.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Search {
    /// The worst hand of all that were tried.
    pub worst: Held,
    /// Whether the loop grows in it.
    pub oscillates: bool,
    /// Where it does not: a hand on a lighter device of the same damping in which it would. The
    /// certificate counts on the damping alone.
    pub lighter: Option<Held>,
    /// Number of hands that were tried.
    pub tried: usize,
}

/// Looks for the passive hand in which the loop of a scene on a device grows the most.
///
/// One-sidedness, torque limit and converters are left out: the scene is what it is deep inside
/// its wall. For a scene that is certified with the passivity that its device has, no hand in
/// which it grows exists, so none is found.
///
/// # Errors
/// Where the scene has no closed loop.
pub fn search(scene: &Scene, device: &Chain) -> Result<Search, SimulationError> {
    /// Factors of the device's inertia.
    const LIGHTER: [f64; 3] = [0.1, 0.01, 0.001];
    let mut tried = 0;
    let worst = worst(scene, device, 1.0, &mut tried)?;
    let oscillates = worst.grows();
    let mut lighter = None;
    for factor in LIGHTER {
        if oscillates || lighter.is_some() {
            break;
        }
        lighter = Some(self::worst(scene, device, factor, &mut tried)?).filter(Held::grows);
    }
    Ok(Search { worst, oscillates, lighter, tried })
}

impl Held {
    /// Whether the loop grows.
    pub fn grows(&self) -> bool {
        self.spectral_radius > 1.0 + GROWS
    }
}

/// The worst hand on the device of a scene, with so many times its inertia.
fn worst(
    scene: &Scene,
    device: &Chain,
    lighter: f64,
    tried: &mut usize,
) -> Result<Held, SimulationError> {
    let mut trial = Trial::new(scene, device, lighter)?;
    let hands = trial.family(trial.angle());
    let found = hands.into_iter().map(|hand| trial.of(hand));
    let mut found = found.collect::<Result<Vec<Held>, _>>()?;
    found.sort_by(|a, b| b.spectral_radius.total_cmp(&a.spectral_radius));
    let mut worst = found[0];
    for start in starts(&found) {
        let climbed = trial.climb(start)?;
        if climbed.spectral_radius > worst.spectral_radius {
            worst = climbed;
        }
    }
    *tried += trial.tried;
    Ok(worst)
}

/// Where to climb from: the worst of each kind of hand.
fn starts(sorted: &[Held]) -> Vec<Held> {
    const EACH: usize = 3;
    let kind = |linked: bool| {
        sorted.iter().filter(move |held| held.hand.link.is_some() == linked).take(EACH)
    };
    kind(false).chain(kind(true)).copied().collect()
}

/// Hands that resonate around an angle a tick, and some that do not.
fn family(inertia: f64, period: f64, angle: f64) -> Vec<Grip> {
    let angles: Vec<f64> = [0.25, 0.5, 0.8, 1.0, 1.25, 2.0]
        .iter()
        .map(|ratio| (angle * ratio).clamp(1e-3, PI))
        .chain([0.1, 0.5, 1.5, 2.5, PI])
        .collect();
    // From a hundredth of the device to a thousand times it: a heavy hand sees the
    // controller at one angle alone, a light one moves with the device between the samples.
    let masses: Vec<f64> =
        (-4..=6).map(|step| inertia * 10_f64.powf(f64::from(step) / 2.0)).collect();
    let mut hands = vec![Grip::default()];
    for &mass in &masses {
        hands.push(Grip { inertia: mass, ..Grip::default() });
        for &theta in &angles {
            let rate = (theta / period).powi(2);
            hands.push(Grip {
                inertia: mass,
                stiffness: (inertia + mass) * rate,
                ..Grip::default()
            });
            let link = Compliance { stiffness: mass * rate, damping: 0.0 };
            hands.push(Grip { inertia: mass, link: Some(link), ..Grip::default() });
        }
    }
    for &theta in &angles {
        let rate = (theta / period).powi(2);
        hands.push(Grip { stiffness: inertia * rate, ..Grip::default() });
    }
    hands
}

/// Hands tried on a device under a scene.
struct Trial<'d> {
    device: &'d Chain,
    /// Factor of the device's inertia.
    lighter: f64,
    experiment: Experiment,
    tried: usize,
}

impl<'d> Trial<'d> {
    fn new(scene: &Scene, device: &'d Chain, lighter: f64) -> Result<Self, SimulationError> {
        let experiment = Experiment::still(scene);
        // Says what is wrong before anything is searched for.
        closed_loop(&experiment, Stride::default())?;
        Ok(Self { device, lighter, experiment, tried: 0 })
    }

    /// Inertia in kg m^2 of the device, all of it.
    fn inertia(&self) -> f64 {
        self.lighter * self.device.inertia()
    }

    fn family(&self, angle: f64) -> Vec<Grip> {
        family(self.inertia(), self.experiment.scene.timing.period, angle)
    }

    /// The angle in rad a tick at which the real part of the rule is smallest.
    /// The middle of the circle where there is no such angle.
    fn angle(&self) -> f64 {
        let scene = &self.experiment.scene;
        let Ok(Loop { equivalent, .. }) = Loop::of(scene) else { return 0.5 * PI };
        let velocity = Response::new(equivalent).from_velocity(scene.timing.period);
        least(|theta| velocity.at_angle(theta).re, 0.0, PI).unwrap_or(0.5 * PI)
    }

    /// What the loop does in a hand.
    fn of(&mut self, hand: Grip) -> Result<Held, SimulationError> {
        self.tried += 1;
        self.experiment.plant = plant(self.device, self.lighter, &hand);
        let closed = closed_loop(&self.experiment, Stride::default())?;
        // Numbers too far apart for their eigenvalues prove nothing.
        let all = eigenvalues(&closed.matrix).unwrap_or_default();
        // What creeps back to rest is always nearest to 1 and would hide what resonates.
        let matters = |z: &&Complex<f64>| z.arg().abs() > CREEPS || z.norm() > 1.0 + GROWS;
        let larger = |a: &&Complex<f64>, b: &&Complex<f64>| a.norm().total_cmp(&b.norm());
        let largest = all.iter().filter(matters).max_by(larger).copied().unwrap_or_default();
        let turns = largest.arg().abs() / (2.0 * PI);
        Ok(Held {
            device_inertia: self.inertia(),
            hand,
            spectral_radius: largest.norm(),
            frequency: turns / self.experiment.scene.timing.period,
        })
    }

    /// Changes one number at a time for as long as that makes it worse, by ever smaller factors.
    fn climb(&mut self, start: Held) -> Result<Held, SimulationError> {
        /// Factor of the first changes, and the one at which they end.
        const FACTORS: [f64; 2] = [4.0, 1.01];
        let mut best = start;
        let mut factor = FACTORS[0];
        while factor > FACTORS[1] {
            let mut better = false;
            for neighbour in self.neighbours(&best.hand, factor) {
                let held = self.of(neighbour)?;
                if held.spectral_radius > best.spectral_radius {
                    (best, better) = (held, true);
                }
            }
            if !better {
                factor = factor.sqrt();
            }
        }
        Ok(best)
    }

    /// A hand with one of its numbers larger or smaller by a factor. A number that is zero begins at
    /// what is small beside the device.
    fn neighbours(&self, hand: &Grip, factor: f64) -> Vec<Grip> {
        /// What is small beside the device.
        const SMALL: f64 = 1e-3;
        let (inertia, period) = (self.inertia(), self.experiment.scene.timing.period);
        let damping = self.device.damping().max(inertia / period) * SMALL;
        let stiffness = damping / period;
        let changed = |value: f64, small: f64| {
            let less = if value < small { 0.0 } else { value / factor };
            [less, if value == 0.0 { small } else { value * factor }]
        };
        let mut all = Vec::new();
        for inertia in changed(hand.inertia, inertia * SMALL) {
            // A hand behind a link has to have a mass.
            if inertia > 0.0 || hand.link.is_none() {
                all.push(Grip { inertia, ..*hand });
            }
        }
        all.extend(changed(hand.damping, damping).map(|damping| Grip { damping, ..*hand }));
        all.extend(changed(hand.stiffness, stiffness).map(|stiffness| Grip { stiffness, ..*hand }));
        if let Some(link) = hand.link {
            let links = changed(link.stiffness, stiffness)
                .map(|stiffness| Compliance { stiffness, ..link })
                .into_iter()
                .chain(
                    changed(link.damping, damping).map(|damping| Compliance { damping, ..link }),
                );
            all.extend(links.map(|link| Grip { link: Some(link), ..*hand }));
        }
        // Springs that resonate far above the sample rate are as good as rigid.
        let stiffest = |mass: f64| (inertia + mass) * (4.0 * PI / period).powi(2);
        all.retain(|hand| {
            let linked = hand.link.map_or(0.0, |link| link.stiffness);
            hand.inertia <= HEAVIEST * inertia
                && hand.stiffness <= stiffest(hand.inertia)
                && linked <= stiffest(hand.inertia)
        });
        all
    }
}

/// A device with so many times its inertia in a hand.
pub fn plant(device: &Chain, lighter: f64, grip: &Grip) -> Plant {
    let light = |mass: &Mass| Mass { inertia: lighter * mass.inertia, ..*mass };
    let mut masses: Vec<Mass> = device.masses().iter().map(light).collect();
    let mut links = device.links().to_vec();
    let hand = match grip.link {
        None => Hand { inertia: grip.inertia, damping: grip.damping, stiffness: grip.stiffness },
        Some(link) => {
            masses.push(Mass { inertia: grip.inertia, damping: grip.damping });
            links.push(Link { stiffness: link.stiffness, damping: link.damping });
            Hand { inertia: 0.0, damping: 0.0, stiffness: grip.stiffness }
        }
    };
    let encoder = match device.encoder() {
        EncoderPlace::Motor => 0,
        EncoderPlace::Hand => device.masses().len() - 1,
    };
    let plant = Plant::seen_at(encoder, &masses, &links).held(hand);
    let lag = device.actuator_lag();
    if lag > 0.0 { plant.lagging(lag) } else { plant }
}

#[cfg(test)]
mod tests {
    use super::*;
    use firmware::certificate::certify;
    use firmware::environment::{Environment, Wall};
    use firmware::scene::{Coupling, Device, Timing};

    fn device() -> Chain {
        Chain::rigid(2.2e-5, 0.022).unwrap()
    }

    fn scene(stiffness: f64, damping: f64, delay: usize, coupling: Coupling) -> Scene {
        let wall = Wall { stiffness, damping, filter: None, delay, face: 0.0, one_sided: false };
        Scene {
            device: Device { inertia: 2.2e-5, damping: 0.022, passivity: None },
            timing: Timing { period: 0.001, worst_period: None },
            coupling,
            environment: Environment::DamperWall(wall),
            torque_limit: None,
        }
    }

    #[test]
    fn what_is_rejected_oscillates_in_some_hand_and_what_is_certified_in_none() {
        for (stiffness, damping, delay, coupling) in [
            (22.0, 0.01, 0, Coupling::Rigid),
            (5.0, 0.0, 1, Coupling::Rigid),
            (22.0, 0.01, 1, Coupling::Spring { stiffness: 44.0 }),
            (40.0, 0.0, 2, Coupling::Spring { stiffness: 44.0 }),
            (4.0, 0.015, 2, Coupling::Spring { stiffness: 20.0 }),
        ] {
            let limit = limit(stiffness, damping, delay, coupling);
            let near = |share: f64| {
                let factor = limit * share;
                scene(stiffness * factor, damping * factor, delay, coupling)
            };
            assert!(certify(&near(0.95)).is_ok() && certify(&near(1.05)).is_err());
            let certified = search(&near(0.95), &device()).unwrap();
            assert!(!certified.oscillates && certified.lighter.is_none(), "{certified:?}");
            let rejected = search(&near(1.05), &device()).unwrap();
            assert!(rejected.oscillates || rejected.lighter.is_some(), "{rejected:?}");
        }
    }

    /// What the search says must come true tick by tick.
    #[test]
    fn the_hand_that_was_found_makes_a_simulation_grow() {
        let scene = scene(30.0, 0.01, 1, Coupling::Spring { stiffness: 44.0 });
        let found = search(&scene, &device()).unwrap().worst;
        let plant = plant(&device(), 1.0, &found.hand);
        let start = crate::device::Motion { position: 0.0, velocity: 1e-3 };
        let experiment = Experiment { plant, start, samples: 3000, ..Experiment::still(&scene) };
        let motion = crate::simulation::simulate(&experiment, Stride::default()).unwrap();
        let most = |part: &[f64]| part.iter().fold(0.0_f64, |most, v| most.max(v.abs()));
        let grown = most(&motion.position[2000..]) / most(&motion.position[1000..2000]);
        assert!((grown.powf(1e-3) / found.spectral_radius - 1.0).abs() < 1e-3, "{grown}");
    }

    /// Factor of stiffness and damping at which the certificate ends.
    fn limit(stiffness: f64, damping: f64, delay: usize, coupling: Coupling) -> f64 {
        let passes = |factor: f64| {
            certify(&scene(stiffness * factor, damping * factor, delay, coupling)).is_ok()
        };
        let (mut low, mut high) = (0.0, 1e3);
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            if passes(middle) { low = middle } else { high = middle }
        }
        low
    }

    /// Theory, section 3.2: with the motor on one mass and the encoder on another no passivity is
    /// left, and a spring that is certified on the rigid device oscillates.
    #[test]
    fn a_device_that_is_not_collocated_oscillates_under_a_certified_spring() {
        let scene = scene(20.0, 0.0, 1, Coupling::Spring { stiffness: 44.0 });
        assert!(certify(&scene).is_ok());
        let masses =
            vec![Mass { inertia: 1e-5, damping: 0.022 }, Mass { inertia: 1.2e-5, damping: 0.0 }];
        let link = Link { stiffness: 20.0, damping: 1e-4 };
        let chain = Chain::new(masses, vec![link]).unwrap();
        assert!(!search(&scene, &chain).unwrap().oscillates);
        let apart = chain.with_encoder(EncoderPlace::Hand);
        assert!(search(&scene, &apart).unwrap().oscillates);
    }
}
