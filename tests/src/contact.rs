//! A one-sided, limited wall behind a spring coupling, held by a hand: the nonlinear loop that the
//! bound of theory section 5 speaks about.

use crate::plant::Plant;
use nalgebra::DVector;
use std::collections::VecDeque;

/// The wall and its coupling in the loop's units (period 1, device damping 1); it occupies the
/// positive positions.
#[derive(Clone, Copy, Debug)]
pub struct Contact {
    /// Stiffness of the wall.
    pub stiffness: f64,
    /// Damping of the wall.
    pub damping: f64,
    /// Delay in samples.
    pub delay: usize,
    /// Stiffness of the coupling.
    pub coupling: f64,
    /// Largest torque.
    pub limit: f64,
}

/// What equation 28 bounds by the energy at the start.
#[derive(Clone, Copy, Debug)]
pub struct Outcome {
    /// Energy of device and hand at the start.
    pub energy: f64,
    /// Largest square of the torque.
    pub peak: f64,
    /// Sum of the squares of the environment's steps.
    pub motion: f64,
}

impl Contact {
    /// What the wall alone would give at a position after a step, not delayed.
    fn law(&self, position: f64, step: f64) -> f64 {
        let force = self.stiffness * position + self.damping * step;
        if position > 0.0 { force.clamp(0.0, self.limit) } else { 0.0 }
    }

    /// Torque of an undelayed wall: the coupling and the wall agree on one position. The law does
    /// not fall with the position except at the face, so bisection finds it.
    fn solved(&self, x: f64, last: f64) -> f64 {
        let (mut lo, mut hi) = (0.0, (self.coupling * x).max(0.0));
        for _ in 0..200 {
            let force = 0.5 * (lo + hi);
            let position = x - force / self.coupling;
            if self.law(position, position - last) > force { lo = force } else { hi = force }
        }
        0.5 * (lo + hi)
    }

    /// Runs the loop from a state of device and hand; the environment starts at rest.
    pub fn run(&self, plant: &Plant, start: &DVector<f64>, samples: usize) -> Outcome {
        let mut state = start.clone();
        let mut last = start[0];
        let mut delayed: VecDeque<f64> = std::iter::repeat_n(0.0, self.delay).collect();
        let mut outcome = Outcome { energy: plant.energy(start), peak: 0.0, motion: 0.0 };
        for _ in 0..samples {
            let force = match delayed.pop_front() {
                Some(force) => force,
                None => self.solved(state[0], last),
            };
            let position = state[0] - force / self.coupling;
            if self.delay > 0 {
                delayed.push_back(self.law(position, position - last));
            }
            outcome.peak = outcome.peak.max(force * force);
            outcome.motion += (position - last).powi(2);
            last = position;
            state = &plant.a * &state - &plant.b * force;
        }
        outcome
    }
}
