//! Random linear loops whose torque lags, in their own units: period and passivity are 1.

use haptic_servo::environment::{Environment, Rational, Wall};
use haptic_servo::scene::{Coupling, Device, Latency, Scene, TimeRange};
use nalgebra::Complex;
use rand::Rng;
use rand::seq::IndexedRandom;

use crate::scenes::{log_uniform, multiply};

/// A wall behind a coupling, with what delays its torque.
#[derive(Clone, Copy, Debug)]
pub struct Loop {
    /// Stiffness of the wall.
    pub stiffness: f64,
    /// Damping of the wall.
    pub damping: f64,
    /// Pole of the filter of its velocity.
    pub filter: f64,
    /// Whole samples of delay.
    pub delay: usize,
    /// Stiffness of the coupling; `None` is rigid.
    pub coupling: Option<f64>,
    /// Delay of the output in periods.
    pub output_delay: f64,
    /// Time constant of the amplifier in periods.
    pub actuator_lag: f64,
    /// Time constant of the sensor in periods.
    pub sensor_lag: f64,
    /// Updates of the amplifier in a period; 0 where its lag is continuous.
    pub updates: u16,
    /// What multiplies the wall: `(z^2 + b z + c) / (z^2 + d z + e)`.
    pub section: Option<[f64; 4]>,
}

impl Loop {
    /// A wall of the stiffness 1 with any of the rest.
    pub fn draw(rng: &mut impl Rng) -> Self {
        let mut some = |part: f64, hi: f64| {
            if rng.random_bool(part) { rng.random_range(0.02..hi) } else { 0.0 }
        };
        let (output_delay, actuator_lag, sensor_lag) =
            (some(0.6, 1.9), some(0.6, 2.0), some(0.3, 1.0));
        Self {
            stiffness: 1.0,
            damping: if rng.random_bool(0.6) { rng.random_range(-0.2..2.0) } else { 0.0 },
            filter: if rng.random_bool(0.3) { rng.random_range(0.1..0.9) } else { 0.0 },
            delay: rng.random_range(0..3),
            coupling: rng.random_bool(0.5).then(|| rng.random_range(0.5..4.0)),
            output_delay,
            actuator_lag,
            sensor_lag,
            updates: 0,
            section: None,
        }
    }

    /// With an amplifier that is updated some times a period.
    pub fn draw_sampled(rng: &mut impl Rng) -> Self {
        let updates = *[1, 2, 3, 4, 7, 16].choose(rng).expect("some");
        let delay = rng.random_range(0..=2 * updates);
        Self {
            output_delay: f64::from(delay) / f64::from(updates),
            actuator_lag: log_uniform(rng, 0.05, 2.0),
            sensor_lag: 0.0,
            updates,
            ..Self::draw(rng)
        }
    }

    /// With stiffness and damping times a factor.
    #[must_use]
    pub fn scaled(self, factor: f64) -> Self {
        Self { stiffness: factor * self.stiffness, damping: factor * self.damping, ..self }
    }

    /// As the firmware judges it.
    pub fn scene(&self) -> Scene {
        let exactly = TimeRange::exactly;
        Scene {
            coupling: match self.coupling {
                Some(stiffness) => Coupling::Spring { stiffness },
                None => Coupling::Rigid,
            },
            latency: Latency {
                output_delay: exactly(self.output_delay),
                actuator_lag: exactly(self.actuator_lag),
                sensor_lag: exactly(self.sensor_lag),
                actuator_updates: self.updates,
                ..Latency::NONE
            },
            ..Scene::of(Device::damped(1.0, 1.0), 1.0, self.environment())
        }
    }

    fn environment(&self) -> Environment {
        if self.section.is_none() {
            let wall = Wall::damped(self.stiffness, self.damping, self.delay);
            return if self.filter > 0.0 { wall.filtered(self.filter) } else { wall }.alone();
        }
        let (numerator, denominator) = self.fraction();
        let rational = Rational::of(&numerator, &denominator).expect("a low degree");
        Environment::Rational(Rational { delay: self.delay, ..rational })
    }

    /// The wall with its section, without its delay: numerator and denominator, descending.
    fn fraction(&self) -> (Vec<f64>, Vec<f64>) {
        let a = self.filter;
        let gain = self.damping * (1.0 - a);
        let numerator = vec![self.stiffness + gain, -self.stiffness * a - gain];
        let denominator = vec![1.0, -a];
        let Some([b, c, d, e]) = self.section else { return (numerator, denominator) };
        (multiply(&numerator, &[1.0, b, c]), multiply(&denominator, &[1.0, d, e]))
    }

    /// The environment at a place.
    pub fn environment_at(&self, z: Complex<f64>) -> Complex<f64> {
        let value = |p: &[f64]| p.iter().fold(Complex::ZERO, |sum, c| sum * z + c);
        let (numerator, denominator) = self.fraction();
        z.powi(-(self.delay as i32)) * value(&numerator) / value(&denominator)
    }

    /// `1 + E V` at a place, whose zeros are the controller's poles.
    pub fn closed_at(&self, z: Complex<f64>) -> Complex<f64> {
        1.0 + self.environment_at(z) * self.coupling.map_or(0.0, |stiffness| 1.0 / stiffness)
    }

    /// The controller, which is the environment behind the coupling, at a place.
    pub fn controller_at(&self, z: Complex<f64>) -> Complex<f64> {
        self.environment_at(z) / self.closed_at(z)
    }
}
