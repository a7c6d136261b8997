//! Passive hands: springs, dampers and masses in a chain that hangs on the device.
//!
//! Units are those of the loop: the period is 1 and the device's damping is 1, so a mass is in
//! `delta T`, a stiffness in `delta / T`, a damping in `delta`.

use crate::scenes::log_uniform;
use rand::Rng;
use std::f64::consts::PI;

/// A mass of the hand, behind a link.
#[derive(Clone, Copy, Debug)]
pub struct Segment {
    /// Stiffness of the link to the mass before.
    pub link_stiffness: f64,
    /// Damping of that link.
    pub link_damping: f64,
    /// Mass.
    pub inertia: f64,
    /// Stiffness to the ground.
    pub stiffness: f64,
    /// Damping to the ground.
    pub damping: f64,
}

/// A device and the hand on it. Every number is at least zero, so it is passive whatever they are.
#[derive(Clone, Debug)]
pub struct Hand {
    /// Mass of the device with the parts rigidly attached.
    pub inertia: f64,
    /// Damping that the hand adds to the device's own.
    pub damping: f64,
    /// Stiffness to the ground.
    pub stiffness: f64,
    /// Further masses, each linked to the one before.
    pub segments: Vec<Segment>,
}

fn sometimes(rng: &mut impl Rng, probability: f64, lo: f64, hi: f64) -> f64 {
    if rng.random_bool(probability) { log_uniform(rng, lo, hi) } else { 0.0 }
}

impl Hand {
    /// None, and no mass of the device either.
    pub const NONE: Self =
        Self { inertia: 0.0, damping: 0.0, stiffness: 0.0, segments: Vec::new() };

    /// Anything: masses, springs and dampers over many decades.
    pub fn draw(rng: &mut impl Rng) -> Self {
        let segment = |rng: &mut _| Segment {
            link_stiffness: log_uniform(rng, 1e-4, 1e2),
            link_damping: sometimes(rng, 0.5, 1e-4, 1e1),
            inertia: log_uniform(rng, 1e-3, 3e3),
            stiffness: sometimes(rng, 0.3, 1e-4, 1e2),
            damping: sometimes(rng, 0.3, 1e-4, 1e1),
        };
        let count = rng.random_range(0..=2);
        Self {
            inertia: log_uniform(rng, 1e-3, 3e3),
            damping: sometimes(rng, 0.3, 1e-3, 1e2),
            stiffness: sometimes(rng, 0.6, 1e-5, 1e2),
            segments: (0..count).map(|_| segment(rng)).collect(),
        }
    }

    /// A hand that resonates near `theta` radians a sample, without damping of its own.
    ///
    /// A heavy oscillator sees the controller's real part at `theta` alone, less what its ripple
    /// between samples loses; a light device with a light absorber moves evenly between samples
    /// and reaches every reactance there, which is the worst case of the theorem.
    pub fn tuned(rng: &mut impl Rng, theta: f64) -> Self {
        let theta = (theta * log_uniform(rng, 0.8, 1.25)).clamp(1e-3, PI);
        let absorber = |rng: &mut _, theta: f64| {
            let inertia = log_uniform(rng, 1e-3, 1e1);
            Segment {
                link_stiffness: inertia * theta * theta,
                link_damping: 0.0,
                inertia,
                stiffness: 0.0,
                damping: 0.0,
            }
        };
        let light = |rng: &mut _| log_uniform(rng, 1e-4, 1e-1);
        match rng.random_range(0..4) {
            0 => {
                let inertia = log_uniform(rng, 1e-1, 3e3);
                Self {
                    inertia,
                    damping: 0.0,
                    stiffness: inertia * theta * theta,
                    segments: Vec::new(),
                }
            }
            1 => {
                let (inertia, stiffness) = (light(rng), sometimes(rng, 0.8, 1e-3, 1e1));
                Self { inertia, damping: 0.0, stiffness, segments: Vec::new() }
            }
            2 => {
                let inertia = light(rng);
                Self { inertia, damping: 0.0, stiffness: 0.0, segments: vec![absorber(rng, theta)] }
            }
            _ => {
                let (inertia, stiffness) = (light(rng), sometimes(rng, 0.5, 1e-3, 1e1));
                Self { inertia, damping: 0.0, stiffness, segments: vec![absorber(rng, theta)] }
            }
        }
    }

    /// A hand like this one: each number that is not zero, times a factor of about `1 + spread`.
    pub fn varied(&self, rng: &mut impl Rng, spread: f64) -> Self {
        let mut vary =
            |x: f64, hi: f64| (x * log_uniform(rng, 1.0 / (1.0 + spread), 1.0 + spread)).min(hi);
        Self {
            inertia: vary(self.inertia, 1e5).max(1e-4),
            damping: vary(self.damping, 1e3),
            stiffness: vary(self.stiffness, 1e5),
            segments: self
                .segments
                .iter()
                .map(|s| Segment {
                    link_stiffness: vary(s.link_stiffness, 1e5),
                    link_damping: vary(s.link_damping, 1e3),
                    inertia: vary(s.inertia, 1e5).max(1e-4),
                    stiffness: vary(s.stiffness, 1e5),
                    damping: vary(s.damping, 1e3),
                })
                .collect(),
        }
    }
}
