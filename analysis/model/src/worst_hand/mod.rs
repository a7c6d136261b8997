//! The hand in which a scene oscillates the most: the meaning of a rejection in practice.
//!
//! For a rigid device the rule of theory, section 4.1, is necessary as well as sufficient: if the device has
//! too little passivity, there is an angle on the unit circle at which some passive hand makes the sampled
//! loop grow. That hand resonates where the real part is smallest, so the search starts from masses and
//! springs that resonate near there, then climbs in all their numbers. Where none of them makes it grow, the
//! hand is constructed as in the proof (theory, section 13.6): for a rigid device it has the needed impedance
//! at all frequencies that give the same samples.
//!
//! Where torques lag, delay, amplifier and sensor are part of the loop in which hands are tried. On other
//! devices not every rejected scene has such a hand.

mod constructed;
mod impedance;
mod nnls;

use std::f64::consts::PI;

use haptic_servo::certificate::{LoopTransfers, assess};
use haptic_servo::scene::{Coupling, Scene};
use nalgebra::Complex;
use serde::Serialize;

use crate::chain::{Chain, Link};
use crate::line_search::minimizing_angle;
use crate::nominal_latency::left_out_of_loop;
use crate::response::Response;
use crate::simulation::{Experiment, Integration, SimulationError};
use crate::stability::{Characteristic, closed_loop, eigenvalues};

use constructed::LaggingLoop;
use impedance::impedance_grid;

pub use impedance::{Absorber, HandImpedance, plant};

/// Growth over 1 in a tick from which a loop counts as growing.
pub const GROWTH_THRESHOLD: f64 = 1e-9;

/// Angle in rad a tick below which a motion creeps rather than resonates.
const SLOWEST_RESONANCE: f64 = 1e-2;

/// Heaviest hand, over the device: far beyond, two eigenvalues near 1 cannot be separated.
const HEAVIEST: f64 = 1e4;

/// A hand, and the behaviour of the loop in it.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct HandCase {
    /// Inertia in kg m^2 of the device.
    pub device_inertia: f64,
    /// The hand.
    pub hand: HandImpedance,
    /// Factor by which the motion that resonates grows a tick; below 1 it dies away.
    pub spectral_radius: f64,
    /// Frequency in Hz of that motion.
    pub frequency: f64,
}

/// The result of the search.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SearchResult {
    /// The worst hand of all that were tried.
    pub worst: HandCase,
    /// Whether the loop grows in it.
    pub oscillates: bool,
    /// Where it does not: a hand in which it grows on a lighter device of the same damping. The certificate
    /// depends on the damping alone.
    pub lighter: Option<HandCase>,
    /// Number of hands that were tried.
    pub tried: usize,
    /// The part of the scene that is not in the loop.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub left_out: Option<&'static str>,
}

/// Looks for the passive hand in which the loop of a scene on a device grows the most.
///
/// One-sidedness, torque limit and quantisation are left out: the loop is that deep inside the
/// wall. For a scene that is certified with the passivity of its device no hand exists in which
/// it grows, so none is found.
///
/// # Errors
/// Where the scene has no closed loop.
pub fn search(scene: &Scene, device: &Chain) -> Result<SearchResult, SimulationError> {
    /// Factors of the device's inertia.
    const LIGHTER: [f64; 3] = [0.1, 0.01, 0.001];
    let mut tried = 0;
    let mut worst = worst(scene, device, 1.0, &mut tried)?;
    if !worst.grows()
        && let Some(constructed) = constructed(scene, device, &mut tried)?
    {
        worst = constructed;
    }
    let oscillates = worst.grows();
    let mut lighter = None;
    for factor in LIGHTER {
        if oscillates || lighter.is_some() {
            break;
        }
        lighter = Some(self::worst(scene, device, factor, &mut tried)?).filter(HandCase::grows);
    }
    Ok(SearchResult { worst, oscillates, lighter, tried, left_out: left_out_of_loop(scene) })
}

impl HandCase {
    /// Whether the loop grows.
    pub fn grows(&self) -> bool {
        self.spectral_radius > 1.0 + GROWTH_THRESHOLD
    }
}

/// The worst hand on the device of a scene, with its inertia times `lighter`.
fn worst(
    scene: &Scene,
    device: &Chain,
    lighter: f64,
    tried: &mut usize,
) -> Result<HandCase, SimulationError> {
    let mut search = HandSearch::new(scene, device, lighter)?;
    let mut found = search.worst()?;
    if found.grows() {
        found = match search.confirmed(&found)? {
            Some(confirmed) => confirmed,
            // Eigenvalues in doubles were wrong about it: then every hand is confirmed before it counts.
            None => {
                search.confirms = true;
                search.worst()?
            }
        };
    }
    *tried += search.tried;
    Ok(found)
}

