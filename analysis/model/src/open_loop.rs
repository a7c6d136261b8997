//! The open loop of device and controller at each frequency, and its margins.
//!
//! For one device in one hand: `P(z) C(z)` from sampled position back to it, with the motor's sign taken out,
//! so that the closed loop is on its stability border where the product is -1. The certificate, which covers
//! every hand, has margins of its own.

use std::f64::consts::PI;

use haptic_servo::passivity::transfer::Unbuildable;
use haptic_servo::scene::Scene;
use nalgebra::Complex;

use crate::response::Response;
use crate::simulation::closed_loop::transfers;
use crate::simulation::{Experiment, Integration, SimulationError};
use crate::stability_map::plant::SampledPlant;

/// Frequencies of a curve.
const POINTS: usize = 2000;
/// Decades below half the sample rate at which a curve begins.
const DECADES: f64 = 5.0;
/// Halvings of a step in which a curve crosses a level: to the digits of a double.
const HALVINGS: usize = 50;

/// A point of the curve.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Point {
    /// Frequency in Hz.
    pub hertz: f64,
    /// Size of the product.
    pub gain: f64,
    /// Its phase in degrees, without jumps of whole turns.
    pub phase: f64,
}

/// Where the curve crosses a level, and how far it is from -1 there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Margin {
    /// Frequency in Hz.
    pub hertz: f64,
    /// A factor for a gain, degrees for a phase.
    pub value: f64,
}

/// The open loop of a scene.
#[derive(Clone, Debug, PartialEq)]
pub struct OpenLoop {
    /// At rising frequencies up to half the sample rate.
    pub points: Vec<Point>,
    /// Whether the closed loop dies away.
    pub is_stable: bool,
    /// The factors on the controller that put the closed loop on its border, where the phase is that of
    /// -1, at rising frequencies.
    pub gain_margins: Vec<Margin>,
    /// The distance of the phase from -180 degrees where the gain is 1, from -180 to 180 degrees, likewise.
    pub phase_margins: Vec<Margin>,
}

impl OpenLoop {
    /// The loop of an experiment's machine and scene.
    ///
    /// # Errors
    /// If the machine or the scene has no linear loop.
    pub fn of(experiment: &Experiment) -> Result<Self, SimulationError> {
        let scene = &experiment.scene;
        let plant = SampledPlant::new(&experiment.tick(Integration::default())?);
        let is_stable = plant.is_stable_under(scene).map_err(SimulationError::LoopTransfers)?;
        let product = Self::product(&plant, scene).map_err(SimulationError::LoopTransfers)?;
        let half = 0.5 / scene.timing.period;
        let hertz = |i: usize| half * 10_f64.powf(DECADES * (i as f64 / (POINTS - 1) as f64 - 1.0));
        let mut phase = None;
        let point = |i: usize| {
            let value = product(hertz(i));
            let near = phase.map_or(0.0, |before: f64| before.round());
            let degrees = value.arg().to_degrees();
            let turns = ((near - degrees) / 360.0).round();
            let unwrapped = degrees + 360.0 * turns;
            phase = Some(unwrapped).filter(|phase| phase.is_finite()).or(phase);
            Point { hertz: hertz(i), gain: value.norm(), phase: unwrapped }
        };
        let points: Vec<Point> = (0..POINTS).map(point).collect();
        let crossings = |level: &dyn Fn(Complex<f64>) -> f64| {
            let at = |hertz: f64| level(product(hertz));
            let steps = points.windows(2).map(|two| (two[0].hertz, two[1].hertz));
            steps.filter_map(|(a, b)| crossing(&at, a, b)).collect::<Vec<_>>()
        };
        let gain_margins = crossings(&|value| value.im)
            .into_iter()
            .chain([half])
            .map(|hertz| (hertz, product(hertz)))
            // At half the sample rate the product is real.
            .filter(|(_, value)| value.re < 0.0 && value.im.abs() <= 1e-6 * value.norm())
            .map(|(hertz, value)| Margin { hertz, value: 1.0 / value.norm() });
        let phase_margins = crossings(&|value| value.norm().ln()).into_iter().map(|hertz| {
            let degrees = product(hertz).arg().to_degrees();
            let value = if degrees > 0.0 { degrees - 180.0 } else { degrees + 180.0 };
            Margin { hertz, value }
        });
        let (mut gain_margins, phase_margins): (Vec<_>, Vec<_>) =
            (gain_margins.collect(), phase_margins.collect());
        gain_margins.dedup_by(|a, b| (a.hertz - b.hertz).abs() <= 1e-6 * b.hertz);
        Ok(Self { points, is_stable, gain_margins, phase_margins })
    }

