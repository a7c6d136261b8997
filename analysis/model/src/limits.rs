//! The stiffest wall that is certified, and the effect of an encoder's step on its torque.

use haptic_servo::certificate::PassivityProblem;
use haptic_servo::environment::Wall;
use haptic_servo::passivity::transfer::Unbuildable;
use haptic_servo::scene::{Coupling, Scene, Timing};

use crate::felt;
use crate::response::Response;
use crate::simulation::closed_loop::transfers;

/// The largest stiffness of a wall.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Limit {
    /// No stiffness is certified.
    Nothing,
    /// Up to this one in N m/rad.
    AtMost(f64),
    /// Any stiffness: the hand feels the coupling.
    Any,
}

/// A stiffness this many times the standard coupling's counts as a rigid wall.
const RIGID: f64 = 1e6;
/// The smallest stiffness that is tried, over the standard coupling's.
const SOFT: f64 = 1e-6;
/// Stiffnesses between the two that are tried before the search closes in.
const STEPS: u32 = 48;
/// Halvings of the step's logarithm: to a relative 1e-12.
const HALVINGS: usize = 40;
/// Longest impulse response that is summed, in samples.
const LONGEST: usize = 1_000_000;
/// An impulse response has died away when this many samples in a row add less than [`SMALL`].
const QUIET: usize = 64;
/// As a fraction of the sum.
const SMALL: f64 = 1e-12;

/// The scene with another stiffness in N m/rad, and with another delay in samples if one is given; unchanged
/// if its environment has no wall.
pub fn with_wall(scene: &Scene, stiffness: f64, delay: Option<usize>) -> Scene {
    let mut changed = *scene;
    if let Some(wall) = changed.environment.wall_mut() {
        *wall = Wall { stiffness, delay: delay.unwrap_or(wall.delay), ..*wall };
    }
    changed
}

/// The scene at another period in s. A worst period keeps its ratio to it, and a coupling spring becomes the
/// standard one, `2 delta / T`, which that period allows. Delays and lags stay unchanged: they belong to the
/// hardware.
pub fn at_period(scene: &Scene, period: f64) -> Scene {
    let ratio = period / scene.timing.period;
    let worst_period = scene.timing.worst_period.map(|worst| worst * ratio);
    let timed = Scene { timing: Timing { period, worst_period }, ..*scene };
    match scene.coupling {
        // A matched coupling follows from the period itself.
        Coupling::Rigid | Coupling::Matched => timed,
        Coupling::Spring { .. } => {
            let stiffness = standard_coupling(&timed);
            Scene { coupling: Coupling::Spring { stiffness }, ..timed }
        }
    }
}

/// The standard coupling `2 delta / T` in N m/rad, `delta` scaled to the worst period; rounded down, so that
/// it is never the stiffer one.
pub fn standard_coupling(scene: &Scene) -> f64 {
    let period = scene.timing.period;
    let worst = scene.timing.worst_period.unwrap_or(period);
    let delta = scene.device.passivity.unwrap_or(scene.device.damping);
    (2.0 * delta / worst) * (1.0 - 1e-12)
}

/// The largest stiffness of the scene's wall that is certified, everything else as it is.
pub fn largest_stiffness(scene: &Scene) -> Limit {
    let passes = |stiffness: f64| {
        PassivityProblem::of(&with_wall(scene, stiffness, None))
            .is_ok_and(|posed| posed.is_certified())
    };
    let standard = standard_coupling(scene);
    let (softest, stiffest) = ((SOFT * standard).ln(), (RIGID * standard).ln());
    if passes(stiffest.exp()) {
        return Limit::Any;
    }
    // From above: for some walls a soft one fails and a stiffer one passes.
    let step = (stiffest - softest) / f64::from(STEPS);
    let tried = (0..=STEPS).rev().map(|index| softest + step * f64::from(index));
    let Some(mut low) = tried.into_iter().find(|logarithm| passes(logarithm.exp())) else {
        return Limit::Nothing;
    };
    let mut high = low + step;
    for _ in 0..HALVINGS {
        let middle = 0.5 * (low + high);
        if passes(middle.exp()) { low = middle } else { high = middle }
    }
    Limit::AtMost(low.exp())
}

/// Largest change of torque in N m for each rad of position error: the sum of the absolute values
/// of the controller's impulse response (theory, section 6, item 7).
///
/// # Errors
/// Where the scene has no controller, or its impulse response does not die away.
pub fn error_gain(scene: &Scene) -> Result<f64, Unbuildable> {
    let mut filter =
        Response::new(transfers(scene)?.controller).filter().ok_or(Unbuildable::OutOfRange)?;
    let (mut sum, mut quiet) = (0.0, 0);
    for sample in 0..LONGEST {
        let torque = filter.tick(if sample == 0 { 1.0 } else { 0.0 }).abs();
        sum += torque;
        quiet = if torque <= SMALL * sum { quiet + 1 } else { 0 };
        if quiet == QUIET {
            return Ok(sum);
        }
    }
    Err(Unbuildable::OutOfRange)
}

/// Largest stiffness and torque ripple at one sample rate and delay.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Point {
    /// Sample rate in Hz.
    pub rate: f64,
    /// Largest certified stiffness in N m/rad; that of the coupling where there is no limit.
    pub stiffness: f64,
    /// Peak torque in N m that half an encoder's count may cause at [`Curves::used`] of that stiffness.
    pub ripple: Option<f64>,
}

