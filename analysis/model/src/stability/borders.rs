//! The stiffnesses at which a loop crosses from stable to unstable or back.

use std::f64::consts::PI;

use haptic_servo::matched::MatchedCoupling;
use haptic_servo::number::Format;
use haptic_servo::parameter::Parameter;
use haptic_servo::passivity::interval::Interval;
use haptic_servo::passivity::polynomial::Polynomial;
use haptic_servo::passivity::transfer::{Transfer, Unbuildable};
use haptic_servo::scene::{Coupling, Scene, Timing};
use nalgebra::Complex;

use super::eigenvalues::eigenvalues;
use crate::response::Response;
use crate::simulation::closed_loop::transfers;
use crate::simulation::discrete_plant::DiscretePlant;
use crate::simulation::{Experiment, Integration, SimulationError};

/// The stiffnesses at which some eigenvalue is on the unit circle.
pub(super) struct Borders {
    tick: DiscretePlant,
    /// `V` of the coupling.
    compliance: Response,
    /// The environment without stiffness, and with `unit`.
    environments: [Response; 2],
    unit: f64,
}

/// `V` of a scene's coupling, in rad/(N m).
fn compliance(scene: &Scene) -> Result<Response, Unbuildable> {
    let constant = |value: f64| {
        let [value, one] = [value, 1.0].map(|it| Polynomial::ascending(&[Interval::exact(it)]));
        Response::new(Transfer::new(value, one))
    };
    Ok(match scene.coupling {
        Coupling::Rigid => constant(0.0),
        Coupling::Spring { stiffness } => constant(1.0 / stiffness),
        Coupling::Matched => {
            let Timing { period, worst_period } = scene.timing;
            let delta = scene.device.passivity();
            let matched =
                MatchedCoupling::of(period, worst_period, delta, &scene.latency, Format::F64);
            let (numerator, denominator) =
                matched.and_then(|matched| matched.transfer()).ok_or(Unbuildable::OutOfRange)?;
            Response::new(Transfer::new(numerator, denominator))
        }
    })
}

impl Borders {
    pub(super) fn new(
        experiment: &Experiment,
        integration: Integration,
    ) -> Result<Self, SimulationError> {
        let scene = &experiment.scene;
        let device = scene.device;
        let period = scene.timing.period;
        // So stiff that the terms without stiffness have no digits left in the sum.
        let unit = 1e6 * (device.damping / period + device.inertia / (period * period));
        let environment = |stiffness: f64| -> Result<Response, SimulationError> {
            let changed = scene.with(Parameter::Stiffness, stiffness).unwrap_or(*scene);
            Ok(Response::new(transfers(&changed)?.environment))
        };
        Ok(Self {
            tick: experiment.tick(integration)?,
            compliance: compliance(scene)?,
            environments: [environment(0.0)?, environment(unit)?],
            unit,
        })
    }

    /// From the motor's torque to the sampled position, at `z`.
    fn plant(&self, z: Complex<f64>) -> Option<Complex<f64>> {
        let complex = |entry: f64| Complex::new(entry, 0.0);
        let mut shifted = self.tick.transition.map(|entry| complex(-entry));
        for i in 0..shifted.nrows() {
            shifted[(i, i)] += z;
        }
        let effect = self.tick.motor.map(complex) + self.tick.previous.map(complex) / z;
        Some(shifted.lu().solve(&effect)?[self.tick.measured] * z.powi(-(self.tick.whole as i32)))
    }

    /// The stiffness, complex in general, with which the loop has an eigenvalue at this angle.
    fn at(&self, theta: f64) -> Complex<f64> {
        let z = Complex::from_polar(1.0, theta);
        let one = Complex::new(1.0, 0.0);
        let [without, with] = &self.environments;
        let (without, with) = (without.at(z), with.at(z));
        let each = (with - without) / self.unit;
        // On a pole of the plant the environment alone determines the loop.
        let through = self.plant(z).map(|plant| one / (plant + self.compliance.at(z)));
        -(through.unwrap_or_default() + without) / each
    }

    /// All of them that are positive, in rising order.
    pub(super) fn all(&self) -> Vec<f64> {
        let angles = self.angles();
        let values: Vec<f64> = angles.iter().map(|&theta| self.at(theta).im).collect();
        let mut found = vec![self.at(PI)];
        for (angle, value) in angles.windows(2).zip(values.windows(2)) {
            if value[0].signum() != value[1].signum() {
                found.push(self.at(self.root(angle[0], angle[1])));
            }
        }
        // A change of sign through a pole is not a root.
        let real = |k: &Complex<f64>| k.re > 0.0 && k.re.is_finite() && k.im.abs() <= 1e-6 * k.re;
        let mut stiffnesses: Vec<f64> = found.iter().filter(|k| real(k)).map(|k| k.re).collect();
        stiffnesses.sort_by(f64::total_cmp);
        stiffnesses.dedup_by(|a, b| (*a - *b).abs() <= 1e-12 * *b);
        stiffnesses
    }

    /// Angles close enough together that no two roots lie between neighbours: evenly, towards
    /// zero by ratio, and around every resonance of the plant by its width.
    fn angles(&self) -> Vec<f64> {
        const EVEN: u32 = 4096;
        const RATIO: u32 = 512;
        const AROUND: i32 = 24;
        let even = (1..EVEN).map(|i| PI * f64::from(i) / f64::from(EVEN));
        let small = (1..RATIO).map(|i| 1e-3 * 1e-6_f64.powf(f64::from(i) / f64::from(RATIO)));
        let resonances = eigenvalues(&self.tick.transition).unwrap_or_default();
        let around = resonances.iter().flat_map(|pole| {
            let (centre, width) = (pole.arg().abs(), (1.0 - pole.norm()).abs().max(1e-12));
            (-AROUND..=AROUND).map(move |i| {
                let away = width * (1.6_f64.powi(i.abs()) - 1.0);
                centre + away * f64::from(i.signum())
            })
        });
        let mut angles: Vec<f64> = even.chain(small).chain(around).collect();
        // The angle pi is a root by symmetry, and is evaluated separately.
        angles.retain(|theta| (1e-9..PI - 1e-9).contains(theta));
        angles.sort_by(f64::total_cmp);
        angles.dedup();
        angles
    }

    /// Where the imaginary part changes its sign.
    fn root(&self, mut low: f64, mut high: f64) -> f64 {
        let sign = self.at(low).im.signum();
        for _ in 0..100 {
            let middle = 0.5 * (low + high);
            if middle <= low || middle >= high {
                break;
            }
            if self.at(middle).im.signum() == sign { low = middle } else { high = middle }
        }
        0.5 * (low + high)
    }
}
