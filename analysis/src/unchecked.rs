//! What a scene would do that the certificate has refused: the linear controller in `f64` on the
//! simulated device. A servo of such a scene cannot be made, here or anywhere else.

use firmware::certificate::Loop;
use firmware::scene::Scene;

use crate::device::{Grip, Hand, HeldDevice, Motion};
use crate::response::{Filter, Response};

/// A motion that grows, and the passive hand in which it does.
#[derive(Clone, Debug, PartialEq)]
pub struct Growth {
    /// The hand.
    pub hand: Hand,
    /// Factor by which the oscillation's amplitude grows in a second.
    pub per_second: f64,
    /// Angle of the device in rad, tick by tick, from a touch until it is out of all bounds, the
    /// last thousandfold of the growth.
    pub position: Vec<f64>,
}

/// Speed in rad/s that the device has at first: a touch.
const TOUCH: f64 = 0.01;

/// The motion is out of all bounds where the device has turned by so much, in rad.
const BOUNDS: f64 = 1.0;

/// Ticks over which growth is measured.
const TICKS: usize = 2000;

/// Looks for the passive hand among a family of masses and springs in which the scene oscillates
/// the most; none where in all of them the motion dies away.
///
/// One-sidedness and torque limit are left out: the scene is what it is deep inside the wall, and
/// the motor as strong as it takes.
pub fn worst_hand(scene: &Scene) -> Option<Growth> {
    let controller = Response::new(Loop::of(scene).ok()?.controller).filter()?;
    let grown = |hand: Hand| {
        let growth = growth(scene, &controller, hand);
        (growth > 1.0).then_some((hand, growth))
    };
    let (hand, per_tick) =
        family(scene.device.inertia).filter_map(grown).max_by(|a, b| a.1.total_cmp(&b.1))?;
    Some(Growth {
        hand,
        per_second: per_tick.powf(1.0 / scene.timing.period),
        position: motion(scene, &controller, hand),
    })
}

/// Hands from none to a thousand times the device's inertia, each free and sprung; none damps.
fn family(inertia: f64) -> impl Iterator<Item = Hand> {
    let masses = (-4..=12).map(move |step| inertia * 10_f64.powf(f64::from(step) / 4.0));
    masses.flat_map(|inertia| {
        [0.0, 1.0, 10.0, 100.0].map(|stiffness| Hand { inertia, damping: 0.0, stiffness })
    })
}

/// Factor by which the motion grows in a tick, averaged over the second half of a run in which the
/// first half has left the fastest-growing motion alone.
fn growth(scene: &Scene, controller: &Filter, hand: Hand) -> f64 {
    let period = scene.timing.period;
    let mut closed = Closed::new(scene, controller.clone(), hand);
    let mut logarithm = 0.0;
    let mut window = 0.0_f64;
    // The largest excursion of each window stands for the amplitude; between windows the motion
    // is scaled back, which a linear loop does not notice, so that it never leaves the range.
    const WINDOW: usize = 100;
    for tick in 0..TICKS {
        let motion = closed.tick();
        window = window.max(motion.position.abs()).max(motion.velocity.abs() * period);
        if tick % WINDOW == WINDOW - 1 {
            if window == 0.0 || !window.is_finite() {
                return 0.0;
            }
            closed.scale(1.0 / window);
            if tick >= TICKS / 2 {
                logarithm += window.ln();
            }
            window = 0.0;
        }
    }
    (logarithm / (TICKS / 2) as f64).exp()
}

fn motion(scene: &Scene, controller: &Filter, hand: Hand) -> Vec<f64> {
    let mut closed = Closed::new(scene, controller.clone(), hand);
    closed.motion.velocity = TOUCH;
    let positions = (0..TICKS).map(|_| closed.tick().position);
    let grown: Vec<f64> = positions.take_while(|position| position.abs() < BOUNDS).collect();
    let end = grown.last().map_or(0.0, |position| position.abs());
    let begin = grown.iter().position(|position| position.abs() > 1e-3 * end).unwrap_or(0);
    grown[begin..].to_vec()
}

/// Device, hand and linear controller in a loop.
struct Closed {
    device: HeldDevice,
    controller: Filter,
    motion: Motion,
}

impl Closed {
    fn new(scene: &Scene, controller: Filter, hand: Hand) -> Self {
        let device = HeldDevice::new(scene.device, hand, scene.timing.period);
        Self { device, controller, motion: Motion { position: 0.0, velocity: 1.0 } }
    }

    fn tick(&mut self) -> Motion {
        let torque = self.controller.tick(self.motion.position);
        self.motion = self.device.step(self.motion, -torque, Grip::default()).0;
        self.motion
    }

    fn scale(&mut self, factor: f64) {
        self.controller.scale(factor);
        self.motion.position *= factor;
        self.motion.velocity *= factor;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use firmware::environment::{Environment, Wall};
    use firmware::scene::{Coupling, Device, Timing};

    fn spring(stiffness: f64) -> Scene {
        let wall =
            Wall { stiffness, damping: 0.0, filter: None, delay: 1, face: 0.0, one_sided: false };
        Scene {
            device: Device { inertia: 2.2e-5, damping: 0.022, passivity: None },
            timing: Timing { period: 0.001, worst_period: None },
            coupling: Coupling::Spring { stiffness: 44.0 },
            environment: Environment::DelayedSpring(wall),
            torque_limit: None,
        }
    }

    #[test]
    fn certified_springs_die_away_in_all_hands_and_stiffer_ones_grow_in_some() {
        assert!(firmware::certificate::assess(&spring(43.0)).outcome.is_ok());
        assert_eq!(worst_hand(&spring(43.0)), None);
        assert!(firmware::certificate::assess(&spring(50.0)).outcome.is_err());
        let growth = worst_hand(&spring(50.0)).unwrap();
        assert!(growth.per_second > 1.0 && growth.position.len() > 10);
    }
}
