//! Damping, inertia and delay of the device nearest to some responses, for a given lag.

use haptic_servo::current::TorqueSource;
use nalgebra::{Complex, Matrix4, Vector4};

use super::model::{Model, friction_damping};
use super::response::FrequencyPoint;

/// Largest number of Gauss-Newton steps. Near the solution each gains several digits, also with the images of
/// the torque, which are those of the model before the step.
const ITERATIONS: usize = 30;

/// A step smaller than this, in the units of the system, is the last.
const SMALL: f64 = 1e-11;

/// Smallest relative deviation that is assumed: a simulation without noise has none.
const FLOOR: f64 = 1e-9;

/// Largest number of halvings of a step that would raise the squares.
const HALVINGS: i32 = 6;

/// Shortest delay in periods at which a search starts: the phase of the fastest response is periodic.
const FIRST: f64 = -2.0;
/// Longest delay in periods at which a search starts.
const LAST: f64 = 10.0;
/// The search's step as phase in rad of the fastest response.
const SEARCH: f64 = 0.5;

const DAMPING: usize = 0;
const INERTIA: usize = 1;
const DELAY: usize = 2;
const FRICTION: usize = 3;

/// Responses as they were measured, with the images of the torque that is held for a period.
#[derive(Clone, Copy, Debug)]
pub struct Measured<'a> {
    pub responses: &'a [FrequencyPoint],
    /// Sampling period in s.
    pub period: f64,
    /// Delays in s that were removed from the responses; the images in them still have these delays.
    pub declared: f64,
    /// The current loop that the torque came from, where it is known.
    pub source: Option<TorqueSource>,
    /// Whether friction is fitted too; otherwise it is 0.
    pub with_friction: bool,
}

/// The unknowns that are fitted besides damping and inertia.
#[derive(Clone, Copy, Debug)]
struct Free {
    delay: bool,
    friction: bool,
}

#[derive(Clone, Copy, Debug)]
pub struct Fit {
    pub model: Model,
    /// Sum of the squared residuals in squared deviations.
    pub squares: f64,
    /// Deviations of damping, inertia, delay and friction for this lag.
    pub deviations: [f64; 4],
    /// Whether the delay was fitted, and not given.
    pub is_delay_free: bool,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Delay {
    /// The initial value in s.
    From(f64),
    /// The known value in s.
    Fixed(f64),
}

impl Measured<'_> {
    /// Factor by which the images of the torque change a response of the model, at an angular frequency in
    /// rad/s.
    pub fn images(&self, model: &Model, omega: f64) -> Complex<f64> {
        let delay = model.delay + self.declared;
        Model { delay, ..*model }.images(omega, self.period)
    }

    /// Angular frequency in rad/s of the fastest response.
    pub fn fastest(&self) -> f64 {
        self.responses.iter().map(|r| r.omega).fold(0.0, f64::max)
    }

    /// The best fit for a lag in s. `None` where the responses do not determine one.
    ///
    /// Friction is not below zero. Where the best fit would have it so, it is 0, and the deviations remain
    /// those of a fit with friction, which are the larger.
    pub fn fit(&self, lag: f64, delay: Delay) -> Option<Fit> {
        let found = self.fitted(lag, delay, self.with_friction)?;
        if found.model.friction >= 0.0 {
            return Some(found);
        }
        let without = self.fitted(lag, delay, false)?;
        Some(Fit { deviations: found.deviations, ..without })
    }

    fn fitted(&self, lag: f64, delay: Delay, friction: bool) -> Option<Fit> {
        let (begin, is_free) = match delay {
            Delay::From(begin) => (begin, true),
            Delay::Fixed(delay) => (delay, false),
        };
        // For a given delay the problem is linear, and the delay has no effect on a device that has no
        // inertia yet. So the first step is without the delay.
        let nothing = self.nothing(begin, lag);
        let device = Free { delay: false, friction };
        let free = Free { delay: is_free, friction };
        let mut model = moved(nothing, System::at(self, &nothing, device, false).step()?);
        let mut system = System::at(self, &model, free, true);
        for _ in 0..ITERATIONS {
            let Some((step, next, there)) = self.descent(&model, &system, free) else { break };
            (model, system) = (next, there);
            if step.component_div(&system.units).amax() < SMALL {
                break;
            }
        }
        let deviations = system.deviations()?;
        let is_usable = system.squares.is_finite() && deviations.iter().all(|d| d.is_finite());
        let of_delay = if is_free { deviations[DELAY] } else { 0.0 };
        let of_friction = if friction { deviations[FRICTION] } else { 0.0 };
        let deviations = [deviations[DAMPING], deviations[INERTIA], of_delay, of_friction];
        let squares = system.squares;
        is_usable.then_some(Fit { model, squares, deviations, is_delay_free: is_free })
    }