/// The damping in N m s/rad below which some hand that does not vary in time destabilises a scene on a device
/// (theory, equation 43), from many aliases and a grid of angles; `None` where the device is not a single
/// mass with damping, or the loop has no transfer function.
pub fn needed(scene: &Scene, device: &Chain) -> Option<f64> {
    Some(LaggingLoop::new(scene, device)?.needed())
}

/// A hand on the device of a scene that is constructed so that the loop grows, if it does.
fn constructed(
    scene: &Scene,
    device: &Chain,
    tried: &mut usize,
) -> Result<Option<HandCase>, SimulationError> {
    let Some(lagging) = LaggingLoop::new(scene, device) else { return Ok(None) };
    let mut search = HandSearch::new(scene, device, 1.0)?;
    let mut found = None;
    for hand in lagging.hands() {
        // A hand that is too fast to integrate over a tick is skipped.
        if let Ok(case) = search.of(hand)
            && case.grows()
            && let Some(confirmed) = search.confirmed(&case)?
        {
            found = Some(confirmed);
            break;
        }
    }
    *tried += search.tried;
    Ok(found)
}

/// Where to climb from: the worst of each kind of hand.
fn starts(sorted: &[HandCase]) -> Vec<HandCase> {
    const EACH: usize = 3;
    let kind = |linked: bool| {
        sorted.iter().filter(move |case| case.hand.link.is_some() == linked).take(EACH)
    };
    kind(false).chain(kind(true)).cloned().collect()
}

/// Hands tried on a device under a scene.
struct HandSearch<'d> {
    device: &'d Chain,
    /// Factor of the device's inertia.
    lighter: f64,
    experiment: Experiment,
    tried: usize,
    /// Whether the growth in a hand counts only if it is confirmed.
    confirms: bool,
}

impl<'d> HandSearch<'d> {
    fn new(scene: &Scene, device: &'d Chain, lighter: f64) -> Result<Self, SimulationError> {
        let experiment = Experiment::still(scene);
        // Reports an error of the scene before the search.
        eigenvalues(&closed_loop(&experiment, Integration::default())?.matrix)?;
        Ok(Self { device, lighter, experiment, tried: 0, confirms: false })
    }

    /// The worst of all hands that are tried.
    fn worst(&mut self) -> Result<HandCase, SimulationError> {
        let period = self.experiment.scene.timing.period;
        let hands = impedance_grid(self.inertia(), period, self.angle());
        let found = hands.into_iter().map(|hand| self.of(hand));
        let mut found = found.collect::<Result<Vec<HandCase>, _>>()?;
        found.sort_by(|a, b| b.spectral_radius.total_cmp(&a.spectral_radius));
        let mut worst = found[0].clone();
        for start in starts(&found) {
            let climbed = self.climb(start)?;
            if climbed.spectral_radius > worst.spectral_radius {
                worst = climbed;
            }
        }
        Ok(worst)
    }

    /// The case with the size of its root of the characteristic polynomial, if that grows, too: its errors have
    /// bounds.
    fn confirmed(&mut self, case: &HandCase) -> Result<Option<HandCase>, SimulationError> {
        self.experiment.plant = plant(self.device, self.lighter, &case.hand);
        let polynomial = Characteristic::of(&self.experiment, Integration::default())?;
        let angle = 2.0 * PI * case.frequency * self.experiment.scene.timing.period;
        let eigenvalue = Complex::from_polar(case.spectral_radius, angle);
        let size = polynomial.root_beyond(1.0 + GROWTH_THRESHOLD, eigenvalue);
        Ok(size.map(|spectral_radius| HandCase { spectral_radius, ..case.clone() }))
    }

    /// Inertia in kg m^2 of the device, all of it.
    fn inertia(&self) -> f64 {
        self.lighter * self.device.inertia()
    }