    fn product<'p>(
        plant: &'p SampledPlant,
        scene: &Scene,
    ) -> Result<impl Fn(f64) -> Complex<f64> + use<'p>, Unbuildable> {
        let controller = Response::new(transfers(scene)?.controller);
        let period = scene.timing.period;
        Ok(move |hertz: f64| {
            let z = Complex::from_polar(1.0, 2.0 * PI * hertz * period);
            plant.at(z) * controller.at(z)
        })
    }

    /// The factors above and below 1 that first put the closed loop on its border.
    pub fn nearest_gain_margins(&self) -> impl Iterator<Item = Margin> {
        [self.gain_margin(), self.gain_reduction()].into_iter().flatten()
    }

    fn gain_margin(&self) -> Option<Margin> {
        let above = self.gain_margins.iter().filter(|margin| margin.value > 1.0);
        above.copied().min_by(|a, b| a.value.total_cmp(&b.value))
    }

    fn gain_reduction(&self) -> Option<Margin> {
        let below = self.gain_margins.iter().filter(|margin| margin.value < 1.0);
        below.copied().max_by(|a, b| a.value.total_cmp(&b.value))
    }

    /// The phase margin that is nearest to 0.
    pub fn phase_margin(&self) -> Option<Margin> {
        self.phase_margins.iter().copied().min_by(|a, b| a.value.abs().total_cmp(&b.value.abs()))
    }
}

/// Where a function changes its sign between two frequencies.
fn crossing(at: &impl Fn(f64) -> f64, mut a: f64, mut b: f64) -> Option<f64> {
    let rising = at(a) < 0.0;
    if rising == (at(b) < 0.0) || !(at(a) * at(b)).is_finite() {
        return None;
    }
    for _ in 0..HALVINGS {
        let middle = 0.5 * (a + b);
        if (at(middle) < 0.0) == rising { a = middle } else { b = middle }
    }
    Some(0.5 * (a + b))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::file::SceneFile;
    use crate::fixture::file_on_paddle;
    use crate::stability::{self, critical_stiffness};

    fn file(stiffness: f64, damping: f64, delay: usize) -> SceneFile {
        file_on_paddle(&format!(
            "[environment]\ntype = \"damper-wall\"\nstiffness = {stiffness}\ndamping = {damping}\n\
             delay = {delay}\n"
        ))
    }

    #[test]
    fn the_gain_margin_is_what_the_stiffness_may_grow_by() {
        for delay in 0..4 {
            let experiment = Experiment::at_rest(&file(3.0, 0.0, delay));
            let found = OpenLoop::of(&experiment).unwrap();
            let critical =
                critical_stiffness(&experiment, Integration::default()).unwrap().unwrap();
            let margin = found.gain_margin().unwrap();
            assert!((3.0 * margin.value / critical - 1.0).abs() < 1e-6, "{delay} {margin:?}");
            assert!(found.is_stable && found.phase_margin().unwrap().value > 0.0);
        }
        let critical = Experiment::at_rest(&file(1.0, 0.0, 2));
        let critical = critical_stiffness(&critical, Integration::default()).unwrap().unwrap();
        let shaking = Experiment::at_rest(&file(1.1 * critical, 0.0, 2));
        let shaking = OpenLoop::of(&shaking).unwrap();
        assert!(!shaking.is_stable && shaking.phase_margin().unwrap().value < 0.0);
        assert!((shaking.gain_reduction().unwrap().value * 1.1 - 1.0).abs() < 1e-6);
    }

    #[test]
    fn the_phase_margin_is_what_a_delay_may_take_of_it() {
        let found = OpenLoop::of(&Experiment::at_rest(&file(6.0, 0.0, 0))).unwrap();
        let margin = found.phase_margin().unwrap();
        // Lag of so many whole samples at the crossover; the gain stays unchanged.
        let lag = |samples: usize| 360.0 * margin.hertz * 0.001 * samples as f64;
        for delay in 1..=8 {
            let experiment = Experiment::at_rest(&file(6.0, 0.0, delay));
            let stability = stability::judge(&experiment, Integration::default()).unwrap();
            let stable = stability.verdict == stability::StabilityVerdict::Stable;
            assert_eq!(stable, lag(delay) < margin.value, "{delay} {margin:?}");
        }
        assert!(lag(8) > margin.value && lag(1) < margin.value, "{margin:?}");
    }
}