    /// A model without a device, with this delay and this lag in s.
    fn nothing(&self, delay: f64, lag: f64) -> Model {
        Model { damping: 0.0, inertia: 0.0, friction: 0.0, delay, lag, source: self.source }
    }

    /// A step that does not raise the squares, with the model and the system after it: for responses that no
    /// device explains, a whole step may lead anywhere.
    fn descent(
        &self,
        model: &Model,
        system: &System,
        free: Free,
    ) -> Option<(Vector4<f64>, Model, System)> {
        let whole = system.step()?;
        (0..HALVINGS).find_map(|halvings| {
            let step = whole * 0.5f64.powi(halvings);
            let next = moved(*model, step);
            let there = System::at(self, &next, free, true);
            (there.squares <= system.squares).then_some((step, next, there))
        })
    }

    /// The initial value of the delay in s: the best of several, each with the device that fits to it.
    pub fn rough_delay(&self) -> Option<f64> {
        let step = SEARCH / self.fastest();
        let last = ((LAST - FIRST) * self.period / step).ceil() as usize;
        let candidates = (0..=last).map(|i| FIRST * self.period + i as f64 * step);
        let device = Free { delay: false, friction: self.with_friction };
        let squares = |delay: f64| {
            let nothing = self.nothing(delay, 0.0);
            let model = moved(nothing, System::at(self, &nothing, device, false).step()?);
            // A device that is late by half a turn has all signs changed.
            let squares = System::at(self, &model, device, false).squares;
            (model.inertia > 0.0).then_some((delay, squares))
        };
        let best = candidates.filter_map(squares).min_by(|a, b| a.1.total_cmp(&b.1));
        best.map(|(delay, _)| delay)
    }
}

fn moved(model: Model, step: Vector4<f64>) -> Model {
    Model {
        damping: model.damping + step[DAMPING],
        inertia: model.inertia + step[INERTIA],
        delay: model.delay + step[DELAY],
        friction: model.friction + step[FRICTION],
        ..model
    }
}

/// The normal equations around a model, in units in which all four unknowns are near 1.
struct System {
    matrix: Matrix4<f64>,
    right: Vector4<f64>,
    units: Vector4<f64>,
    squares: f64,
}

impl System {
    /// `with_images` removes the images of the model from the responses; without a device there are none to
    /// remove.
    fn at(measured: &Measured<'_>, model: &Model, free: Free, with_images: bool) -> Self {
        let fastest = measured.fastest();
        let largest = measured.responses.iter().map(|r| r.impedance().norm()).fold(0.0, f64::max);
        let slowest = measured.responses.iter().map(|r| r.speed).fold(f64::INFINITY, f64::min);
        let units = Vector4::new(largest, largest / fastest, 1.0 / fastest, largest * slowest);
        let mut system =
            Self { matrix: Matrix4::zeros(), right: Vector4::zeros(), units, squares: 0.0 };
        for response in measured.responses {
            let images = match with_images {
                true => measured.images(model, response.omega),
                false => Complex::from(1.0),
            };
            system.add(response, images, model, free);
        }
        // A fixed unknown: its equation keeps it unchanged.
        for (is_free, unknown) in [(free.delay, DELAY), (free.friction, FRICTION)] {
            if !is_free {
                system.matrix[(unknown, unknown)] = 1.0;
            }
        }
        system
    }

    fn add(&mut self, response: &FrequencyPoint, images: Complex<f64>, model: &Model, free: Free) {
        let (omega, measured) = (response.omega, response.impedance() * images);
        let (fitted, output) = (model.impedance_at(omega, response.speed), model.output(omega));
        let j_omega = Complex::new(0.0, omega);
        let none = Complex::from(0.0);
        let delay = if free.delay { j_omega * fitted } else { none };
        let friction =
            if free.friction { friction_damping(1.0, response.speed) * output } else { none };
        let slopes = [output, j_omega * output, delay, friction];
        let weight = 1.0 / response.deviation.max(FLOOR * measured.norm());
        let residual = (measured - fitted) * weight;
        self.squares += residual.norm_sqr();
        for part in [|z: Complex<f64>| z.re, |z: Complex<f64>| z.im] {
            let row = Vector4::from_fn(|i, _| part(slopes[i]) * weight * self.units[i]);
            self.matrix += row * row.transpose();
            self.right += row * part(residual);
        }
    }

    fn step(&self) -> Option<Vector4<f64>> {
        Some(self.matrix.cholesky()?.solve(&self.right).component_mul(&self.units))
    }

    fn deviations(&self) -> Option<Vector4<f64>> {
        let covariance = self.matrix.cholesky()?.inverse();
        Some(covariance.diagonal().map(f64::sqrt).component_mul(&self.units))
    }
}