    /// The angle in rad a tick at which the real part of the rule is smallest.
    /// The middle of the circle where there is no such angle.
    fn angle(&self) -> f64 {
        let scene = &self.experiment.scene;
        if !scene.latency.is_none() || scene.coupling == Coupling::Matched {
            // The angle of the index at the port, from the certificate.
            let place = assess(scene).cos_theta.map(|cosine| cosine.midpoint().clamp(-1.0, 1.0));
            return place.map_or(0.5 * PI, f64::acos);
        }
        let Ok(LoopTransfers { equivalent, .. }) = LoopTransfers::of(scene) else {
            return 0.5 * PI;
        };
        let velocity = Response::new(equivalent).from_velocity(scene.timing.period);
        minimizing_angle(|theta| velocity.at_angle(theta).re, 0.0, PI).unwrap_or(0.5 * PI)
    }

    /// The behaviour of the loop in a hand.
    fn of(&mut self, hand: HandImpedance) -> Result<HandCase, SimulationError> {
        self.tried += 1;
        self.experiment.plant = plant(self.device, self.lighter, &hand);
        let closed = closed_loop(&self.experiment, Integration::default())?;
        // If the eigenvalues are not found, the hand proves nothing: its numbers are too far apart.
        let all = eigenvalues(&closed.matrix).unwrap_or_default();
        // A slow return to rest is always nearest to 1 and would hide a resonance.
        let matters = |z: &&Complex<f64>| {
            z.arg().abs() > SLOWEST_RESONANCE || z.norm() > 1.0 + GROWTH_THRESHOLD
        };
        let larger = |a: &&Complex<f64>, b: &&Complex<f64>| a.norm().total_cmp(&b.norm());
        let largest = all.iter().filter(matters).max_by(larger).copied().unwrap_or_default();
        let turns = largest.arg().abs() / (2.0 * PI);
        let case = HandCase {
            device_inertia: self.inertia(),
            hand,
            spectral_radius: largest.norm(),
            frequency: turns / self.experiment.scene.timing.period,
        };
        if self.confirms && case.grows() {
            let refuted = HandCase { spectral_radius: 1.0, ..case.clone() };
            return Ok(self.confirmed(&case)?.unwrap_or(refuted));
        }
        Ok(case)
    }

    /// Changes one number at a time for as long as that makes it worse, by ever smaller factors.
    fn climb(&mut self, start: HandCase) -> Result<HandCase, SimulationError> {
        /// Factor of the first changes, and the factor at which they end.
        const FACTORS: [f64; 2] = [4.0, 1.01];
        let mut best = start;
        let mut factor = FACTORS[0];
        while factor > FACTORS[1] {
            let mut better = false;
            for neighbour in self.neighbours(&best.hand, factor) {
                let case = self.of(neighbour)?;
                if case.spectral_radius > best.spectral_radius {
                    (best, better) = (case, true);
                }
            }
            if !better {
                factor = factor.sqrt();
            }
        }
        Ok(best)
    }

    /// A hand with one of its numbers larger or smaller by a factor. A number that is zero begins at a value
    /// that is small beside the device.
    fn neighbours(&self, hand: &HandImpedance, factor: f64) -> Vec<HandImpedance> {
        /// Ratio of such a value to that of the device.
        const SMALL: f64 = 1e-3;
        let (inertia, period) = (self.inertia(), self.experiment.scene.timing.period);
        let damping = self.device.damping().max(inertia / period) * SMALL;
        let stiffness = damping / period;
        let changed = |value: f64, small: f64| {
            let less = if value < small { 0.0 } else { value / factor };
            [less, if value == 0.0 { small } else { value * factor }]
        };
        let smallest = [inertia * SMALL, damping, stiffness, stiffness, damping];
        let mut all = Vec::new();
        for (place, number) in hand.clone().numbers_mut().enumerate() {
            for value in changed(*number, smallest[place]) {
                let mut other = hand.clone();
                other.numbers_mut().nth(place).into_iter().for_each(|number| *number = value);
                all.push(other);
            }
        }
        // A mass behind an empty link is not part of a hand. Its rest at any place is a double eigenvalue 1,
        // which rounding moves to either side.
        let holds = |link: Link| link.stiffness > 0.0 || link.damping > 0.0;
        // Springs that resonate far above the sample rate are as good as rigid.
        let stiffest = |mass: f64| (inertia + mass) * (4.0 * PI / period).powi(2);
        all.retain(|hand| {
            let linked = hand.link.map_or(0.0, |link| link.stiffness);
            // A hand behind a link has to have a mass.
            hand.link.is_none_or(|link| hand.inertia > 0.0 && holds(link))
                && hand.inertia <= HEAVIEST * inertia
                && hand.stiffness <= stiffest(hand.inertia)
                && linked <= stiffest(hand.inertia)
        });
        all
    }
}

#[cfg(test)]
mod tests;
