//! The limit cycle of rounding: a device without friction under a constant push, which only rounding keeps in
//! motion.

use haptic_servo::environment::Environment;
use haptic_servo::number::Arithmetic;
use serde::Serialize;

use super::{FormatProblem, FormatServo};
use crate::device::{Hand, HandSetpoint, Motion, SimulatedEncoder};
use crate::simulation::held_device::{DeviceState, HeldDevice};
use crate::studies::error::StudyError;
use crate::studies::failures::motion::swing;

/// The limit cycle of a device that is pressed against a wall, or released in free mode.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct LimitCycle {
    /// Torque in N m, peak to peak, the largest of all starts.
    #[serde(rename = "hum")]
    pub torque: f64,
    /// Angle in rad, peak to peak, the smallest of all starts.
    #[serde(rename = "cycle")]
    pub angle: f64,
}

/// Torque in N m that pushes against a wall, or half of the limit if that is less.
pub const PRELOAD: f64 = 0.2;
/// Initial positions in rad.
const STARTS: [f64; 9] = [1e-2, 3e-3, 1e-3, 3e-4, 1e-4, 3e-5, 1e-5, 3e-6, 1e-6];
/// Shortest window of a motion in s.
const WINDOW: f64 = 0.25;
/// Longest window in s. A motion that does not decay by half within it is an error.
const LONGEST: f64 = 4.0;
/// Largest number of windows until a motion has decayed to its limit cycle.
const WINDOWS: usize = 40;
/// Ratio of two windows above which a motion counts as decayed.
const STEADY: f64 = 0.9;

/// Lets a device come to rest from several starts, with the scene's encoder or with exact angles.
pub fn at_rest(
    problem: &FormatProblem,
    arithmetic: Arithmetic,
    with_encoder: bool,
) -> Result<LimitCycle, StudyError> {
    let encoder = with_encoder.then(|| SimulatedEncoder::new(problem.transducers.counts_per_turn));
    let scene = &problem.scene;
    let device = HeldDevice::of(scene, Hand::default())?;
    let limit = scene.torque_limit.unwrap_or(problem.transducers.full_scale_torque);
    let push = if has_spring(&scene.environment) { PRELOAD.min(0.5 * limit) } else { 0.0 };
    let window = window(problem, &device, push)?;
    let mut largest = LimitCycle { torque: 0.0, angle: f64::INFINITY };
    for start in STARTS {
        let servo = problem.servo(arithmetic)?;
        let mut settling = Settling::from(&device, start, servo, encoder, push);
        let left = settling.settle(ticks(window, scene.timing.period))?;
        largest = LimitCycle {
            torque: largest.torque.max(left.torque),
            angle: largest.angle.min(left.angle),
        };
    }
    Ok(largest)
}

/// Time in s in which the motion decays at least by half without rounding: in `f64`, with exact angles.
fn window(problem: &FormatProblem, device: &HeldDevice, push: f64) -> Result<f64, StudyError> {
    let mut window = WINDOW;
    while window <= LONGEST {
        // Four windows together, so that a slow oscillation shows its whole span.
        let ticks = ticks(4.0 * window, problem.scene.timing.period);
        let servo = problem.servo(Arithmetic::F64)?;
        let mut settling = Settling::from(device, STARTS[0], servo, None, push);
        let (first, second) = (settling.window(ticks)?, settling.window(ticks)?);
        if second.torque <= first.torque / 16.0 {
            return Ok(window);
        }
        window *= 2.0;
    }
    Err(StudyError::NoRest { seconds: LONGEST })
}

/// Number of ticks in a time in s.
fn ticks(time: f64, period: f64) -> usize {
    (time / period).ceil() as usize
}

fn has_spring(environment: &Environment) -> bool {
    match environment {
        Environment::Parts(parts) => parts.wall.is_some() || parts.profile.is_some(),
        Environment::Rational(rational) => {
            rational.unit_zeros == 0 && rational.numerator.as_slice().iter().sum::<f64>() != 0.0
        }
        Environment::Stated(_) => true,
    }
}

/// A device that comes to rest.
struct Settling<'a> {
    device: &'a HeldDevice,
    servo: FormatServo,
    encoder: Option<SimulatedEncoder>,
    push: f64,
    state: DeviceState,
}

impl<'a> Settling<'a> {
    /// At rest at a position in rad.
    fn from(
        device: &'a HeldDevice,
        position: f64,
        servo: FormatServo,
        encoder: Option<SimulatedEncoder>,
        push: f64,
    ) -> Self {
        let state = device.at(Motion { position, velocity: 0.0 });
        Self { device, servo, encoder, push, state }
    }

    /// The limit cycle in a window of `ticks` ticks, after it has stopped shrinking.
    fn settle(&mut self, ticks: usize) -> Result<LimitCycle, StudyError> {
        let mut last = self.window(ticks)?;
        for _ in 1..WINDOWS {
            let next = self.window(ticks)?;
            if next.torque >= STEADY * last.torque && next.angle >= STEADY * last.angle {
                return Ok(next);
            }
            last = next;
        }
        Ok(last)
    }

    fn window(&mut self, ticks: usize) -> Result<LimitCycle, StudyError> {
        let (mut torques, mut angles) = (Vec::new(), Vec::new());
        for _ in 0..ticks {
            let angle = self.state.measured();
            let torque = match &self.encoder {
                Some(encoder) => self.servo.tick(encoder.read(angle)).0,
                None => self.servo.tick_at(angle)?,
            };
            torques.push(torque);
            angles.push(self.state.motion().position);
            self.device.step(&mut self.state, self.push - torque, HandSetpoint::default());
        }
        Ok(LimitCycle { torque: swing(&torques), angle: swing(&angles) })
    }
}

#[cfg(test)]
mod tests {
    use haptic_servo::certificate::Resolution;
    use haptic_servo::encoder::CounterWidth;
    use haptic_servo::environment::Wall;
    use haptic_servo::scene::{Coupling, Device, Scene};
    use haptic_servo::transducers::Transducers;

    use super::*;
    use crate::studies::failures::setting::rigid;

    /// A wall whose certificate leaves `margin` N m s/rad, on a device of so much inertia.
    fn problem(inertia: f64, margin: f64) -> FormatProblem {
        let damping = 1e-4;
        let stiffness = 2.0 * (damping - margin) / 1e-3;
        let environment = Wall::spring(stiffness, 1).alone();
        let transducers =
            Transducers { counter: CounterWidth::Bits16, ..Transducers::of(4096.0, 0.2) };
        let coupling = Coupling::Spring { stiffness: 0.2 };
        let device = Device { inertia, damping, passivity: None };
        let scene = Scene { coupling, ..rigid(device, environment) };
        let steps = Resolution::of(&transducers, None);
        FormatProblem { scene, transducers, steps, range: 0.5 }
    }

    #[test]
    fn a_motion_that_dies_away_slowly_is_waited_for_and_no_limit_cycle() {
        let largest = at_rest(&problem(5e-5, 5e-5), Arithmetic::F64, false).unwrap();
        assert!(largest.torque < 1e-9, "{largest:?}");
        let endless = at_rest(&problem(5e-3, 1e-7), Arithmetic::F64, false);
        assert!(matches!(endless, Err(StudyError::NoRest { .. })), "{endless:?}");
    }
}
