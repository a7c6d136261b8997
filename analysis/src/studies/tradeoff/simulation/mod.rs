//! Methods of integration by their steps per tick: their speed, the error of the motion, and the error of the
//! verdict (theory, section 9).

mod cases;
mod stepper;

use std::hint::black_box;

use super::{Axis, Comparison, Method as Row, Tradeoff, fastest};
use crate::simulation::method::Method;
use crate::simulation::{Integration, SimulationError, Trajectory, simulate};
use crate::stability::critical_stiffness;

pub use cases::{Case, cases};

use cases::SAMPLES;
use stepper::Stepper;

/// The comparison.
pub static COMPARISON: Comparison = Comparison {
    name: "simulation",
    title: "Simulation: methods of integration by their steps in a sample of 1 ms",
    cost: Axis::most("samples_per_second", "samples simulated a second"),
    errors: &[
        // The precision of the reference, which `analysis/tests/all/simulation_reference.rs` checks with
        // sixty digits.
        Axis::least("angle_error", "largest error of the angle (part of its largest)")
            .floored(1e-12, "no error seen"),
        // The precision of the stability limits.
        Axis::least("verdict_error", "error of the largest stable stiffness (part)")
            .floored(1e-9, "no error seen"),
    ],
    others: &["substeps", "largest_stable_stiffness"],
    kept: include_bytes!("../../../../pictures/tradeoff/simulation.csv"),
};

/// Steps in a tick.
const SUBSTEPS: [u32; 8] = [1, 2, 3, 5, 10, 20, 50, 100];
/// Rounds of the measurement; the result is the fastest.
const ROUNDS: usize = 31;
/// A relative error of the angle above which the motion is lost.
const LOST: f64 = 1e3;

/// Measures all methods on all motions.
pub fn measure() -> Result<Tradeoff, SimulationError> {
    let mut methods = Vec::new();
    for case in cases() {
        let truth = Truth::of(&case)?;
        let strides = strides();
        let work = |&integration: &Integration| {
            let run = runner(&case, integration);
            move || drop(black_box(run(black_box(SAMPLES))))
        };
        let times = fastest(ROUNDS, &mut strides.iter().map(work).collect::<Vec<_>>());
        for (integration, time) in strides.into_iter().zip(times) {
            methods.push(truth.row(&case, integration, time)?);
        }
    }
    Ok(Tradeoff { comparison: &COMPARISON, methods })
}

/// Measured steps of a case.
fn strides() -> Vec<Integration> {
    let of = |method| {
        let substeps = if method == Method::Exact { &SUBSTEPS[..1] } else { &SUBSTEPS[..] };
        substeps.iter().map(move |&substeps| Integration { method, substeps })
    };
    Method::ALL.into_iter().flat_map(of).collect()
}

/// The reference of a case's figures.
struct Truth {
    motion: Trajectory,
    critical: Option<f64>,
}

impl Truth {
    fn of(case: &Case) -> Result<Self, SimulationError> {
        let exact = Integration::default();
        let motion = simulate(&case.experiment, exact)?;
        Ok(Self { motion, critical: critical_stiffness(&case.experiment, exact)? })
    }

    /// A method's figures; `time` is the time in s for all samples.
    fn row(
        &self,
        case: &Case,
        integration: Integration,
        time: f64,
    ) -> Result<Row, SimulationError> {
        let critical = critical_stiffness(&case.experiment, integration)?;
        let verdict = match (critical, self.critical) {
            (Some(found), Some(truth)) => (found / truth - 1.0).abs(),
            _ => f64::INFINITY,
        };
        let (family, short) = (integration.method.name(), short(integration.method));
        let name = match integration.method {
            Method::Exact => short.to_owned(),
            _ => format!("{short}, {}", integration.substeps),
        };
        let angles = runner(case, integration)(SAMPLES);
        let figures = [
            Some(SAMPLES as f64 / time),
            Some(self.angle_error(&angles)),
            Some(verdict),
            Some(f64::from(integration.substeps)),
            critical,
        ];
        Ok(Row { values: figures.to_vec(), ..Row::new(case.name, family, name, &[]) })
    }

    fn angle_error(&self, angles: &[f64]) -> f64 {
        let largest =
            |values: &mut dyn Iterator<Item = f64>| values.map(f64::abs).fold(0.0, f64::max);
        let size = largest(&mut self.motion.position.iter().copied());
        let differences = angles.iter().zip(&self.motion.position).map(|(is, should)| is - should);
        // NaN compares with nothing.
        let is_lost = angles.iter().any(|angle| !angle.is_finite());
        let error = largest(&mut differences.into_iter()) / size;
        if is_lost || error > LOST { f64::INFINITY } else { error }
    }
}

/// A method's short name.
fn short(method: Method) -> &'static str {
    match method {
        Method::Exact => "exact",
        Method::Euler => "Euler",
        Method::SemiImplicit => "semi-implicit",
        Method::Rk4 => "RK4",
        Method::Tustin => "Tustin",
    }
}

/// Computes the angles at this many samples; all preparation is done before.
fn runner(case: &Case, integration: Integration) -> Box<dyn Fn(usize) -> Vec<f64> + '_> {
    match case.experiment.plant.order() {
        2 => Stepper::<2>::new(case, integration).into_runner(case),
        _ => Stepper::<4>::new(case, integration).into_runner(case),
    }
}

#[cfg(test)]
mod tests;
