//! The same loops, computed another way: the environment as the sum over its whole past, the
//! algebraic loop by bisection. Slow, in f64, and without one formula in common with the laws.

use crate::environment::{Drag, Environment, Parts, Rational, Wall};
use crate::scene::{Coupling, Scene};

/// First `length` samples of the impulse response of a rational function, by long division of
/// polynomials in descending powers; a numerator of lower degree is padded by the caller.
pub fn impulse_response(numerator: &[f64], denominator: &[f64], length: usize) -> Vec<f64> {
    let mut rest = numerator.to_vec();
    rest.resize(length.max(numerator.len()) + denominator.len(), 0.0);
    let mut response = Vec::new();
    for k in 0..length {
        let next = rest[k] / denominator[0];
        for (i, d) in denominator.iter().enumerate() {
            rest[k + i] -= next * d;
        }
        response.push(next);
    }
    response
}

/// The undelayed environment as a function of all positions so far.
enum Sum {
    Linear(Vec<f64>),
    Wall { wall: Wall, filter: Vec<f64>, period: f64 },
}

impl Sum {
    /// Torque with the positions `past` and then `now`.
    fn torque(&self, past: &[f64], now: f64) -> f64 {
        match self {
            Self::Linear(response) => past
                .iter()
                .chain([&now])
                .rev()
                .zip(response)
                .map(|(position, weight)| position * weight)
                .sum(),
            Self::Wall { wall, filter, period } => {
                let positions: Vec<f64> = [0.0].iter().chain(past).chain([&now]).copied().collect();
                let velocity: f64 = positions
                    .windows(2)
                    .rev()
                    .zip(filter)
                    .map(|(pair, weight)| weight * (pair[1] - pair[0]) / period)
                    .sum();
                let depth = now - wall.face();
                let torque = wall.stiffness * depth + wall.damping() * velocity;
                match wall.is_one_sided() {
                    false => torque,
                    true if depth > 0.0 => torque.max(0.0),
                    true => 0.0,
                }
            }
        }
    }
}

/// A part of the environment with its own delay, and the torques that it gave.
struct Part {
    sum: Sum,
    delay: usize,
    given: Vec<f64>,
}

impl Part {
    fn torque(&self, past: &[f64], now: f64) -> f64 {
        match self.delay {
            0 => self.sum.torque(past, now),
            n if past.len() < n => 0.0,
            n => self.given[past.len() - n],
        }
    }
}

/// A scene's closed loop of coupling and environment.
pub struct Reference {
    parts: Vec<Part>,
    compliance: f64,
    limit: f64,
    past: Vec<f64>,
}

impl Reference {
    pub fn new(scene: &Scene<Environment>, limit: f64, length: usize) -> Self {
        let compliance = match scene.coupling {
            Coupling::Rigid => 0.0,
            Coupling::Spring { stiffness } => 1.0 / stiffness,
            Coupling::Matched => unreachable!("not drawn"),
        };
        let wall = |wall: Wall| {
            let filter = (0..length)
                .map(|i| match wall.filter() {
                    Some(pole) => (1.0 - pole) * pole.powi(i as i32),
                    None => f64::from(u8::from(i == 0)),
                })
                .collect();
            let sum = Sum::Wall { wall, filter, period: scene.timing.period };
            Part { sum, delay: wall.delay, given: Vec::new() }
        };
        let free = |residual: f64, delay: usize| {
            // C = -be (z - 1) / (T z) and E = C / (1 - C / K), as in equation 22, but of C by
            // backward differences.
            let (be, period) = (scene.device.damping - residual, scene.timing.period);
            let numerator = [-be, be];
            let denominator = [period + be * compliance, -be * compliance];
            let response = impulse_response(&numerator, &denominator, length);
            Part { sum: Sum::Linear(response), delay, given: Vec::new() }
        };
        let damper = |drag: Drag| {
            let numerator = [drag.damping, -drag.damping];
            let response = impulse_response(&numerator, &[scene.timing.period, 0.0], length);
            Part { sum: Sum::Linear(response), delay: drag.delay, given: Vec::new() }
        };
        let parts = match scene.environment {
            Environment::Parts(Parts { canceller, wall: data, profile: None, drag, .. }) => {
                let free = canceller.map(|canceller| free(canceller.residual, canceller.delay));
                let parts = [free, data.map(wall), drag.map(damper)];
                parts.into_iter().flatten().collect()
            }
            Environment::Parts(_) | Environment::Stated(_) => panic!("no law is known of it here"),
            Environment::Rational(data) => {
                let sum = Sum::Linear(rational_response(&data, length));
                vec![Part { sum, delay: data.delay, given: Vec::new() }]
            }
        };
        Self { parts, compliance, limit, past: Vec::new() }
    }

    /// The coupling torque in N m of the next tick, with the device at `x` (rad).
    pub fn tick(&mut self, x: f64) -> f64 {
        let asked = |torque: f64| {
            let x_e = x - torque * self.compliance;
            self.parts.iter().map(|part| part.torque(&self.past, x_e)).sum::<f64>()
        };
        let (mut below, mut above) = (-self.limit, self.limit);
        if asked(above) > above {
            below = above;
        } else if asked(below) < below {
            above = below;
        }
        while above - below > 1e-15 * self.limit {
            let middle = 0.5 * (below + above);
            if middle == below || middle == above {
                break;
            }
            if asked(middle) > middle { below = middle } else { above = middle }
        }
        let torque = 0.5 * (below + above);
        let x_e = x - torque * self.compliance;
        for part in &mut self.parts {
            let now = part.sum.torque(&self.past, x_e);
            part.given.push(now);
        }
        self.past.push(x_e);
        torque
    }
}

fn rational_response(data: &Rational, length: usize) -> Vec<f64> {
    let denominator = data.denominator.as_slice();
    let mut numerator = data.numerator.as_slice().to_vec();
    let degree = numerator.len() - 1 + data.unit_zeros;
    let shift = denominator.len() - 1 - degree;
    numerator.splice(0..0, vec![0.0; shift]);
    // (z - 1)^n = z^n (1 - 1/z)^n: the response without these zeros, differenced n times. The
    // powers of z are what `shift` leaves out.
    let mut response = impulse_response(&numerator, denominator, length);
    for _ in 0..data.unit_zeros {
        for k in (1..length).rev() {
            response[k] -= response[k - 1];
        }
    }
    response
}