/// A request for limits.
#[derive(Clone, Debug, PartialEq)]
pub struct Curves {
    /// From the lowest to the highest sample rate in Hz.
    pub rates: std::ops::Range<f64>,
    /// Number of sample rates.
    pub points: usize,
    /// Counts of the encoder a turn.
    pub counts_per_turn: f64,
    /// Fraction of the largest stiffness at which the ripple is taken: at the largest stiffness itself there
    /// is no bound.
    pub used: f64,
}

impl Curves {
    /// The curve of one delay in samples; sample rates at which no stiffness is certified are left
    /// out.
    pub fn of(&self, scene: &Scene, delay: usize) -> Vec<Point> {
        let decades = (self.rates.end / self.rates.start).ln();
        let last = self.points.saturating_sub(1).max(1) as f64;
        let rate = |index: usize| match index + 1 == self.points {
            true => self.rates.end,
            false => self.rates.start * (decades * index as f64 / last).exp(),
        };
        (0..self.points).filter_map(|index| self.point(scene, delay, rate(index))).collect()
    }

    fn point(&self, scene: &Scene, delay: usize, rate: f64) -> Option<Point> {
        let timed = with_wall(&at_period(scene, 1.0 / rate), 0.0, Some(delay));
        let half_a_count = std::f64::consts::PI / self.counts_per_turn;
        let (stiffness, used) = match largest_stiffness(&timed) {
            Limit::Nothing => return None,
            Limit::AtMost(stiffness) => (stiffness, self.used * stiffness),
            Limit::Any => {
                let stiffness = 1.0 / felt::compliance(&timed).filter(|&it| it > 0.0)?;
                (stiffness, RIGID * stiffness)
            }
        };
        let ripple = error_gain(&with_wall(&timed, used, None)).ok();
        Some(Point { rate, stiffness, ripple: ripple.map(|gain| gain * half_a_count) })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fixture::{STANDARD, on_paddle};
    use haptic_servo::scene::Latency;

    fn wall(damping: f64, delay: usize, coupling: Coupling) -> Scene {
        on_paddle(Wall::damped(22.0, damping, delay).alone(), coupling)
    }

    fn near(a: f64, b: f64, part: f64) {
        assert!((a - b).abs() <= part * b.abs(), "{a} {b}");
    }

    #[test]
    fn the_largest_stiffness_is_the_formulas() {
        for delay in 1..=4 {
            let Limit::AtMost(k) = largest_stiffness(&wall(0.0, delay, STANDARD)) else { panic!() };
            near(k, 0.022 / (0.001 * (delay as f64 - 0.5)), 1e-9);
        }
        let Limit::AtMost(k) = largest_stiffness(&wall(0.01, 1, STANDARD)) else { panic!() };
        near(k, 24.0, 1e-9);
        assert_eq!(largest_stiffness(&wall(0.0, 0, STANDARD)), Limit::Any);
        assert_eq!(largest_stiffness(&wall(0.03, 1, STANDARD)), Limit::Nothing);
        // Undelayed it needs 0.03 - K T / 2: only the stiff ones pass, and all of them.
        assert_eq!(largest_stiffness(&wall(-0.03, 0, STANDARD)), Limit::Any);
        // A rigid coupling costs a sample: K < b / (T (n + 1/2)).
        let Limit::AtMost(k) = largest_stiffness(&wall(0.0, 0, Coupling::Rigid)) else { panic!() };
        near(k, 44.0, 1e-9);
    }

    #[test]
    fn the_gain_of_the_papers_wall_and_of_springs() {
        near(error_gain(&wall(0.01, 1, STANDARD)).unwrap(), 924.0, 1e-6);
        // (2 delta / T) r / (1 - r)
        let spring = with_wall(&wall(0.0, 1, STANDARD), 0.7 * 44.0, None);
        near(error_gain(&spring).unwrap(), 44.0 * 0.7 / 0.3, 1e-9);
    }

    #[test]
    fn behind_a_matched_coupling_any_prompt_wall_is_felt_as_that_coupling() {
        let latency = Latency::delayed(3e-4).with_actuator_lag(1.6e-4);
        let lagging = Scene { latency, ..wall(0.0, 0, Coupling::Matched) };
        assert_eq!(largest_stiffness(&lagging), Limit::Any);
        let curves = Curves { rates: 1e3..1e4, points: 2, counts_per_turn: 65536.0, used: 0.7 };
        let [slow, fast] = curves.of(&lagging, 0)[..] else { panic!() };
        near(slow.stiffness, 2.0 * 0.022 / (1e-3 + 4.6e-4), 1e-9);
        near(fast.stiffness, 2.0 * 0.022 / (1e-4 + 4.6e-4), 1e-9);
    }

    #[test]
    fn ten_times_the_rate_allows_ten_times_the_stiffness() {
        let curves = Curves { rates: 1e3..1e4, points: 2, counts_per_turn: 65536.0, used: 0.7 };
        let [slow, fast] = curves.of(&wall(0.0, 2, STANDARD), 1)[..] else { panic!() };
        near(fast.stiffness, 10.0 * slow.stiffness, 1e-6);
        near(slow.stiffness, 44.0, 1e-6);
        near(slow.ripple.unwrap(), 44.0 * 0.7 / 0.3 * std::f64::consts::PI / 65536.0, 1e-6);
    }
}
