//! A simulation written for one device, with states on the stack and the evaluations of the rates that the
//! method needs.
//!
//! The program's own simulation multiplies all steps of a tick into one matrix beforehand, so that every
//! method has the same cost there; here each step is computed.

use nalgebra::{SMatrix, SVector};

use super::cases::{Case, STIFFNESS};
use crate::simulation::Integration;
use crate::simulation::method::{Method, step};
use crate::simulation::plant::{Input, POSITION};

/// Steps of one method on a device with `N` states.
pub(super) struct Stepper<const N: usize> {
    integration: Integration,
    /// `A` and the motor's column of `B`.
    rates: (SMatrix<f64, N, N>, SVector<f64, N>),
    /// The step as a matrix and the motor's column, for methods that are defined by it.
    step: (SMatrix<f64, N, N>, SVector<f64, N>),
    /// Length of a step in s.
    h: f64,
}

impl<const N: usize> Stepper<N> {
    /// The stepper of a device with `N` states.
    pub(super) fn new(case: &Case, integration: Integration) -> Self {
        let plant = &case.experiment.plant;
        let h = case.experiment.scene.timing.period / f64::from(integration.substeps);
        let matrix = step(plant, integration.method, 0.0, h);
        let rates = (
            SMatrix::from_fn(|i, j| plant.rates()[(i, j)]),
            SVector::from_fn(|i, _| plant.inputs()[(i, Input::Motor as usize)]),
        );
        let step = (
            SMatrix::from_fn(|i, j| matrix[(i, j)]),
            SVector::from_fn(|i, _| matrix[(i, N + Input::Motor as usize)]),
        );
        Self { integration, rates, step, h }
    }

    /// A function that runs the case.
    pub(super) fn into_runner(self, case: &Case) -> Box<dyn Fn(usize) -> Vec<f64> + '_> {
        Box::new(move |samples| self.run(case, samples))
    }

    /// The angles at the samples, from the start of the case.
    fn run(&self, case: &Case, samples: usize) -> Vec<f64> {
        let start = case.experiment.start;
        let moving = case.experiment.plant.state_at(start.position, start.velocity);
        let mut state = SVector::<f64, N>::from_fn(|i, _| moving[i]);
        let mut angles = Vec::with_capacity(samples);
        for _ in 0..samples {
            angles.push(state[POSITION]);
            let torque = -STIFFNESS * state[POSITION];
            state = match self.integration.method {
                Method::Exact | Method::Tustin => self.repeat(state, |x| self.known(x, torque)),
                Method::Euler => self.repeat(state, |x| x + self.rate(x, torque) * self.h),
                Method::SemiImplicit => self.repeat(state, |x| self.semi_implicit(x, torque)),
                Method::Rk4 => self.repeat(state, |x| self.runge_kutta(x, torque)),
            };
        }
        angles
    }

    fn repeat(
        &self,
        state: SVector<f64, N>,
        step: impl Fn(SVector<f64, N>) -> SVector<f64, N>,
    ) -> SVector<f64, N> {
        (0..self.integration.substeps).fold(state, |state, _| step(state))
    }

    fn rate(&self, state: SVector<f64, N>, torque: f64) -> SVector<f64, N> {
        self.rates.0 * state + self.rates.1 * torque
    }

    fn known(&self, state: SVector<f64, N>, torque: f64) -> SVector<f64, N> {
        self.step.0 * state + self.step.1 * torque
    }

    fn semi_implicit(&self, mut state: SVector<f64, N>, torque: f64) -> SVector<f64, N> {
        let rate = self.rate(state, torque);
        for mass in 0..N / 2 {
            state[2 * mass + 1] += self.h * rate[2 * mass + 1];
            state[2 * mass] += self.h * state[2 * mass + 1];
        }
        state
    }

    fn runge_kutta(&self, state: SVector<f64, N>, torque: f64) -> SVector<f64, N> {
        let half = 0.5 * self.h;
        let k1 = self.rate(state, torque);
        let k2 = self.rate(state + k1 * half, torque);
        let k3 = self.rate(state + k2 * half, torque);
        let k4 = self.rate(state + k3 * self.h, torque);
        state + (k1 + (k2 + k3) * 2.0 + k4) * (self.h / 6.0)
    }
}
