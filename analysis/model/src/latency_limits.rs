//! The largest stiffness of a spring over the servo's rate, where torques come late and through a current
//! loop: the proved limits and the common assumption.

use std::f64::consts::TAU;
use std::ops::Range;

use haptic_servo::certificate::PassivityProblem;
use haptic_servo::environment::Wall;
use haptic_servo::parameter::MAX_DELAY;
use haptic_servo::scene::{Device, Latency, Scene};

/// Factor over the certified stiffness from which some hand is known to destabilise a spring: hands that do
/// not vary in time allow at most 1.3 % more (theory, section 13.1).
const UNSAFE: f64 = 1.015;
/// Halvings of the range of a stiffness.
const HALVINGS: u32 = 40;

/// Largest stiffnesses in N m/rad at one rate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LatencyPoint {
    /// Rate of the servo in Hz.
    pub rate: f64,
    /// Certified, with torques a fixed time after their counts; `None` where that is a period or more.
    pub at_phase: Option<f64>,
    /// Certified, with torques latched by the next count.
    pub latched: f64,
    /// Certified, latched, with the lag rounded up to whole samples; `None` beyond the longest delay.
    pub whole_samples: Option<f64>,
    /// `b/(T/2 + tau)`, which leaves the latch out.
    pub folklore: f64,
}

impl LatencyPoint {
    /// Whether a hand is known in which a spring of the stiffness `folklore` oscillates on a board that
    /// latches its torques.
    pub fn folklore_is_unsafe(&self) -> bool {
        self.folklore > UNSAFE * self.latched
    }
}

/// A device behind one current loop.
#[derive(Clone, Debug, PartialEq)]
pub struct LatencyLimits {
    /// Bandwidth of the current loop in Hz.
    pub bandwidth: f64,
    /// From the lowest rate to the highest.
    pub points: Vec<LatencyPoint>,
}

impl LatencyLimits {
    /// For a device, with torques `phase` s after their counts.
    pub fn new(
        device: &Device,
        bandwidth: f64,
        phase: f64,
        rates: Range<f64>,
        points: usize,
    ) -> Self {
        let lag = lag_of(bandwidth);
        let point = |rate: f64| {
            let period = 1.0 / rate;
            let spring = |latency, delay| largest_spring(device, period, latency, delay);
            let late = 1 + (lag / period).ceil() as usize;
            LatencyPoint {
                rate,
                at_phase: (phase < period)
                    .then(|| spring(Latency::delayed(phase).with_actuator_lag(lag), 0)),
                latched: spring(Latency::NONE.with_actuator_lag(lag), 1),
                whole_samples: (late <= MAX_DELAY).then(|| spring(Latency::NONE, late)),
                folklore: device.passivity() / (0.5 * period + lag),
            }
        };
        let last = points.saturating_sub(1).max(1) as f64;
        let rate = |index: usize| rates.start * (rates.end / rates.start).powf(index as f64 / last);
        Self { bandwidth, points: (0..points).map(|index| point(rate(index))).collect() }
    }
}

/// Time constant in s of a first-order loop of this bandwidth in Hz.
pub fn lag_of(bandwidth: f64) -> f64 {
    1.0 / (TAU * bandwidth)
}

/// The largest certified spring in N m/rad without a coupling, with a delay in samples.
pub fn largest_spring(device: &Device, period: f64, latency: Latency, delay: usize) -> f64 {
    let scene = |stiffness| Scene {
        latency,
        ..Scene::of(*device, period, Wall::spring(stiffness, delay).alone())
    };
    let passes =
        |stiffness| PassivityProblem::of(&scene(stiffness)).is_ok_and(|posed| posed.is_certified());
    let (mut certified, mut refused) = (0.0, 2.0 * device.passivity() / period);
    for _ in 0..HALVINGS {
        let middle = 0.5 * (certified + refused);
        *if passes(middle) { &mut certified } else { &mut refused } = middle;
    }
    certified
}

#[cfg(test)]
mod tests {
    use super::*;

    const DEVICE: Device = Device { inertia: 2.2e-5, damping: 0.022, passivity: None };

    /// Published for this device: with 5 us, and latched.
    #[test]
    fn limits_are_those_of_the_table() {
        for (rate, bandwidth, at_phase, latched, whole) in [
            (1e3, 3e3, 38.6, 14.13, 8.80),
            (5e3, 2e3, 116.0, 57.7, 44.0),
            (1e4, 1e3, 102.0, 71.0, 62.9),
            (2e4, 3e3, 263.0, 171.0, 126.0),
        ] {
            let found = LatencyLimits::new(&DEVICE, bandwidth, 5e-6, rate..rate, 1).points[0];
            let close = |found: f64, wanted: f64| (found / wanted - 1.0).abs() < 5e-3;
            assert!(close(found.at_phase.unwrap(), at_phase), "{found:?}");
            assert!(close(found.latched, latched), "{found:?}");
            assert!(close(found.whole_samples.unwrap(), whole), "{found:?}");
            assert!(found.folklore_is_unsafe(), "{found:?}");
        }
    }
}
