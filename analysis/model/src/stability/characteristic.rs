//! The characteristic polynomial of a loop with bounds on its errors, and the radius of its roots.
//!
//! Plant and controller are computed from the numbers of the scene, not from the rounded matrices of a
//! simulation: a position that nothing holds is a root at 1, and the roots next to it keep their digits.

use haptic_servo::passivity::polynomial::Polynomial;
use nalgebra::{Complex, DMatrix};

use super::ball::{Ball, BallMatrix, product, root_beyond, roots_within, sum};
use super::closed_loop;
use crate::simulation::closed_loop::transfers;
use crate::simulation::method::{Method, balance};
use crate::simulation::plant::{Input, Plant};
use crate::simulation::{Experiment, Integration, SimulationError};

/// The characteristic polynomial, ascending.
pub struct Characteristic(Vec<Ball>);

impl Characteristic {
    /// Of the loop of an experiment. A loop that is integrated approximately, or through an amplifier that is
    /// updated within a tick, is the matrix that a simulation uses.
    ///
    /// # Errors
    /// Where the scene has no closed loop.
    pub fn of(experiment: &Experiment, integration: Integration) -> Result<Self, SimulationError> {
        let machine = experiment.machine();
        if integration.method == Method::Exact
            && machine.sampled().is_none()
            && let Some(plant) = SampledPlant::new(experiment, integration, &machine)
        {
            return plant.under(experiment);
        }
        let matrix = closed_loop(experiment, integration)?.matrix;
        let balls = BallMatrix::from_fn(matrix.nrows(), |i, j| Ball::of(matrix[(i, j)]));
        Ok(Self(balls.characteristic()))
    }

    /// Whether all roots are smaller than `radius`; `None` where that is not known.
    pub fn is_within(&self, radius: f64) -> Option<bool> {
        roots_within(&self.0, radius)
    }

    /// The size of a root next to `near` that is larger than `radius`; `None` where none is known.
    pub fn root_beyond(&self, radius: f64, near: Complex<f64>) -> Option<f64> {
        root_beyond(&self.0, radius, near)
    }

    /// An enclosure of the largest size of a root, as narrow as two doubles allow or the errors do.
    pub fn radius(&self) -> [f64; 2] {
        /// Relative width at which the search ends: some units in the last place.
        const WIDTH: f64 = 4.0 * f64::EPSILON;
        /// Radius below which a loop is at rest after a few ticks, whatever it is.
        const SMALLEST: f64 = 1e-9;
        let mut high = 1.0 + 2.0 * f64::EPSILON;
        while self.is_within(high) != Some(true) {
            high *= 2.0;
            if high > 1e30 {
                return [0.0, f64::INFINITY];
            }
        }
        let mut low = 0.0;
        while high - low > WIDTH * high && high > SMALLEST {
            // A place on a root itself is not decided, one beside it is.
            let places = [0.5, 0.375, 0.625].map(|share| low + share * (high - low));
            let decided = places.into_iter().find_map(|at| Some((at, self.is_within(at)?)));
            match decided {
                Some((at, true)) => high = at,
                Some((at, false)) => low = at,
                None => break,
            }
        }
        [low, high]
    }
}

/// From the motor's torque to the sampled position: `(z q0 + q1) / (z^(whole + 1) p)`.
struct SampledPlant {
    p: Vec<Ball>,
    /// From the torque that acts to the tick's end, and from the one before.
    q: [Vec<Ball>; 2],
    whole: usize,
}

impl SampledPlant {
    /// `None` where the machine is too fast for its numbers.
    fn new(experiment: &Experiment, integration: Integration, plant: &Plant) -> Option<Self> {
        let discretization = experiment.discretization(integration);
        let n = plant.order();
        let mut rates = plant.rates().clone();
        let scales = balance(&mut rates)?;
        let motor = |row: usize| plant.inputs()[(row, Input::Motor as usize)] / scales[row];
        // The torque as a state more that does not change.
        let generator = DMatrix::from_fn(n + 1, n + 1, |i, j| match (i < n, j < n) {
            (true, true) => rates[(i, j)],
            (true, false) => motor(i),
            _ => 0.0,
        });
        // A common factor of the column of torques does not change what follows from the states.
        let size = generator.column(n).amax();
        let factor = if size > 0.0 { 2_f64.powi(-(size.log2().ceil() as i32)) } else { 1.0 };
        let over = |time: f64| {
            let time_ball = Ball::of(time);
            let entry = |i: usize, j: usize| {
                let value = generator[(i, j)] * if j == n { factor } else { 1.0 };
                &Ball::of(value) * &time_ball
            };
            let norm = (0..n).map(|i| rates.row(i).abs().sum() + 1.0).fold(0.0, f64::max) * time;
            (norm <= 1e25).then(|| BallMatrix::from_fn(n + 1, entry).exponential(norm))
        };
        let late = discretization.latency;
        let (before, after) = (over(late)?, over(discretization.period - late)?);
        let whole = after.times(&before);
        // The encoder's row of the state, and the true size of torques.
        let measured = plant.measured();
        let gain = Ball::of(scales[measured]).over(&Ball::of(factor))?;
        let states = BallMatrix::from_fn(n, |i, j| whole.at(i, j).clone());
        let column = |effect: &dyn Fn(usize) -> Ball| (0..n).map(|i| &effect(i) * &gain).collect();
        let after_change = column(&|i| after.at(i, n).clone());
        let before_change = column(&|i| whole.at(i, n) - after.at(i, n));
        let (p, q) = states.with_adjugates(measured, &[after_change, before_change]);
        let q = q.try_into().ok()?;
        Some(Self { p, q, whole: discretization.whole })
    }

    /// With the controller of the scene.
    fn under(&self, experiment: &Experiment) -> Result<Characteristic, SimulationError> {
        let t = transfers(&experiment.scene)?.controller;
        let balls = |p: &Polynomial| -> Vec<Ball> {
            (0..p.len()).map(|i| Ball::of(p.coefficient(i).midpoint())).collect()
        };
        let with = |p: &Polynomial, sign: i32| {
            let times = |all: Vec<Ball>, power: i32, root: f64| {
                let factor = [Ball::of(-root), Ball::one()];
                (0..sign * power).fold(all, |all, _| product(&all, &factor))
            };
            let shifted = times(balls(p), t.shift, 0.0);
            times(times(shifted, t.ones, 1.0), t.minus_ones, -1.0)
        };
        let scale = [Ball::of(t.scale.midpoint())];
        let (numerator, denominator) =
            (product(&scale, &with(&t.numerator, 1)), with(&t.denominator, -1));
        let delay = |ticks: usize| -> Vec<Ball> {
            (0..=ticks).map(|i| if i == ticks { Ball::one() } else { Ball::zero() }).collect()
        };
        let acting = sum(&product(&delay(1), &self.q[0]), &self.q[1]);
        let free = product(&product(&delay(self.whole + 1), &self.p), &denominator);
        let mut all = sum(&free, &product(&acting, &numerator));
        while all.last().is_some_and(Ball::is_zero) {
            all.pop();
        }
        // Coefficients far from 1 would lose digits behind a fixed point.
        let leading = all.last().cloned().unwrap_or_else(Ball::one);
        Ok(Characteristic(
            all.iter().map(|it| it.over(&leading)).collect::<Option<_>>().unwrap_or(all),
        ))
    }
}
